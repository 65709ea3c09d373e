#include "frana_ensemble_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_file.h"
#include "base/version.h"
#include "ensemble/sensitivity.h"
#include "ensemble/statistics.h"
#include "frana_ensemble_folder.h"
#include "io/gdal_writer.h"
#include "vtk_io/figures/chart_figure.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

const PeakField& described(const std::string& name) {
    for (const PeakField& field : peak_fields())
        if (name == field.name) return field;
    throw InternalError("internal error: a field without a meaning");
}

/// A threshold for people: pressures in kPa.
std::string amount(double value, const PeakField& field) {
    const bool pressure = std::string(field.unit) == "Pa";
    return fmt::format("{:g} {}", pressure ? 1e-3 * value : value, pressure ? "kPa" : field.unit);
}

/// A number of a run and its name.
struct Outcome {
    const char *key, *name;
    double SampleResult::*value;
};
constexpr Outcome kOutcomes[] = {{"runout_m", "runout [m]", &SampleResult::runout},
                                 {"reach_m", "straight reach [m]", &SampleResult::reach},
                                 {"footprint_area_m2", "footprint [m2]", &SampleResult::footprint_area},
                                 {"volume_m3", "volume [m3]", &SampleResult::volume},
                                 {"max_depth_m", "largest depth [m]", &SampleResult::max_depth},
                                 {"max_speed_m_s", "largest speed [m/s]", &SampleResult::max_speed}};

class Writer {
public:
    Writer(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
           const std::vector<SampleResult>& results, EnsembleSummary& summary)
        : dir_(dir), plan_(plan), base_(base), results_(results), summary_(summary) {
        for (const SampleResult& result : results) {
            const double weight = weight_of(result);
            if (result.ended()) {
                ended_.push_back(&result), peaks_.push_back(&result.peaks), weights_.push_back(weight);
            } else {
                failed_weight_ += weight;
            }
        }
        weight_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
        summary_.effective = std::min(effective_number(weights_), independent());
    }

    void write() {
        if (!(weight_ > 0.0))
            throw UserError(fmt::format(
                "{}: found no run with an answer; expected one or more; the reasons are in runs.csv", dir_.string()));
        fs::create_directories(dir_ / "rasters");
        fs::create_directories(dir_ / "figures");
        for (std::size_t f = 0; f < plan_.fields.size(); ++f) write_field(f);
        draw_outcomes();
        draw_convergence();
        draw_scatter();
    }

    /// The least of an outcome that a share `q` of the weights does not exceed.
    double quantile(double SampleResult::*value, double q) const {
        const auto all = by_size(value);
        double below = 0.0;
        constexpr double round_off = 1e-9;
        for (const auto& [number, weight] : all)
            if ((below += weight) >= q * weight_ * (1.0 - round_off)) return number;
        return all.back().first;
    }

    double mean(double SampleResult::*value) const {
        double sum = 0.0;
        for (std::size_t k = 0; k < ended_.size(); ++k) sum += weights_[k] * (ended_[k]->*value);
        return sum / weight_;
    }

private:
    /// An outcome of the runs with an answer, and their weights, ascending.
    std::vector<std::pair<double, double>> by_size(double SampleResult::*value) const {
        std::vector<std::pair<double, double>> all;
        for (std::size_t k = 0; k < ended_.size(); ++k) all.emplace_back(ended_[k]->*value, weights_[k]);
        std::sort(all.begin(), all.end());
        return all;
    }

    /// Runs of a group of "saltelli" or "morris" share all keys but one.
    double independent() const {
        const auto keys = static_cast<Index>(plan_.vary.size());
        const double groups = static_cast<double>(ended_.size()) / static_cast<double>(runs_each(plan_.method, keys));
        return plan_.method == Method::saltelli ? 2.0 * groups : groups;
    }

    double weight_of(const SampleResult& r) const { return plan_.points[static_cast<std::size_t>(r.sample)].weight; }

    /// Where no run came there is nothing to show.
    void raster(const std::string& name, Raster values, const char* unit, const std::string& meaning) {
        for (std::size_t k = 0; k < values.values.size(); ++k)
            if (reached_.values[k] == 0.0) values.values[k] = Raster::nodata;
        values.crs_wkt = base_.bed.crs_wkt;
        write_geotiff(dir_ / "rasters" / (name + ".tif"), values, unit, meaning);
        summary_.files.push_back("rasters/" + name + ".tif");
    }

