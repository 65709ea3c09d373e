// Tables and page of an ensemble: runs.csv, samples.csv, report.md, ensemble.json.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/text_file.h"
#include "base/version.h"
#include "ensemble/vary_words.h"
#include "run/ensemble/outcomes.h"
#include "run/ensemble/remarks_json.h"
#include "run/ensemble/shard_store.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// What each outcome depends on, where the samples were made for that.
std::vector<Sensitivity> sensitivity_of(const Outcome& outcome, const EnsemblePlan& plan,
                                        const std::vector<SampleResult>& results) {
    if (plan.method != Method::saltelli && plan.method != Method::morris) return {};
    std::vector<std::optional<double>> outcomes(static_cast<std::size_t>(plan.samples));
    for (const SampleResult& result : results) {
        if (!result.ended()) continue;
        std::optional<double>& number = outcomes[static_cast<std::size_t>(result.sample)];
        number = outcome.never == Outcome::Never::zero ? outcome.counted(result) : outcome.value(result);
        // Of the runs that come alone, indices would be those of other samples than were drawn.
        if (outcome.never == Outcome::Never::infinite && !number) return {};
    }
    return sensitivities(plan.method, plan.design, outcomes);
}

Json sensitivity_json(const EnsemblePlan& plan, const EnsembleBase& base, const std::vector<SampleResult>& results) {
    Json all = Json::object();
    const bool shares = plan.method == Method::saltelli;
    for (const Outcome& outcome : outcomes_of(base)) {
        const auto found = sensitivity_of(outcome, plan, results);
        for (std::size_t k = 0; k < found.size(); ++k)
            all[outcome.key][plan.vary[k].key] = {{shares ? "first_order" : "mu_star", found[k].first},
                                                  {shares ? "total" : "sigma", found[k].total}};
    }
    return all;
}

/// Rows of the page: what depends on which key.
std::string sensitivity_section(const EnsemblePlan& plan, const EnsembleBase& base,
                                const std::vector<SampleResult>& results) {
    if (plan.method != Method::saltelli && plan.method != Method::morris) return "";
    const bool shares = plan.method == Method::saltelli;
    std::string page = fmt::format("\n\n## What the outcomes hang on\n\n| | key | {} | {} |\n|---|---|---:|---:|\n",
                                   shares ? "first order" : "mean effect", shares ? "total" : "its spread");
    constexpr double shown = 0.005;  // a share nearer to 0 or 1 is as good as that
    bool outside = false, crossed = false;
    for (const Outcome& outcome : outcomes_of(base)) {
        const auto found = sensitivity_of(outcome, plan, results);
        for (std::size_t k = 0; k < found.size(); ++k) {
            page += fmt::format("| {} | `{}` | {:.3g} | {:.3g} |\n", outcome.name, plan.vary[k].key, found[k].first,
                                found[k].total);
            for (const double share : {found[k].first, found[k].total})
                outside = outside || share < -shown || share > 1.0 + shown;
            crossed = crossed || found[k].first > found[k].total + shown;
        }
    }
    if (shares && outside) page += "\nShares below 0 or above 1: too few samples.";
    if (shares && crossed)
        page += fmt::format("{}\nA first order above its total: too few samples.", outside ? "\n" : "");
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
            page += fmt::format(" {} |", shown_value(value));
    }
    return page;
}

