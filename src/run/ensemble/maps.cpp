#include "run/ensemble/maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "ensemble/statistics.h"
#include "io/gdal_writer.h"
#include "run/ensemble/outcomes.h"
#include "run/folder/barrier_plans.h"
#include "run/folder/record_file.h"
#include "run/folder/states.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/writers.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

std::string first_failure_of(const std::vector<SampleResult>& results) {
    const auto first =
        std::find_if(results.begin(), results.end(), [](const SampleResult& result) { return !result.ended(); });
    if (first == results.end()) return "";
    return first->message.empty() ? first->reason : first->message;
}

void require_answer(const WeightedRuns& runs, const fs::path& dir, const std::string& first_failure) {
    if (!(runs.total > 0.0))
        throw UserError(fmt::format(
            "{}: found no run with an answer{}; expected one or more; the reasons are in runs.csv", dir.string(),
            first_failure.empty() ? "" : fmt::format(", the first one failed so: {}", first_failure)));
}

/// Where no run came there is nothing to show.
void hide_unreached(Raster& values, const Raster& reached) {
    for (std::size_t k = 0; k < values.values.size(); ++k)
        if (reached.values[k] == 0.0) values.values[k] = Raster::nodata;
}

/// Nor beyond the terrain.
void onto_terrain(Raster& values, const EnsembleBase& base) {
    if (base.whole == base.bed.geometry)
        for (std::size_t k = 0; k < values.values.size(); ++k)
            if (std::isnan(base.bed.values[k])) values.values[k] = Raster::nodata;
    values.crs_wkt = base.bed.crs_wkt;
}

/// A threshold for people.
std::string amount(double value, const PeakField& field) {
    const ShownUnit shown = shown_unit(field);
    return fmt::format("{:g} {}", shown.factor * value, shown.name);
}

class MapWriter {
public:
    MapWriter(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base, const WeightedRuns& runs,
              EnsembleSummary& summary)
        : dir_(dir), plan_(plan), base_(base), runs_(runs), summary_(summary) {}

    void write() {
        require_answer(runs_, dir_, summary_.first_failure);
        fs::create_directories(dir_ / "rasters");
        fs::create_directories(dir_ / "figures");
        for (std::size_t f = 0; f < plan_.fields.size(); ++f) write_field(f);
        write_for_paraview();
    }

private:
    void raster(const std::string& name, Raster values, const char* unit, const std::string& meaning) {
        hide_unreached(values, reached_);
        everywhere(name, std::move(values), unit, meaning);
    }

    void everywhere(const std::string& name, Raster values, const char* unit, const std::string& meaning) {
        onto_terrain(values, base_);
        write_geotiff(dir_ / "rasters" / (name + ".tif"), values, unit, meaning);
        summary_.files.push_back("rasters/" + name + ".tif");
    }

    void write_field(std::size_t f) {
        const PeakField& field = peak_field(plan_.fields[f]);
        PixelValues pixels(base_.whole);
        pixels.gather(*runs_.peaks, runs_.weights, f);
        if (f == 0) reached_ = pixels.reached();
        if (field.is_time) return write_arrival(field, pixels);
        const auto asked = plan_.exceed.find(field.name);
        if (asked != plan_.exceed.end())
            for (const double threshold : asked->second) write_exceedance(field, threshold, pixels);
        pixels.for_each_quantile(plan_.quantiles, [&](std::size_t k, Raster quantile) {
            raster(fmt::format("quantile_{}_{:g}", field.name, plan_.quantiles[k]), std::move(quantile), field.unit,
                   fmt::format("{}: {:g} of the runs do not exceed it", field.meaning, plan_.quantiles[k]));
        });
        raster(fmt::format("mean_{}", field.name), pixels.mean(), field.unit, fmt::format("mean {}", field.meaning));
        write_sensitivity(field, pixels);
        if (f > 0) return;
        raster("probability_reached", reached_, "1", "share of the runs that come there");
        probabilities_.push_back({"probability_reached", "1", reached_.values});
        draw_map(reached_, "probability_reached",
                 fmt::format("probability of a depth above {:g} m", base_.footprint_depth));
        write_outlines();
    }

    void write_arrival(const PeakField& field, const PixelValues& pixels) {
        for (const double q : plan_.quantiles)
            everywhere(fmt::format("quantile_{}_{:g}", field.name, q), pixels.arrival_quantile(q), field.unit,
                       fmt::format("time by which {:g} of the runs have come; none where fewer come", q));
    }