    void everywhere(const std::string& name, Raster values, const std::string& meaning) {
        values.crs_wkt = base_.bed.crs_wkt;
        write_geotiff(dir_ / "rasters" / (name + ".tif"), values, "1", meaning);
        summary_.files.push_back("rasters/" + name + ".tif");
    }

    void write_field(std::size_t f) {
        const PeakField& field = described(plan_.fields[f]);
        PixelValues pixels(base_.whole);
        pixels.gather(peaks_, weights_, f);
        if (f == 0) reached_ = pixels.reached();
        const auto asked = plan_.exceed.find(field.name);
        if (asked != plan_.exceed.end())
            for (const double threshold : asked->second) write_exceedance(field, threshold, pixels);
        for (const double q : plan_.quantiles)
            raster(fmt::format("quantile_{}_{:g}", field.name, q), pixels.quantile(q), field.unit,
                   fmt::format("{}: {:g} of the runs do not exceed it", field.meaning, q));
        raster(fmt::format("mean_{}", field.name), pixels.mean(), field.unit, fmt::format("mean {}", field.meaning));
        if (f > 0) return;
        raster("probability_reached", reached_, "1", "share of the runs that come there");
        draw_map(reached_, "probability_reached",
                 fmt::format("probability of a depth above {:g} m", base_.footprint_depth));
        for (const double p : {0.05, 0.5, 0.95}) write_contour(reached_, p);
    }

    void write_contour(Raster reached, double p) {
        const std::string name = fmt::format("reached_by_{:g}.geojson", p);
        reached.crs_wkt = base_.bed.crs_wkt;
        // A share equal to the level belongs to it.
        write_footprint(dir_ / name, reached, p * (1.0 - 1e-9), {{"probability", p}});
        summary_.files.push_back(name);
    }

    void write_exceedance(const PeakField& field, double threshold, const PixelValues& pixels) {
        const std::string name = fmt::format("probability_{}_{:g}", field.name, threshold);
        const std::string meaning =
            fmt::format("share of the runs with {} above {:g} {}", field.meaning, threshold, field.unit);
        const Raster p = pixels.exceeds(threshold);
        raster(name, p, "1", meaning);
        Raster error = p, low = p, high = p;
        const double all = weight_ + failed_weight_;
        for (std::size_t k = 0; k < p.values.size(); ++k) {
            error.values[k] = standard_error(p.values[k], summary_.effective);
            low.values[k] = p.values[k] * weight_ / all;
            high.values[k] = (p.values[k] * weight_ + failed_weight_) / all;
        }
        raster(name + "_error", error, "1", "standard error of the " + meaning);
        if (failed_weight_ > 0.0) {
            raster(name + "_low", low, "1", meaning + ", if no run that failed did");
            everywhere(name + "_high", high, meaning + ", if every run that failed did");
        }
        draw_map(p, name, fmt::format("probability of {} above {}", field.meaning, amount(threshold, field)));
    }

    void draw_map(const Raster& p, const std::string& name, const std::string& label) {
        summary_.maps_drawn = p.geometry == base_.bed.geometry;  // otherwise a part of the terrain is held
        if (!summary_.maps_drawn) return;
        MapFigure figure;
        figure.bed = base_.bed;
        figure.field = p.values;
        figure.outline_field = p.values;
        figure.outline_label = "probability";
        figure.shown_above = 0.01;  // of a hundred runs more than one
        figure.title = base_.title;
        figure.field_label = label + " [1]";
        figure.range = {0.0, 1.0};
        figure.survey = base_.footprint;
        figure.footer = runs_sentence(summary_);
        note(render_map(figure, dir_ / "figures" / (name + ".png"), why_not_), "figures/" + name + ".png");
    }

    /// How likely the flow comes farther than a distance.
    Curve farther(const char* name, double SampleResult::*value) const {
        Curve curve;
        curve.name = name;
        double left = weight_;
        for (const auto& [distance, weight] : by_size(value)) {
            curve.x.push_back(distance), curve.y.push_back(left / weight_);
            left -= weight;
            curve.x.push_back(distance), curve.y.push_back(std::max(0.0, left / weight_));
        }
        return curve;
    }