/// A number, or null: what a share of the runs, or all of them, do not have.
Json known(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json statistics_json(const EnsemblePlan& plan, const WeightedRuns& runs, const Outcome& outcome) {
    const std::optional<double> mean = runs.mean(outcome);
    Json numbers = {{"mean", mean ? Json(*mean) : Json(nullptr)}};
    for (const double q : plan.quantiles) numbers[fmt::format("q{:g}", q)] = known(runs.quantile(outcome, q));
    if (outcome.never != Outcome::Never::cannot_be) numbers["share_that_came"] = runs.share_with(outcome);
    return numbers;
}

Json hazard_json(const HazardTable& table, const EnsembleSummary& summary) {
    Json json = {{"preset", table.preset.empty() ? Json(nullptr) : Json(table.preset)},
                 {"return_period", table.event_years ? Json(*table.event_years) : Json(nullptr)},
                 {"share", table.share},
                 {"remark", summary.hazard_remark},
                 {"classes", Json::array()}};
    for (const HazardArea& one : summary.hazard) {
        Json told = {{"name", one.name}, {"number", one.number}, {"area_m2", one.area}};
        if (one.bounds)
            told["area_if_unanswered_came_nowhere_m2"] = one.bounds->first,
            told["area_if_unanswered_came_everywhere_m2"] = one.bounds->second;
        json["classes"].push_back(std::move(told));
    }
    return json;
}

/// How often a strength comes, by which the table is read.
std::string hazard_rule(const HazardTable& table) {
    if (table.event_years)
        return fmt::format(
            "The runs are of one event, which comes back in {:g} years (`return_period`). A strength comes back in "
            "that time over the share of the runs that reach it. A place has the greatest class of all strengths.",
            *table.event_years);
    return fmt::format(
        "At each place a scenario has the strongest level that at least {:g} % of its runs reach (`share`). It comes "
        "back in its own return period. A place has the greatest class of all scenarios.",
        100.0 * table.share);
}

/// The table of hazard, and how much is in each class.
std::string hazard_section(const EnsemblePlan& plan, const EnsembleSummary& summary) {
    if (!plan.hazard) return "";
    const HazardTable& table = *plan.hazard;
    std::string page = fmt::format("\n\n## Classes of hazard{}\n\n{}\n\n| Strength |",
                                   table.preset.empty() ? "" : ": " + table.preset, hazard_rule(table));
    std::string line = "\n|---|";
    for (const double years : table.years) page += fmt::format(" up to {:g} years |", years), line += "---|";
    page += " later |" + line + "---|";
    for (const HazardLevel& level : table.levels) {
        page += fmt::format("\n| {} |", level.name);
        for (const std::size_t number : level.classes)
            page += fmt::format(" {} |", number > 0 ? table.classes[number - 1].name : "none");
    }
    if (!summary.hazard_remark.empty()) page += "\n\n" + summary.hazard_remark;
    const bool bounded = !summary.hazard.empty() && summary.hazard.front().bounds;
    page += bounded
                ? "\n\n| Class | Area [m2] | had runs without an answer come nowhere | had they come wherever another "
                  "run did, as strong as the table knows |\n|---|---:|---:|---:|"
                : "\n\n| Class | Area [m2] |\n|---|---:|";
    for (const HazardArea& one : summary.hazard) {
        page += fmt::format("\n| {} | {:.6g} |", one.name, one.area);
        if (one.bounds) page += fmt::format(" {:.6g} | {:.6g} |", one.bounds->first, one.bounds->second);
    }
    return page;
}

Json record_of(const EnsemblePlan& plan, const EnsembleBase& base, const EnsembleSummary& summary,
               const WeightedRuns& runs, const std::vector<SampleResult>& results) {
    Json json = {{"frana", FRANA_VERSION},
                 {"ensemble", plan.file.filename().string()},
                 {"case", plan.case_file.filename().string()},
                 {"method", plan.method_name},
                 {"seed", plan.seed},
                 {"samples", summary.samples},
                 {"run", summary.run},
                 {"failed", summary.failed},
                 {"failed_share", summary.failed_share},
                 {"not_at_rest", summary.not_at_rest},
                 {"left_terrain", summary.left_terrain},
                 {"effective_number", summary.effective},
                 {"core_seconds", summary.core_seconds},
                 {"seconds", summary.wall_seconds ? Json(*summary.wall_seconds) : Json(nullptr)}};
    for (const Outcome& outcome : outcomes_of(base))
        json["results"][outcome.key] = statistics_json(plan, runs, outcome);
    if (plan.hazard) json["hazard"] = hazard_json(*plan.hazard, summary);
    const Json sensitivity = sensitivity_json(plan, base, results);
    if (!sensitivity.empty()) json["sensitivity"] = sensitivity;
    json["remarks"] = base.remarks;
    json["remarks_on_runs"] = shared_remarks_json(summary.remarks.all());
    if (summary.failed > 0) json["first_failure"] = summary.first_failure;
    json["files"] = summary.files;
    return json;
}

/// How statistics count runs that never come to a gauge.
std::string gauges_note(const EnsembleBase& base, const WeightedRuns& runs) {
    if (base.gauges.empty()) return "";
    std::string note = "\n\nShare of the runs that come to a gauge:";
    for (std::size_t k = 0; k < base.gauges.size(); ++k)
        note += fmt::format("{} {} {:.3g}", k > 0 ? "," : "", base.gauges[k].name,
                            runs.share_with(outcomes_of_gauge(base, k).front()));
    return note +
           ". Where a run never comes, depth and speed count as 0 and the time as later than any; the mean time is "
           "that of "
           "the runs that come.";
}

std::string page_of(const EnsemblePlan& plan, const EnsembleBase& base, const EnsembleSummary& summary,
                    const WeightedRuns& runs, const std::vector<SampleResult>& results) {
    std::string page = fmt::format("# {}: many runs\n\n{}", base.title, runs_sentence(summary));
    if (summary.failed > 0)
        page += fmt::format("\n\nThe first run that failed says: {}. The reasons of all are in `runs.csv`.",
                            summary.first_failure);
    page += "\n\n| | mean |";
    for (const double q : plan.quantiles) page += fmt::format(" {:g} % of the runs stay below |", 100.0 * q);
    page += "\n|---|---:|";
    for (std::size_t k = 0; k < plan.quantiles.size(); ++k) page += "---:|";
    const auto shown = [](double number) { return std::isfinite(number) ? fmt::format("{:.5g}", number) : "never"; };
    for (const Outcome& outcome : outcomes_of(base)) {
        const std::optional<double> mean = runs.mean(outcome);
        page += fmt::format("\n| {} | {} |", outcome.name, mean ? shown(*mean) : "never");
        for (const double q : plan.quantiles) page += fmt::format(" {} |", shown(runs.quantile(outcome, q)));
    }
    page += gauges_note(base, runs);
    page += hazard_section(plan, summary);
    page += nearest_section(plan, results);
    page += sensitivity_section(plan, base, results);
    if (!summary.maps_drawn)
        page +=
            "\n\nNo maps are drawn, since the runs hold a part of the terrain only (`output.extent = \"terrain\"` "
            "holds all).";
    page += fmt::format("\n\nMethod \"{}\", seed {}. What varies:\n\n", plan.method_name, plan.seed);
    for (const Vary& vary : plan.vary)
        if (!vary.prior.empty())
            page += fmt::format("- {}\n", vary.prior);
        else if (plan.method == Method::table)
            page += fmt::format("- `{}`: as the table of samples has it\n", vary.key);
        else
            page += fmt::format("- `{}`: {}\n", vary.key, words_of(vary));
    if (!base.remarks.empty()) page += "\nRemarks on the case:\n\n";
    for (const std::string& remark : base.remarks) page += fmt::format("- {}\n", remark);
    const std::vector<std::string> on_runs = summary.remarks.sentences(summary.run);
    if (!on_runs.empty()) page += "\nRemarks on the runs:\n\n";
    for (const std::string& remark : on_runs) page += fmt::format("- {}\n", remark);
    page += "\nFiles:\n\n";
    for (const std::string& file : summary.files) page += fmt::format("- {}\n", file);
    return page + "\nA share of runs is the probability of an event only as far as what varies, and how, is known.\n";
}

}  // namespace