    /// What the field depends on at each pixel, where the samples were made for that.
    void write_sensitivity(const PeakField& field, const PixelValues& pixels) {
        const bool shares = plan_.method == Method::saltelli;
        if (!shares && plan_.method != Method::morris) return;
        const SensitivityMaps maps = sensitivity_maps(plan_.method, plan_.design, runs_.samples(), pixels);
        for (std::size_t k = 0; k < plan_.vary.size(); ++k) {
            const std::string& key = plan_.vary[k].key;
            if (!shares) {
                everywhere(fmt::format("mean_effect_{}_{}", field.name, key), maps.first[k], field.unit,
                           fmt::format("mean effect of {} on the {}", key, field.meaning));
                continue;
            }
            everywhere(fmt::format("first_order_{}_{}", field.name, key), maps.first[k], "1",
                       fmt::format("share of the variance of the {} by {} alone", field.meaning, key));
            everywhere(
                fmt::format("total_{}_{}", field.name, key), maps.total[k], "1",
                fmt::format("share of the variance of the {} by {} and all that goes with it", field.meaning, key));
        }
    }

    void write_outlines() {
        constexpr const char* kName = "probability.geojson";
        Raster reached = reached_;
        reached.crs_wkt = base_.bed.crs_wkt;
        write_levels(dir_ / kName, reached, "probability", {0.05, 0.5, 0.95});
        summary_.files.push_back(kName);
    }

    void write_exceedance(const PeakField& field, double threshold, const PixelValues& pixels) {
        const std::string name = fmt::format("probability_{}_{:g}", field.name, threshold);
        const std::string meaning = meaning_of_exceedance(field, threshold);
        const Raster p = pixels.exceeds(threshold);
        raster(name, p, "1", meaning);
        probabilities_.push_back({name, "1", p.values});
        Raster error = p, low = p, high = p;
        const double all = runs_.total + runs_.failed_weight;
        for (std::size_t k = 0; k < p.values.size(); ++k) {
            error.values[k] = standard_error(p.values[k], summary_.effective);
            low.values[k] = p.values[k] * runs_.total / all;
            high.values[k] = (p.values[k] * runs_.total + runs_.failed_weight) / all;
        }
        raster(name + "_error", error, "1", "standard error of the " + meaning);
        // The standard error is 0 where all runs agree, however few they are. Designs are closer than chance; a table
        // may be chance.
        if (plan_.method == Method::random || plan_.method == Method::table) write_wilson(name, p, meaning);
        if (runs_.failed_weight > 0.0) {
            raster(name + "_low", low, "1", meaning + ", if no run that failed did");
            everywhere(name + "_high", high, "1", meaning + ", if every run that failed did");
        }
        draw_map(p, name, fmt::format("probability of {} above {}", field.meaning, amount(threshold, field)));
    }

    /// The upper bound stands also where no run came: few runs do not tell that none will.
    void write_wilson(const std::string& name, const Raster& p, const std::string& meaning) {
        Raster low = p, high = p;
        for (std::size_t k = 0; k < p.values.size(); ++k)
            std::tie(low.values[k], high.values[k]) = wilson_bounds(p.values[k], summary_.effective);
        raster(name + "_wilson_low", low, "1", "lower 95 % bound of the " + meaning);
        everywhere(name + "_wilson_high", high, "1", "upper 95 % bound of the " + meaning);
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
        figure.barriers = barrier_plans(base_.barriers);
        figure.footer = runs_sentence(summary_);
        note(render_map(figure, dir_ / "figures" / (name + ".png"), why_not_), "figures/" + name + ".png");
    }

    /// The probabilities on the terrain, and a state of ParaView that shows them.
    void write_for_paraview() {
        if (!(base_.whole == base_.bed.geometry)) return;
        write_terrain(dir_, base_.bed);
        write_terrain_maps(dir_, base_.bed, probabilities_);
        const auto look = write_states(dir_, base_.title);
        summary_.files.insert(summary_.files.end(), {"terrain.vti", "maps.vti"});
        // NOLINTNEXTLINE(readability-container-size-empty): of JSON, which may hold something else
        if (look["states"]["probability"] == "") summary_.files.emplace_back("states/probability.pvsm");
    }

    void note(bool drawn, const std::string& file) {
        if (drawn) summary_.files.push_back(file);
    }

    const fs::path& dir_;
    const EnsemblePlan& plan_;
    const EnsembleBase& base_;
    const WeightedRuns& runs_;
    EnsembleSummary& summary_;
    Raster reached_;                       ///< share of the runs that come to a pixel
    std::vector<NamedMap> probabilities_;  ///< for ParaView
    std::string why_not_;
};