    void draw_outcomes() {
        ChartFigure figure;
        figure.title = base_.title;
        figure.x_label = "distance [m]";
        std::vector<Curve> curves = {farther("straight from the release", &SampleResult::reach)};
        if (!base_.path.empty()) curves.push_back(farther("along the path of water", &SampleResult::runout));
        figure.panels.push_back({"share of the runs that come farther [1]", curves, false, std::pair{0.0, 1.0}, 1.0});
        figure.footer = runs_sentence(summary_);
        note(render_chart(figure, dir_ / "figures" / "runout.png", why_not_), "figures/runout.png");
    }

    /// How the middle of the runs settles with their number.
    void draw_convergence() {
        const bool alike = summary_.effective > 0.999 * static_cast<double>(ended_.size());
        if (!alike || plan_.quantiles.empty() || ended_.size() < 2) return;
        ChartFigure figure;
        figure.title = base_.title;
        figure.x_label = "number of runs";
        std::vector<Curve> curves;
        for (const double q : plan_.quantiles) curves.push_back({fmt::format("{:g} of the runs at most", q), {}, {}});
        std::vector<double> sorted;
        for (std::size_t k = 0; k < ended_.size(); ++k) {
            sorted.insert(std::upper_bound(sorted.begin(), sorted.end(), ended_[k]->reach), ended_[k]->reach);
            for (std::size_t n = 0; n < curves.size(); ++n) {
                const auto below = static_cast<std::size_t>(plan_.quantiles[n] * static_cast<double>(k));
                curves[n].x.push_back(static_cast<double>(k + 1)), curves[n].y.push_back(sorted[below]);
            }
        }

        figure.panels.push_back({"straight reach [m]", curves, false, {}, 1.0});
        figure.footer = runs_sentence(summary_);
        note(render_chart(figure, dir_ / "figures" / "convergence.png", why_not_), "figures/convergence.png");
    }

    /// Each run as a mark, over where it stands in the distribution of each key.
    void draw_scatter() {
        if (plan_.design.points.empty()) return;  // of a table nothing is known but its values
        ChartFigure figure;
        figure.title = base_.title;
        figure.x_label = "share of the key's distribution below the run's value [1]";
        figure.x_range = {0.0, 1.0};
        constexpr std::size_t at_most = 4;  // panels that can still be read
        for (std::size_t k = 0; k < std::min(at_most, plan_.vary.size()); ++k) {
            Curve curve;
            curve.name = plan_.vary[k].key;
            curve.marks = true;
            for (const SampleResult* run : ended_) {
                curve.x.push_back(plan_.design.points[static_cast<std::size_t>(run->sample)][k]);
                curve.y.push_back(run->reach);
                curve.x.push_back(Raster::nodata), curve.y.push_back(Raster::nodata);  // no line to the next
            }
            figure.panels.push_back({"straight reach [m]", {curve}, false, {}, 1.0});
        }
        figure.footer = runs_sentence(summary_);
        note(render_chart(figure, dir_ / "figures" / "scatter.png", why_not_), "figures/scatter.png");
    }

    void note(bool drawn, const std::string& file) {
        if (drawn) summary_.files.push_back(file);
    }

    const fs::path& dir_;
    const EnsemblePlan& plan_;
    const EnsembleBase& base_;
    const std::vector<SampleResult>& results_;
    EnsembleSummary& summary_;
    std::vector<const SampleResult*> ended_;
    std::vector<const SparseRasters*> peaks_;
    std::vector<double> weights_;
    double weight_ = 0.0, failed_weight_ = 0.0;
    Raster reached_;  ///< share of the runs that come to a pixel
    std::string why_not_;
};

void write_runs(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const std::vector<SampleResult>& results) {
    TextFile file(dir / "runs.csv");
    file.put("sample,weight");
    for (const Vary& vary : plan.vary) file.put(",{}", vary.key);
    file.put(",reason,time_s,steps");
    for (const Outcome& outcome : kOutcomes) file.put(",{}", outcome.key);
    if (base.survey) file.put(",iou,boundary_m");
    file.put(",left_share,mass_error,message\n");
    for (const SampleResult& r : results) {
        const SamplePoint& point = plan.points[static_cast<std::size_t>(r.sample)];
        file.put("{},{}", r.sample, point.weight);
        for (const std::string& value : point.values) file.put(",{}", csv_field(value));
        file.put(",{},{},{}", r.reason, r.time, r.steps);
        for (const Outcome& outcome : kOutcomes) file.put(",{}", r.*outcome.value);
        if (base.survey) file.put(",{},{}", text_of_known(r.iou), text_of_known(r.boundary));
        file.put(",{},{},{}\n", r.left_share, r.mass_error, csv_field(r.message));
    }
    file.commit();
}