void write_runs(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                const std::vector<SampleResult>& results) {
    TextFile file(dir / "runs.csv");
    file.put("sample,weight");
    for (const Vary& vary : plan.vary) file.put(",{}", vary.key);
    file.put(",reason,time_s,steps");
    const std::vector<Outcome> outcomes = outcomes_of(base);
    for (const Outcome& outcome : outcomes) file.put(",{}", outcome.key);
    if (base.survey) file.put(",iou,boundary_m");
    file.put(",left_share,mass_error,message\n");
    for (const SampleResult& r : results) {
        const SamplePoint& point = plan.points[static_cast<std::size_t>(r.sample)];
        file.put("{},{}", r.sample, point.weight);
        for (const std::string& value : point.values) file.put(",{}", csv_field(shown_value(value)));
        file.put(",{},{},{}", r.reason, r.time, r.steps);
        const auto known = [&](const std::optional<double>& number) {  // of a run without an answer nothing is
            file.put(",{}", r.ended() ? text_of_known(number) : "");
        };
        for (const Outcome& outcome : outcomes) known(outcome.value(r));
        if (base.survey) known(r.iou), known(r.boundary);
        known(r.left_share), known(r.mass_error);
        file.put(",{}\n", csv_field(r.message));
    }
    file.commit();
}

std::string runs_sentence(const EnsembleSummary& s) {
    std::string text = fmt::format("{} of {} runs", s.run, s.samples);
    if (s.run < s.samples)
        text += " (the others are not made yet: the maps are of a part, which need not be a fair sample)";
    if (s.weighted) text += fmt::format(", which tell as much as {:.0f} of equal weight", s.effective);
    if (s.failed > 0 && s.weighted)
        text += fmt::format(
            "; {0} with {1:.3g} of the weight failed: had these exceeded a threshold nowhere, a probability p of the "
            "maps "
            "would be {2:.3g} p, and had they exceeded it everywhere, {2:.3g} p + {1:.3g}",
            s.failed, s.failed_share, 1.0 - s.failed_share);
    else if (s.failed > 0)
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
        for (const std::string& value : point.values) text += "," + csv_field(shown_value(value));
        text += "\n";
    }
    return text;
}

void write_page(const fs::path& dir, const EnsemblePlan& plan, const EnsembleBase& base, const WeightedRuns& runs,
                const std::vector<SampleResult>& results, EnsembleSummary& summary) {
    summary.files.emplace_back("report.md");
    write_text(dir / "report.md", page_of(plan, base, summary, runs, results));
    write_text(dir / "ensemble.json", record_of(plan, base, summary, runs, results).dump(2) + "\n");
}

}  // namespace frana
