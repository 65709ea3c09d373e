// Classes of hazard of an ensemble.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "io/gdal_writer.h"
#include "run/ensemble/outcomes.h"
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

/// How the runs of each scenario ended: what failed or was not run makes the classes too low.
std::string remark_on_scenarios(const HazardTable& table, const EnsemblePlan& plan, const WeightedRuns& of) {
    if (table.event_years) return "";
    std::map<double, std::pair<Index, Index>> scenarios;  // runs with an answer, of how many
    for (const SamplePoint& point : plan.points)
        if (point.weight > 0.0) ++scenarios[point.return_period].second;
    for (const SampleResult* run : of.ended)
        ++scenarios[plan.points[static_cast<std::size_t>(run->sample)].return_period].first;
    constexpr Index few = 10;  // runs, of which a share of a half is known to a sixth
    std::string remark;
    for (const auto& [years, runs] : scenarios) {
        const auto [answered, all] = runs;
        if (answered == 0)
            remark +=
                fmt::format("No run of the scenario of {:g} years has an answer: its classes are missing. ", years);
        else if (answered < all)
            remark +=
                fmt::format("{} of {} runs of the scenario of {:g} years have no answer: classes may be too low. ",
                            all - answered, all, years);
        else if (answered < few && all > 1)
            remark += fmt::format("The scenario of {:g} years has {} runs only. ", years, answered);
    }
    if (static_cast<Index>(scenarios.size()) * 2 > static_cast<Index>(plan.points.size()) && plan.points.size() > few)
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
    figure.title = base.title;
    figure.survey = base.footprint;
    figure.footer =
        fmt::format("Classes of hazard: {}. {}", rule_of(table), summary.hazard_remark + runs_sentence(summary));
    std::string why_not;
    if (render_map(figure, dir / "figures" / "hazard_class.png", why_not))
        summary.files.emplace_back("figures/hazard_class.png");
}

}  // namespace

void write_hazard(const std::filesystem::path& dir, const EnsemblePlan& plan, const EnsembleBase& base,
                  const WeightedRuns& of, EnsembleSummary& summary) {
    if (!plan.hazard) return;
    const HazardTable& table = *plan.hazard;
    std::vector<HazardRun> runs;
    for (std::size_t k = 0; k < of.ended.size(); ++k)
        runs.push_back(
            {of.peaks[k], of.weights[k], plan.points[static_cast<std::size_t>(of.ended[k]->sample)].return_period});
    summary.hazard_remark = remark_on_scenarios(table, plan, of);
    const std::vector<std::uint8_t> numbers = hazard_classes(table, plan.fields, runs, base.whole.size());
    std::vector<RasterClass> classes;
    for (std::size_t k = 0; k < table.classes.size(); ++k) {
        const auto count = std::count(numbers.begin(), numbers.end(), static_cast<std::uint8_t>(k + 1));
        summary.hazard.push_back({table.classes[k].name, static_cast<Index>(k + 1),
                                  static_cast<double>(count) * base.whole.cell * base.whole.cell});
        classes.push_back({table.classes[k].name, table.classes[k].colour});
    }
    write_class_geotiff(dir / "rasters" / "hazard_class.tif", base.whole, base.bed.crs_wkt, numbers, classes,
                        "class of hazard: " + rule_of(table));
    summary.files.insert(summary.files.end(), {"rasters/hazard_class.tif", "rasters/hazard_class.tif.aux.xml"});
    draw(dir, base, table, numbers, summary);
}

}  // namespace frana