/// What each outcome hangs on, where the samples were made for that.
std::vector<Sensitivity> sensitivity_of(const Outcome& outcome, const EnsemblePlan& plan,
                                        const std::vector<SampleResult>& results) {
    if (plan.method != Method::saltelli && plan.method != Method::morris) return {};
    std::vector<std::optional<double>> outcomes(static_cast<std::size_t>(plan.samples));
    for (const SampleResult& result : results)
        if (result.ended()) outcomes[static_cast<std::size_t>(result.sample)] = result.*outcome.value;
    return sensitivities(plan.method, plan.design, outcomes);
}

Json sensitivity_json(const EnsemblePlan& plan, const std::vector<SampleResult>& results) {
    Json all = Json::object();
    const bool shares = plan.method == Method::saltelli;
    for (const Outcome& outcome : kOutcomes) {
        const auto found = sensitivity_of(outcome, plan, results);
        for (std::size_t k = 0; k < found.size(); ++k)
            all[outcome.key][plan.vary[k].key] = {{shares ? "first_order" : "mu_star", found[k].first},
                                                  {shares ? "total" : "sigma", found[k].total}};
    }
    return all;
}

/// Rows of the page: what hangs on which key.
std::string sensitivity_section(const EnsemblePlan& plan, const std::vector<SampleResult>& results) {
    if (plan.method != Method::saltelli && plan.method != Method::morris) return "";
    const bool shares = plan.method == Method::saltelli;
    std::string page = fmt::format("\n\n## What the outcomes hang on\n\n| | key | {} | {} |\n|---|---|---:|---:|\n",
                                   shares ? "first order" : "mean effect", shares ? "total" : "its spread");
    for (const Outcome& outcome : kOutcomes) {
        const auto found = sensitivity_of(outcome, plan, results);
        for (std::size_t k = 0; k < found.size(); ++k)
            page += fmt::format("| {} | `{}` | {:.3g} | {:.3g} |\n", outcome.name, plan.vary[k].key, found[k].first,
                                found[k].total);
    }
    return page;
}

/// The runs nearest to the survey by the distance of the outlines, for people.
std::string nearest_section(const EnsemblePlan& plan, const std::vector<SampleResult>& results) {
    std::vector<const SampleResult*> runs;
    for (const SampleResult& result : results)
        if (result.ended() && result.boundary) runs.push_back(&result);
    if (runs.empty()) return "";
    std::stable_sort(runs.begin(), runs.end(),
                     [](const auto* a, const auto* b) { return *a->boundary < *b->boundary; });
    std::string page = "\n\n## Nearest to the surveyed footprint\n\n| sample | outlines apart [m] | IoU |";
    std::string line = "\n|---:|---:|---:|";
    for (const Vary& vary : plan.vary) page += fmt::format(" `{}` |", vary.key), line += "---:|";
    page += line;
    constexpr std::size_t shown = 5;
    for (std::size_t k = 0; k < std::min(shown, runs.size()); ++k) {
        page += fmt::format("\n| {} | {:.1f} | {:.3f} |", runs[k]->sample, *runs[k]->boundary, *runs[k]->iou);
        for (const std::string& value : plan.points[static_cast<std::size_t>(runs[k]->sample)].values)
            page += fmt::format(" {} |", value);
    }
    return page;
}

Json record_of(const EnsemblePlan& plan, const EnsembleSummary& summary, const Writer& writer,
               const std::vector<SampleResult>& results) {
    Json json = {{"frana", FRANA_VERSION},
                 {"ensemble", plan.file.filename().string()},
                 {"case", plan.case_file.filename().string()},
                 {"method", plan.method_name},
                 {"seed", plan.seed},
                 {"samples", summary.samples},
                 {"run", summary.run},
                 {"failed", summary.failed},
                 {"not_at_rest", summary.not_at_rest},
                 {"left_terrain", summary.left_terrain},
                 {"effective_number", summary.effective},
                 {"core_seconds", summary.core_seconds},
                 {"seconds", summary.wall_seconds ? Json(*summary.wall_seconds) : Json(nullptr)}};
    for (const Outcome& outcome : kOutcomes) {
        Json& numbers = json["results"][outcome.key] = {{"mean", writer.mean(outcome.value)}};
        for (const double q : plan.quantiles) numbers[fmt::format("q{:g}", q)] = writer.quantile(outcome.value, q);
    }
    const Json sensitivity = sensitivity_json(plan, results);
    if (!sensitivity.empty()) json["sensitivity"] = sensitivity;
    json["files"] = summary.files;
    return json;
}