/// What the last page in this folder says that it made.
std::vector<std::string> files_of_last_time(const fs::path& dir) {
    const auto json = json_in(dir / "ensemble.json");
    std::vector<std::string> files;
    if (!lists_files(json)) return files;
    for (const auto& file : json["files"])
        if (file.is_string()) files.push_back(file.get<std::string>());
    return files;
}

/// Old maps that the plan no longer has would be taken for those of these runs.
void remove_others(const fs::path& dir, const std::vector<std::string>& before, const std::vector<std::string>& now) {
    for (const std::string& file : before) {
        const fs::path name = fs::path(file).lexically_normal();
        if (std::find(now.begin(), now.end(), file) != now.end()) continue;
        if (name.is_absolute() || name.empty() || *name.begin() == "..") continue;
        std::error_code ignored;
        fs::remove(dir / name, ignored);
    }
}

}  // namespace

EnsembleSummary write_maps(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                           const KeptResults& kept, std::optional<double> wall_seconds) {
    const std::vector<SampleResult>& results = kept.results;
    EnsembleSummary summary;
    summary.samples = plan.samples, summary.run = static_cast<Index>(results.size());
    summary.wall_seconds = wall_seconds;
    for (const SampleResult& result : results) {
        const bool counts = plan.points[static_cast<std::size_t>(result.sample)].weight > 0.0;  // in the maps
        summary.failed += !result.ended();
        summary.not_at_rest += counts && result.still_moves;
        summary.left_terrain += counts && result.left_terrain();
        summary.core_seconds += result.seconds;
        summary.remarks.add(result.sample, result.remarks);
    }
    summary.first_failure = first_failure_of(results);
    const std::vector<std::string> before = files_of_last_time(dir);
    const WeightedRuns runs(plan, base,
                            kept);  // refuses peaks that are not those of the runs before anything is written
    write_runs(dir, plan, base, results);
    summary.files = {"samples.csv", "runs.csv"};
    summary.effective = std::min(effective_number(runs.weights), runs.independent(plan));
    summary.failed_share = runs.failed_weight / (runs.total + runs.failed_weight);
    summary.weighted = std::any_of(plan.points.begin(), plan.points.end(), [&](const SamplePoint& point) {
        return point.weight != plan.points.front().weight;
    });
    MapWriter(dir, plan, base, runs, summary).write();
    write_hazard(dir, plan, base, runs, summary);
    draw_charts(dir, plan, base, runs, summary);
    write_view(dir, plan, base, runs, summary);
    write_page(dir, plan, base, runs, results, summary);
    remove_others(dir, before, summary.files);
    return summary;
}

std::string meaning_of_exceedance(const PeakField& field, double threshold) {
    return fmt::format("share of the runs with {} above {:g} {}", field.meaning, threshold, field.unit);
}

Raster probability_map(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base, const KeptResults& kept,
                       const std::string& field, double threshold) {
    const auto found = std::find(plan.fields.begin(), plan.fields.end(), field);
    if (found == plan.fields.end() || peak_field(field).is_time) {
        std::vector<std::string> fields = plan.fields;
        fields.erase(std::remove(fields.begin(), fields.end(), "arrival_time"), fields.end());
        throw UserError(
            fmt::format("{}: found no {} of its runs that could be exceeded; expected one of {}; add it to "
                        "ensemble.fields and run the ensemble again",
                        dir.string(), field, fmt::join(fields, ", ")));
    }
    if (!(threshold >= 0.0 && std::isfinite(threshold)))
        throw UserError(fmt::format("above: found {:g}; expected a number from 0 on; give one in {}", threshold,
                                    peak_field(field).unit));
    if (!(threshold >= base.footprint_depth || field != "peak_depth"))
        throw UserError(
            fmt::format("above: found {:g} m of peak_depth; expected at least output.footprint_depth, {:g} m, "
                        "below which nothing is kept of the runs",
                        threshold, base.footprint_depth));
    const WeightedRuns runs(plan, base, kept);
    require_answer(runs, dir, first_failure_of(kept.results));
    PixelValues pixels(base.whole);
    pixels.gather(*runs.peaks, runs.weights, 0);
    const Raster reached = pixels.reached();
    pixels.gather(*runs.peaks, runs.weights, static_cast<std::size_t>(found - plan.fields.begin()));
    Raster probability = pixels.exceeds(threshold);
    hide_unreached(probability, reached);
    onto_terrain(probability, base);
    return probability;
}

}  // namespace frana
