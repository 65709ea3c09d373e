// Classes of hazard of an ensemble.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "io/gdal_writer.h"
#include "run/ensemble/outcomes.h"
#include "run/folder/barrier_plans.h"
#include "vtk_io/figures/map_figure.h"

namespace frana {
namespace {

std::string rule_of(const HazardTable& table) {
    const std::string from = table.preset.empty() ? "own table" : table.preset;
    if (table.event_years)
        return fmt::format("{}; each strength by its share of the runs of an event that comes back in {:g} years", from,
                           *table.event_years);
    return fmt::format("{}; of each scenario the strength that {:g} of its runs reach", from, table.share);
}

/// How the runs of each scenario ended. Shares are of those that have an answer: classes may be wrong either way.
std::string remark_on_scenarios(const HazardTable& table, const EnsemblePlan& plan, const WeightedRuns& of) {
    if (table.event_years) return "";
    std::map<double, std::pair<Index, Index>> scenarios;  // runs with an answer, of how many
    Index weighted = 0;                                   // others tell nothing
    for (const SamplePoint& point : plan.points)
        if (point.weight > 0.0) ++scenarios[point.return_period].second, ++weighted;
    for (const SampleResult* run : of.ended) {
        const SamplePoint& point = plan.points[static_cast<std::size_t>(run->sample)];
        if (point.weight > 0.0) ++scenarios[point.return_period].first;
    }
    constexpr Index few = 10;  // runs, of which a share of a half is known to a sixth
    std::string remark;
    for (const auto& [years, runs] : scenarios) {
        const auto [answered, all] = runs;
        if (answered == 0)
            remark +=
                fmt::format("No run of the scenario of {:g} years has an answer: its classes are missing. ", years);
        else if (answered < all)
            remark += fmt::format(
                "{} of {} runs of the scenario of {:g} years have no answer: classes may be wrong either way, within "
                "the bounds told. ",
                all - answered, all, years);
        else if (answered < few && all > 1)
            remark += fmt::format("The scenario of {:g} years has {} runs only. ", years, answered);
    }
    if (static_cast<Index>(scenarios.size()) * 2 > weighted && weighted > few)
        remark = "Nearly each run has a return period of its own: give runs of one scenario the same. ";
    return remark;
}

void draw(const std::filesystem::path& dir, const EnsembleBase& base, const HazardTable& table,
          const std::vector<std::uint8_t>& numbers, EnsembleSummary& summary) {
    if (!(base.whole == base.bed.geometry)) return;  // a part of the terrain is held
    MapFigure figure;
    figure.bed = base.bed;
    figure.field.assign(numbers.begin(), numbers.end());
    figure.shown_above = 0.5;
    for (const HazardClass& one : table.classes)
        figure.classes.push_back({one.name, {one.colour[0], one.colour[1], one.colour[2], 255}});
    figure.title = base.title + ": classes of hazard";
    figure.survey = base.footprint;
    figure.barriers = barrier_plans(base.barriers);
    figure.footer =
        fmt::format("Classes of hazard: {}. {}", rule_of(table), summary.hazard_remark + runs_sentence(summary));
    std::string why_not;
    if (render_map(figure, dir / "figures" / "hazard_class.png", why_not))
        summary.files.emplace_back("figures/hazard_class.png");
}

/// All runs of the plan that have a weight.
struct ScenarioRuns {
    std::vector<ReachedLevels> reached;  ///< of those with an answer
    std::vector<HazardRun> runs;
    bool all_answered = true;
};

ScenarioRuns runs_of(const EnsemblePlan& plan, const WeightedRuns& of) {
    ScenarioRuns all;
    std::vector<std::size_t> fields;
    for (std::size_t f = 0; f < plan.fields.size(); ++f) fields.push_back(f);
    all.reached.resize(of.ended.size());
    of.peaks->for_each_run(fields, [&](std::size_t run, const SparseRasters& peaks) {
        all.reached[run] = reached_levels(*plan.hazard, plan.fields, peaks);
    });
    std::vector<char> answered(plan.points.size(), 0);
    for (std::size_t k = 0; k < of.ended.size(); ++k) {
        const auto sample = static_cast<std::size_t>(of.ended[k]->sample);
        answered[sample] = 1;
        if (of.weights[k] > 0.0)
            all.runs.push_back({&all.reached[k], of.weights[k], plan.points[sample].return_period});
    }
    for (std::size_t k = 0; k < plan.points.size(); ++k)
        if (!answered[k] && plan.points[k].weight > 0.0) {
            all.runs.push_back({nullptr, plan.points[k].weight, plan.points[k].return_period});
            all.all_answered = false;
        }
    return all;
}

/// Writes classes as a raster, and returns the area of each [m2].
std::vector<double> written(const std::filesystem::path& dir, const std::string& name, const EnsembleBase& base,
                            const HazardTable& table, const std::vector<std::uint8_t>& numbers,
                            const std::string& description, EnsembleSummary& summary) {
    std::vector<RasterClass> classes;
    std::vector<double> areas;
    for (std::size_t k = 0; k < table.classes.size(); ++k) {
        const auto count = std::count(numbers.begin(), numbers.end(), static_cast<std::uint8_t>(k + 1));
        areas.push_back(static_cast<double>(count) * base.whole.cell * base.whole.cell);
        classes.push_back({table.classes[k].name, table.classes[k].colour});
    }
    const std::string file = "rasters/" + name + ".tif";
    write_class_geotiff(dir / file, base.whole, base.bed.crs_wkt, numbers, classes, description + rule_of(table));
    summary.files.insert(summary.files.end(), {file, file + ".aux.xml"});
    return areas;
}

}  // namespace

void write_hazard(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                  const WeightedRuns& of, EnsembleSummary& summary) {
    if (!plan.hazard) return;
    const HazardTable& table = *plan.hazard;
    const ScenarioRuns all = runs_of(plan, of);
    summary.hazard_remark = remark_on_scenarios(table, plan, of);
    const auto classes_if = [&](Unanswered unanswered) {
        return hazard_classes(table, all.runs, base.whole.size(), unanswered);
    };
    const std::vector<std::uint8_t> numbers = classes_if(Unanswered::left_out);
    const std::vector<double> areas = written(dir, "hazard_class", base, table, numbers, "class of hazard: ", summary);
    for (std::size_t k = 0; k < areas.size(); ++k)
        summary.hazard.push_back({table.classes[k].name, static_cast<Index>(k + 1), areas[k], std::nullopt});
    if (!all.all_answered) {
        const auto least = written(dir, "hazard_class_at_least", base, table, classes_if(Unanswered::came_nowhere),
                                   "class of hazard, had runs without an answer come nowhere: ", summary);
        const auto most = written(dir, "hazard_class_at_most", base, table, classes_if(Unanswered::came_everywhere),
                                  "class of hazard, had runs without an answer come wherever another did: ", summary);
        for (std::size_t k = 0; k < areas.size(); ++k) summary.hazard[k].bounds = {least[k], most[k]};
    }
    draw(dir, base, table, numbers, summary);
}

}  // namespace frana
