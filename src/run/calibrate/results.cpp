#include "run/calibrate/results.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_file.h"
#include "base/version.h"
#include "ensemble/predictions.h"
#include "ensemble/statistics.h"
#include "run/calibrate/kept_runs.h"
#include "run/ensemble/remarks_json.h"
#include "run/ensemble/shard_store.h"
#include "vtk_io/figures/chart_figure.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// A number of a record, null where there is none.
Json known(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json known(const std::optional<double>& number) { return number ? known(*number) : Json(nullptr); }

/// How far the run is off in all that counts of an event.
Json misfits_json(const SurveyedEvent& event, const EventScores& scores) {
    Json all = Json::object();
    for (const Evidence evidence : event.objective) {
        const auto& misfit = scores.misfits[static_cast<std::size_t>(evidence)];
        all[kind_of(evidence).word] = {{"rms", misfit ? Json(misfit->rms) : Json(nullptr)},
                                       {"sigma", event.errors.of(evidence)},
                                       {"number", misfit ? Json(misfit->number) : Json(nullptr)}};
        if (is_raster(evidence))
            all[kind_of(evidence).word]["unsurveyed_m3"] = misfit ? Json(misfit->unsurveyed) : Json(nullptr);
    }
    return all;
}

Json events_json(const Calibration& c) {
    Json all = Json::array();
    const std::size_t best = c.posterior.best();
    const auto rows = predictions(c);
    for (std::size_t e = 0; e < c.fits.size(); ++e) {
        const EventScores& scores = c.fits[e].scores[best];
        Json event = {{"name", c.plan.events[e].name},
                      {"iou", known(scores.iou)},
                      {"boundary", known(scores.boundary)},
                      {"left_share", c.fits[e].left_share[best]},
                      {"boundary_by_prior", known(rows[e].prior.mean)},
                      {"boundary_median_of_prior", known(rows[e].prior.median)},
                      {"boundary_by_own", known(rows[e].own.mean)},
                      {"boundary_by_all", known(rows[e].all.mean)}};
        if (c.fits.size() > 1) event["boundary_by_others"] = known(rows[e].others.mean);
        for (std::size_t f = 0; c.fits.size() > 1 && f < c.fits.size(); ++f)
            event["boundary_by_one"].push_back(known(rows[e].by_one[f].mean));
        event["misfits"] = misfits_json(c.plan.events[e], scores);
        event["remarks_on_runs"] = shared_remarks_json(c.fits[e].remarks.all());
        all.push_back(event);
    }
    return all;
}

Json optimum_json(const Calibration& c) {
    const Optimum& optimum = *c.optimum;
    Json json = {{"values", Json::object()},           {"score", -optimum.misfit}, {"noise", known(optimum.noise)},
                 {"evaluations", optimum.evaluations}, {"ended", optimum.ended},   {"events", Json::array()}};
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k)
        json["values"][c.plan.vary[k].key] = c.plan.vary[k].distribution.number(optimum.point[k]);
    for (std::size_t e = 0; e < c.plan.events.size(); ++e)
        json["events"].push_back({{"name", c.plan.events[e].name},
                                  {"iou", known(optimum.scores[e].iou)},
                                  {"boundary", known(optimum.scores[e].boundary)},
                                  {"misfits", misfits_json(c.plan.events[e], optimum.scores[e])}});
    return json;
}

Json record_of(const Calibration& c, const std::vector<std::string>& files) {
    const std::vector<double> w = c.posterior.weights();
    const std::size_t best = c.posterior.best();
    double score = 0.0;
    for (std::size_t e = 0; e < c.fits.size(); ++e) score += c.plan.events[e].weight * c.fits[e].log_likelihood[best];
    Json json = {{"frana", FRANA_VERSION}, {"file", c.plan.file.filename().string()}, {"mark", mark_of(c.plan)}};
    Json posterior = Json::object();
    for (std::size_t k = 0; k < c.plan.vary.size(); ++k) {
        const std::vector<double> values = values_of(c, k);
        json["best"][c.plan.vary[k].key] = values[best];
        const Marginal of = marginal_of(values, w);
        posterior[c.plan.vary[k].key] = {
            {"mean", of.mean}, {"sd", of.sd}, {"q05", of.q05}, {"q50", of.q50}, {"q95", of.q95}};
    }
    Json pairs = Json::array();
    for (const KeyPair& pair : pairs_of(c))
        pairs.push_back({{"keys", {pair.first, pair.second}}, {"correlation", known(pair.correlation)}});
    json["score"] = score;
    json["evaluations"] = c.posterior.points().size() * c.fits.size();
    json["failed"] = c.failed;
    json["not_at_rest"] = c.not_at_rest;
    json["left_terrain"] = c.left_terrain;
    json["posterior"] = posterior;
    json["pairs"] = pairs;
    if (c.optimum) json["optimum"] = optimum_json(c);
    json["effective_number"] = effective_number(w);
    json["core_seconds"] = c.seconds;
    json["events"] = events_json(c);
    json["files"] = files;
    return json;
}

