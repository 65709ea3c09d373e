// Classes of hazard of an ensemble.
#include <fmt/core.h>

#include <algorithm>

#include "frana_ensemble_outcomes.h"
#include "io/gdal_writer.h"
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
    figure.footer = fmt::format("Classes of hazard: {}. {}", rule_of(table), runs_sentence(summary));
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
