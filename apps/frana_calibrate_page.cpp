// What a calibration leaves: calibrate.json, report.md, runs.csv, posterior.csv, posterior.png.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_file.h"
#include "base/version.h"
#include "ensemble/statistics.h"
#include "frana_calibrate.h"
#include "frana_ensemble_folder.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFewSamples = 50.0;  ///< below, quantiles are guesses
constexpr Index kDrawn = 256;         ///< rows of posterior.csv

/// Values of a key at all points.
std::vector<double> values_of(const Calibration& c, std::size_t key) {
    std::vector<double> all;
    for (const auto& u : c.posterior.points()) all.push_back(c.plan.vary[key].distribution.number(u[key]));
    return all;
}

/// Mean of what is known, by weight; not a number where nothing is. Runs in which nothing flowed have no outline.
double mean_of(const std::vector<std::optional<double>>& numbers, const std::vector<double>& weights) {
    double sum = 0.0, all = 0.0;
    for (std::size_t k = 0; k < numbers.size(); ++k)
        if (numbers[k]) sum += weights[k] * *numbers[k], all += weights[k];
    return all > 0.0 ? sum / all : std::numeric_limits<double>::quiet_NaN();
}

/// How near an event is met, on the mean of the runs: by what is known before any survey, by the event's own, by those of the
/// other events, and by all.
struct Prediction {
    double prior = 0.0, own = 0.0, others = 0.0, all = 0.0;  ///< mean distance of the outlines [m]
};

std::vector<Prediction> predictions(const Calibration& c) {
    std::vector<Prediction> rows;
    const std::vector<double> all = c.posterior.weights();
    std::vector<double> first(all.size(), 0.0);
    std::fill(first.begin(), first.begin() + c.plan.samples, 1.0);  // the first round is the prior
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        std::vector<double> others(all.size(), 0.0), own(all.size(), 0.0);
        for (std::size_t f = 0; f < c.fits.size(); ++f)
            for (std::size_t k = 0; k < all.size(); ++k)
                (f == e ? own : others)[k] += c.plan.events[f].weight * c.fits[f].log_likelihood[k];
        const auto& fit = c.fits[e].mean;
        rows.push_back({mean_of(fit, first), mean_of(fit, c.posterior.weights(own)),
                        mean_of(fit, c.posterior.weights(others)), mean_of(fit, all)});
    }
    return rows;
}

/// A number of a record, null where there is none.
Json known(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json events_json(const Calibration& c) {
    Json all = Json::array();
    const std::size_t best = c.posterior.best();
    const auto rows = predictions(c);
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const EventFit& fit = c.fits[e];
        Json event = {{"name", c.plan.events[e].name},
                      {"iou", fit.iou[best] ? Json(*fit.iou[best]) : Json(nullptr)},
                      {"boundary", fit.mean[best] ? Json(*fit.mean[best]) : Json(nullptr)},
                      {"boundary_by_prior", known(rows[e].prior)},
                      {"boundary_by_own", known(rows[e].own)},
                      {"boundary_by_all", known(rows[e].all)}};
        if (c.fits.size() > 1) event["boundary_by_others"] = known(rows[e].others);
        all.push_back(event);
    }
    return all;
}

Json record_of(const Calibration& c, const std::vector<std::string>& files) {
    const std::vector<double> w = c.posterior.weights();
    const std::size_t best = c.posterior.best();
    double score = 0.0;
    for (std::size_t e = 0; e < c.fits.size(); ++e) score += c.plan.events[e].weight * c.fits[e].log_likelihood[best];
    Json json = {{"frana", FRANA_VERSION}, {"file", c.plan.file.filename().string()}};
    Json posterior = Json::object();
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) {
        const std::vector<double> values = values_of(c, k);
        json["best"][c.plan.vary[k].key] = values[best];
        const Marginal of = marginal_of(values, w);
        posterior[c.plan.vary[k].key] = {
            {"mean", of.mean}, {"sd", of.sd}, {"q05", of.q05}, {"q50", of.q50}, {"q95", of.q95}};
    }
    json["score"] = score;
    json["evaluations"] = c.posterior.points().size() * c.fits.size();
    json["failed"] = c.failed;
    json["posterior"] = posterior;
    json["effective_number"] = effective_number(w);
    json["core_seconds"] = c.seconds;
    json["sigma"] = c.plan.sigma;
    json["correlation"] = c.plan.correlation;
    json["events"] = events_json(c);
    json["files"] = files;
    return json;
}

void write_tables(const fs::path& dir, const Calibration& c) {
    TextFile runs(dir / "runs.csv");
    runs.put("sample,weight");
    for (const Vary& vary : c.plan.vary) runs.put(",{}", vary.key);
    for (const SurveyedEvent& event : c.plan.events)
        runs.put(",{},{}", csv_field(event.name + ": iou"), csv_field(event.name + ": boundary_m"));
    runs.put("\n");
    const std::vector<double> w = c.posterior.weights();
    for (std::size_t i = 0; i < w.size(); ++i) {
        runs.put("{},{}", i, w[i]);
        for (std::size_t k = 0; k < c.plan.vary.size(); ++k)
            runs.put(",{}", c.plan.vary[k].distribution.number(c.posterior.points()[i][k]));
        for (const EventFit& fit : c.fits) runs.put(",{},{}", text_of_known(fit.iou[i]), text_of_known(fit.mean[i]));
        runs.put("\n");
    }
    runs.commit();
    TextFile drawn(dir / "posterior.csv");
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) drawn.put("{}{}", k == 0 ? "" : ",", c.plan.vary[k].key);
    drawn.put("\n");
    for (const std::size_t i : c.posterior.drawn(kDrawn)) {
        for (std::size_t k = 0; k < c.plan.vary.size(); ++k)
            drawn.put("{}{}", k == 0 ? "" : ",", c.plan.vary[k].distribution.number(c.posterior.points()[i][k]));
        drawn.put("\n");
    }
    drawn.commit();
}