void write_tables(const fs::path& dir, const Calibration& c) {
    TextFile runs(dir / "runs.csv");
    runs.put("sample,weight");
    for (const Vary& vary : c.plan.vary) runs.put(",{}", vary.key);
    for (const SurveyedEvent& event : c.plan.events) {
        for (const char* column : {": left_share", ": iou", ": boundary_m"})
            runs.put(",{}", csv_field(event.name + column));
        for (const Evidence evidence : event.objective)
            runs.put(",{}", csv_field(fmt::format("{}: {}_rms", event.name, kind_of(evidence).word)));
    }
    runs.put("\n");
    const std::vector<double> w = c.posterior.weights();
    for (std::size_t i = 0; i < w.size(); ++i) {
        runs.put("{},{}", i, w[i]);
        for (std::size_t k = 0; k < c.plan.vary.size(); ++k)
            runs.put(",{}", c.plan.vary[k].distribution.number(c.posterior.points()[i][k]));
        for (std::size_t e = 0; e < c.fits.size(); ++e) {
            const EventScores& scores = c.fits[e].scores[i];
            runs.put(",{},{},{}", c.fits[e].left_share[i], text_of_known(scores.iou), text_of_known(scores.boundary));
            for (const Evidence evidence : c.plan.events[e].objective) {
                const auto& misfit = scores.misfits[static_cast<std::size_t>(evidence)];
                runs.put(",{}", misfit ? fmt::format("{}", misfit->rms) : "");
            }
        }
        runs.put("\n");
    }
    runs.commit();
}

/// Each point that is drawn stands there once, with how often it was: so its run is made once.
void write_draws(const fs::path& dir, const Calibration& c) {
    std::map<std::size_t, Index> often;
    for (const std::size_t i : c.posterior.drawn(c.plan.draws)) ++often[i];
    TextFile drawn(dir / "posterior.csv");
    drawn.put("weight");
    for (const Vary& vary : c.plan.vary) drawn.put(",{}", vary.key);
    drawn.put("\n");
    for (const auto& [i, times] : often) {
        drawn.put("{}", times);
        for (std::size_t k = 0; k < c.plan.vary.size(); ++k)
            drawn.put(",{}", c.plan.vary[k].distribution.number(c.posterior.points()[i][k]));
        drawn.put("\n");
    }
    drawn.commit();
}

Curve curve_of(const Calibration& c, std::size_t key) {
    Curve curve;
    curve.name = c.plan.vary[key].key;
    const std::vector<double> density = density_of(c, key);
    for (std::size_t b = 0; b < density.size(); ++b)
        for (const std::size_t edge : {b, b + 1}) {
            curve.x.push_back(static_cast<double>(edge) / static_cast<double>(density.size()));
            curve.y.push_back(density[b]);
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
            {"over the prior [1]", {curve_of(c, k), {"before", {0.0, 1.0}, {1.0, 1.0}}}, false, {}, 1.0});
    std::string why_not;
    return render_chart(figure, dir / "posterior.png", why_not);
}

}  // namespace

std::vector<std::string> write_calibration(const fs::path& dir, const Calibration& c) {
    const std::vector<double> w = c.posterior.weights();
    if (c.failed == static_cast<Index>(w.size() * c.fits.size()))
        throw UserError(
            fmt::format("{}: found that all {} runs failed, the first one so: {}; expected runs that end; give other "
                        "ranges, or correct the case",
                        c.plan.file.string(), c.failed, c.first_failure));
    if (!(effective_number(w) > 0.0))
        throw UserError(
            fmt::format("{}: found no run that comes near a survey; expected one or more; widen the ranges, or raise "
                        "calibrate.sigma",
                        c.plan.file.string()));
    std::vector<std::string> files = {"runs.csv", "posterior.csv", "report.md", "calibrate.json"};
    write_tables(dir, c);
    write_draws(dir, c);
    if (draw(dir, c)) files.emplace_back("posterior.png");
    write_text(
        dir / "report.md",
        fmt::format("# Calibration by {}\n\n{}\n`posterior.csv` is a table of samples for `frana ensemble` (method "
                    "\"table\").\n",
                    c.plan.file.filename().string(), calibration_section(c)));
    write_text(dir / "calibrate.json", record_of(c, files).dump(2) + "\n");
    return files;
}

}  // namespace frana