std::string page_of(const EnsemblePlan& plan, const EnsembleBase& base, const EnsembleSummary& summary,
                    const Writer& writer, const std::vector<SampleResult>& results) {
    std::string page = fmt::format("# {}: many runs\n\n{}\n\n| | mean |", base.title, runs_sentence(summary));
    for (const double q : plan.quantiles) page += fmt::format(" {:g} of the runs at most |", q);
    page += "\n|---|---:|";
    for (std::size_t k = 0; k < plan.quantiles.size(); ++k) page += "---:|";
    for (const Outcome& outcome : kOutcomes) {
        page += fmt::format("\n| {} | {:.5g} |", outcome.name, writer.mean(outcome.value));
        for (const double q : plan.quantiles) page += fmt::format(" {:.5g} |", writer.quantile(outcome.value, q));
    }
    page += nearest_section(plan, results);
    page += sensitivity_section(plan, results);
    if (!summary.maps_drawn)
        page +=
            "\n\nNo maps are drawn, since the runs hold a part of the terrain only (`output.extent = \"terrain\"` "
            "holds all).";
    page += fmt::format("\n\nMethod \"{}\", seed {}. What varies:\n\n", plan.method_name, plan.seed);
    for (const Vary& vary : plan.vary) page += fmt::format("- `{}`\n", vary.key);
    page += "\nFiles:\n\n";
    for (const std::string& file : summary.files) page += fmt::format("- {}\n", file);
    return page + "\nA share of runs is the probability of an event only as far as what varies, and how, is known.\n";
}

}  // namespace

std::string runs_sentence(const EnsembleSummary& s) {
    std::string text = fmt::format("{} of {} runs", s.run, s.samples);
    if (s.failed > 0)
        text += fmt::format("; {} failed: where k of n runs exceed a threshold, between k and k + {} may", s.failed,
                            s.failed);
    if (s.not_at_rest > 0) text += fmt::format("; {} still moved at time.end", s.not_at_rest);
    if (s.left_terrain > 0)
        text += fmt::format("; of {} more than a thousandth left the terrain, so that their reach is larger",
                            s.left_terrain);
    return text + ".";
}

std::string samples_table(const EnsemblePlan& plan) {
    std::string text = "sample,weight";
    for (const Vary& vary : plan.vary) text += "," + vary.key;
    text += "\n";
    for (Index i = 0; i < plan.samples; ++i) {
        const SamplePoint& point = plan.points[static_cast<std::size_t>(i)];
        text += fmt::format("{},{}", i, point.weight);
        for (const std::string& value : point.values) text += "," + csv_field(value);
        text += "\n";
    }
    return text;
}

EnsembleSummary write_maps(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                           const std::vector<SampleResult>& results, std::optional<double> wall_seconds) {
    EnsembleSummary summary;
    summary.samples = plan.samples, summary.run = static_cast<Index>(results.size());
    summary.wall_seconds = wall_seconds;
    for (const SampleResult& result : results) {
        summary.failed += !result.ended();
        summary.not_at_rest += base.stops_at_rest && result.reason == "end";
        constexpr double noticeable = 1e-3;  // of the mass
        summary.left_terrain += result.ended() && result.left_share > noticeable;
        summary.core_seconds += result.seconds;
    }
    write_runs(dir, plan, base, results);
    summary.files = {"samples.csv", "runs.csv"};
    Writer writer(dir, plan, base, results, summary);
    writer.write();
    summary.files.emplace_back("report.md");
    write_text(dir / "report.md", page_of(plan, base, summary, writer, results));
    write_text(dir / "ensemble.json", record_of(plan, summary, writer, results).dump(2) + "\n");
    return summary;
}

}  // namespace frana