/// How much more likely a value is than before the survey, over its place in the prior.
Curve density_of(const Calibration& c, std::size_t key) {
    constexpr std::size_t bins = 20;
    std::vector<double> weight(bins, 0.0);
    const std::vector<double> w = c.posterior.weights();
    for (std::size_t i = 0; i < w.size(); ++i)
        weight[std::min(bins - 1, static_cast<std::size_t>(c.posterior.points()[i][key] * bins))] += w[i];
    Curve curve;
    curve.name = c.plan.vary[key].key;
    for (std::size_t b = 0; b < bins; ++b)
        for (const std::size_t edge : {b, b + 1}) {
            curve.x.push_back(static_cast<double>(edge) / bins);
            curve.y.push_back(weight[b] * bins);
        }
    return curve;
}

bool draw(const fs::path& dir, const Calibration& c) {
    ChartFigure figure;
    figure.title = "What the surveys tell: " + c.plan.file.filename().string();
    figure.x_label = "share of the key's distribution below [1]";
    figure.x_range = {0.0, 1.0};
    constexpr std::size_t at_most = 4;  // panels that can still be read
    for (std::size_t k = 0; k < std::min(at_most, c.plan.vary.size()); ++k)
        figure.panels.push_back(
            {"over the prior [1]", {density_of(c, k), {"before", {0.0, 1.0}, {1.0, 1.0}}}, false, {}, 1.0});
    std::string why_not;
    return render_chart(figure, dir / "posterior.png", why_not);
}

}  // namespace

std::string calibration_section(const Calibration& c) {
    const std::vector<double> w = c.posterior.weights();
    const std::size_t best = c.posterior.best();
    const double effective = effective_number(w);
    std::string page = "| Key | best | mean | sd | 5 % | 50 % | 95 % |\n|---|---:|---:|---:|---:|---:|---:|\n";
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) {
        const std::vector<double> values = values_of(c, k);
        const Marginal of = marginal_of(values, w);
        page += fmt::format("| `{}` | {:.4g} | {:.4g} | {:.2g} | {:.4g} | {:.4g} | {:.4g} |\n", c.plan.vary[k].key,
                            values[best], of.mean, of.sd, of.q05, of.q50, of.q95);
    }
    page += fmt::format("\n{} points, {} runs, {} failed; the points tell as much as {:.0f} of equal weight.", w.size(),
                        w.size() * c.fits.size(), c.failed, effective);
    if (effective < kFewSamples) page += " Fewer than 50 are few: give more samples or rounds, or a larger sigma.";
    page += "\n\n| Event | IoU of the best | outlines apart [m]: best | by the prior | by its own survey |";
    page += c.fits.size() > 1 ? " by the other events | by all |\n|---|---:|---:|---:|---:|---:|---:|\n"
                              : "\n|---|---:|---:|---:|---:|\n";
    const auto rows = predictions(c);
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const EventFit& fit = c.fits[e];
        page += fmt::format("| {} | {:.3f} | {:.1f} | {:.1f} | {:.1f} |", c.plan.events[e].name,
                            fit.iou[best].value_or(0.0), fit.mean[best].value_or(0.0), rows[e].prior, rows[e].own);
        page += c.fits.size() > 1 ? fmt::format(" {:.1f} | {:.1f} |\n", rows[e].others, rows[e].all) : "\n";
    }
    for (std::size_t e = 0; c.fits.size() > 1 && e < c.fits.size(); ++e)
        if (rows[e].others > rows[e].prior)
            page += fmt::format("\nWhat the other events tell predicts {} worse than what was known before.\n",
                                c.plan.events[e].name);
    return page;
}

std::vector<std::string> write_calibration(const fs::path& dir, const Calibration& c) {
    const std::vector<double> w = c.posterior.weights();
    if (!(effective_number(w) > 0.0))
        throw UserError(
            fmt::format("{}: found no run that comes near a survey; expected one or more; widen the ranges, or raise "
                        "calibrate.sigma",
                        c.plan.file.string()));
    std::vector<std::string> files = {"runs.csv", "posterior.csv", "report.md", "calibrate.json"};
    write_tables(dir, c);
    if (draw(dir, c)) files.emplace_back("posterior.png");
    write_text(
        dir / "report.md",
        fmt::format("# Calibration by {}\n\n{}\nOutlines err by {:g} m, independently every {:g} m of the surveyed "
                    "outline. `posterior.csv` is a table of samples for `frana ensemble` (method \"table\").\n",
                    c.plan.file.filename().string(), calibration_section(c), c.plan.sigma, c.plan.correlation));
    write_text(dir / "calibrate.json", record_of(c, files).dump(2) + "\n");
    return files;
}

}  // namespace frana
