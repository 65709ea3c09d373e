#include "run/folder/run_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "compare/overlap.h"
#include "run/folder/barrier_plans.h"
#include "run/folder/run_3d.h"
#include "run/folder/run_charts.h"
#include "run/folder/run_film.h"
#include "vtk_io/figures/map_figure.h"
#include "vtk_io/figures/map_figure_perspective.h"
#include "vtk_io/figures/map_range.h"

namespace frana {
namespace fs = std::filesystem;
namespace {

constexpr const char* kWithBed = "depth at the end, with what has become bed";

/// Outlines stay smooth where there is no terrain.
std::vector<double> depth_without_gaps(const ProductRaster& depth) {
    std::vector<double> values = depth.raster.values;
    for (double& value : values) value = std::isnan(value) ? 0.0 : value;
    return values;
}

/// "CH1903+ / LV95": the name that begins well-known text; empty without.
std::string crs_name(const std::string& wkt) {
    const std::size_t from = wkt.find('"'), to = wkt.find('"', from + 1);
    return from == std::string::npos || to == std::string::npos ? "" : wkt.substr(from + 1, to - from - 1);
}

/// Profiles, sections and inflows.
void add_lines(const FigureSource& source, MapFigure& map) {
    const auto add = [&](const std::string& name, const Polyline& line, MapLine kind) {
        if (!line.empty()) map.lines.push_back({name, line, kind});
    };
    for (const Profile& profile : source.profiles) add(profile.name, profile.line, MapLine::profile);
    for (const Section& section : source.sections) add(section.name, section.line, MapLine::section);
    for (const NamedLine& inflow : inflow_plans(source.inflows)) add(inflow.name, inflow.line, MapLine::inflow);
}

/// `extent`: the depth that says where the flow is, for a field that is no depth.
MapFigure map_of(const FigureSource& source, const ProductRaster& product, const std::string& what,
                 const ProductRaster* extent) {
    const bool depth = product.unit == "m";
    MapFigure map;
    map.bed = source.bed;
    map.field = product.raster.values;
    // Files are in SI units, pictures in those of the field.
    const bool pascal = product.unit == "Pa" && product.name != kForestRaster;
    if (pascal)
        for (double& value : map.field) value *= 1e-3;
    map.shown_above = source.footprint_depth;
    if (!depth && extent && extent->raster.values.size() == map.field.size()) {
        map.outline_field = depth_without_gaps(*extent);
        map.outline_label = extent->name == "peak_depth" ? "peak depth [m]" : "depth [m]";
    }
    map.thick_release = product.name == "peak_depth" || product.name.rfind("depth", 0) == 0;
    if (product.name.find("stress") != std::string::npos) map.colormap = Colormap::diverging;
    if (product.name.find("damage") != std::string::npos) map.range = {0.0, 1.0};
    map.title = fmt::format("{}: {}", source.title, what);
    map.field_label = fmt::format("{} [{}]", what.substr(0, what.find(" at ")),
                                  pascal ? "kPa" : product.unit);  // the title has the moment
    map.survey = source.survey;
    map.barriers = barrier_plans(source.barriers);
    add_lines(source, map);
    for (const Gauge& gauge : source.gauges) map.gauges.push_back({gauge.name, gauge.point});
    map.footer = source.footer;
    for (const std::string& more : {crs_name(source.bed.crs_wkt), source.date})
        if (!more.empty()) map.footer += "; " + more;
    map.width = source.width;
    map.height = source.height;
    return map;
}

/// What the flow took of its bed and left there, loss blue and gain red. It is shown wherever flow or a change is.
void add_change_map(const FigureSource& source, Gallery& gallery) {
    const ProductRaster *change = find_product(source.rasters, "bed_change"),
                        *peak = find_product(source.rasters, "peak_depth");
    if (change == nullptr || peak == nullptr) return;
    const std::vector<double>& values = change->raster.values;
    if (std::none_of(values.begin(), values.end(), [](double value) { return std::abs(value) > 0.0; })) return;
    gallery.add({"figures/map_bed_change.png", "change of the bed"},
                [&source, change, peak](const fs::path& png, std::string& why_not) {
                    MapFigure map = map_of(source, *change, "change of the bed", nullptr);
                    map.outline_field = depth_without_gaps(*peak);
                    for (std::size_t k = 0; k < map.field.size(); ++k)
                        if (std::abs(map.field[k]) > 0.0)
                            map.outline_field[k] = std::max(map.outline_field[k], 2.0 * source.footprint_depth);
                    map.outline_label = "change of the bed, or flow of [m]";
                    map.colormap = Colormap::diverging;
                    // A deep scar or deposit would leave what the flow eroded without colour.
                    const ColourRange range = colour_range(map.field, 0.0, Colormap::diverging, {}, Top::flow);
                    map.range = {range.low, range.high};
                    return render_map(map, png, why_not);
                });
}

/// The peak depth on the terrain, seen up the slope.
void add_view(const FigureSource& source, const ProductRaster& peak_depth, Gallery& gallery) {
    PerspectiveFigure view;
    view.bed = source.bed;
    view.field = peak_depth.raster.values;
    view.shown_above = source.footprint_depth;
    view.title = source.title + ": peak depth";
    view.thick_release = true;
    view.field_label = "peak depth [m]";
    view.survey = source.survey;
    view.barriers = barrier_plans(source.barriers);
    view.footer = source.footer;
    view.width = source.width;
    view.height = source.height;
    gallery.add_rendered({"figures/view_peak_depth.png", "peak depth, seen up the slope"},
                         [view = std::move(view)](const fs::path& png, std::string& why_not) {
                             return render_perspective(view, png, why_not);
                         });
}

}  // namespace

void add_map(const FigureSource& source, const ProductRaster& product, const std::string& what,
             const ProductRaster* extent, Gallery& gallery) {
    const std::string caption = source.survey ? what + ", with the surveyed outline" : what;
    gallery.add({fmt::format("figures/map_{}.png", product.name), caption},
                [&source, &product, what, extent](const fs::path& png, std::string& why_not) {
                    return render_map(map_of(source, product, what, extent), png, why_not);
                });
}

void add_figures(const FigureSource& source, Gallery& gallery) {
    struct MapRule {
        const char* name;
        const char* what;
    };
    for (const MapRule& rule :
         {MapRule{"peak_depth", "peak depth"}, MapRule{"peak_speed", "peak speed"},
          MapRule{"peak_dynamic_pressure", "peak dynamic pressure"}, MapRule{"arrival_time", "arrival time"}})
        if (const ProductRaster* product = find_product(source.rasters, rule.name))
            add_map(source, *product, rule.what, find_product(source.rasters, "peak_depth"), gallery);
    if (const ProductRaster* lying = find_lying(source.rasters))
        add_map(source, *lying, lying->name == "final_depth" ? "depth at the end" : kWithBed, nullptr, gallery);
    if (const ProductRaster* damage = find_product(source.rasters, "final_damage"))
        add_map(source, *damage, "damage at the end", find_product(source.rasters, "final_depth"), gallery);
    if (const ProductRaster* water = find_product(source.rasters, "final_water_depth"))
        add_map(source, *water, "free water at the end", find_product(source.rasters, "peak_depth"), gallery);
    add_change_map(source, gallery);
    for (const ProductRaster& product : source.rasters)
        if (is_friction(product.name))
            add_map(source, product,
                    product.name == kForestRaster ? std::string("detrainment K of the forest")
                                                  : product.name + " under the flow",
                    find_product(source.rasters, "peak_depth"), gallery);
    if (const ProductRaster* peak = find_product(source.rasters, "peak_depth")) add_view(source, *peak, gallery);
    add_overlay(source, gallery);
    add_bed_change(source, gallery);
    add_filmstrip(source, gallery);
    for (const Profile& profile : source.profiles) add_profile(source, profile.name, gallery);
    add_gauges(source, gallery);
    add_sections(source, gallery);
    add_3d(source, gallery);
    add_barriers(source, gallery);
    add_budgets(source, gallery);
}

double expected_drawing_seconds(const Scene& scene, Index outputs, int threads) {
    constexpr double kPlain = 0.15, kRendered = 0.7;  // a map or a chart, and a view that is rendered [s]
    constexpr Index kMaps = 6, kMostInAFilm = 200;    // of any run, the strip counted as one
    double plain = 0.0, rendered = 0.0;
    if (scene.output.png) {
        plain = static_cast<double>(kMaps + 1) + static_cast<double>(scene.profiles.size() + scene.barriers.size());
        plain += scene.gauges.empty() ? 0.0 : 1.0;
        plain += scene.sections.empty() ? 0.0 : 1.0;
        rendered = scene.solid ? 3.0 : 1.0;
    }
    if (!scene.output.film.empty()) plain += static_cast<double>(std::min(outputs, kMostInAFilm));
    // Views are rendered one after the other, the rest side by side with them.
    return std::max(kRendered * rendered, (kPlain * plain + kRendered * rendered) / std::max(threads, 1));
}

void add_overlay(const FigureSource& source, Gallery& gallery) {
    const ProductRaster* peak = find_product(source.rasters, "peak_depth");
    if (!source.survey || peak == nullptr || source.bed.values.empty()) return;
    const std::string file = fmt::format("figures/{}.png", source.comparison);
    gallery.add({file, "simulated and surveyed extent"}, [&source, peak](const fs::path& png, std::string& why_not) {
        MapFigure map = map_of(source, *peak, "simulated and surveyed extent", nullptr);
        map.field_label = "peak depth [m]";
        map.lines.clear();
        for (const Polyline& path : source.runout_paths) map.lines.push_back({"runout path", path, MapLine::path});
        const Raster covered = *ever_covered(source.rasters);
        map.simulated = pixel_outline(covered, source.footprint_depth);
        const Overlap areas = overlap(covered, source.footprint_depth, rings_of(*source.survey));
        map.footer = fmt::format("both {:.0f} m2, simulated only {:.0f} m2, surveyed only {:.0f} m2, IoU {:.3f}; ",
                                 areas.hit, areas.beyond, areas.missed, areas.iou()) +
                     map.footer;
        return render_map(map, png, why_not);
    });
}

}  // namespace frana
