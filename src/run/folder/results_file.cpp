#include "run/folder/results_file.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "observe/profiles.h"
#include "terrain/places.h"

namespace frana {
namespace {

using Attributes = std::vector<std::pair<std::string, Attribute>>;

/// Outlines of the pixels where `inside` holds for the raster's value.
template <class Inside>
std::vector<AttributedShape> outlines_where(const Raster& raster, const Inside& inside) {
    std::vector<std::uint8_t> marks(raster.values.size());
    for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = inside(raster.values[k]) ? 1 : 0;
    return pixel_outlines(raster.geometry, std::move(marks));
}

ShapeLayer deeper(const char* layer, const Raster& covered, const std::vector<double>& depths) {
    ShapeLayer all{layer, {}};
    for (const double depth : depths)
        for (AttributedShape& shape : outlines_where(covered, [&](double value) { return value > depth; })) {
            shape.attributes.insert(shape.attributes.begin(), {"depth_m", depth});
            all.shapes.push_back(std::move(shape));
        }
    return all;
}

/// The flow on the pixels of some places.
struct PeaksThere {
    double depth = Raster::nodata, speed = Raster::nodata, pressure = Raster::nodata;
    double arrival = Raster::nodata;
};

PeaksThere peaks_at(const std::vector<Vec2>& places, const std::vector<ProductRaster>& rasters) {
    PeaksThere peaks;
    const auto value = [&](const char* name, Index i, Index j) {
        const ProductRaster* product = find_product(rasters, name);
        return product ? product->raster.at(i, j) : Raster::nodata;
    };
    const GridGeometry& grid = rasters.front().raster.geometry;
    for (const Vec2& place : places) {
        const NodeAt node = nearest_node(grid, place);
        const auto [i, j] = node;
        if (!has_node(grid, node) || !(value("peak_depth", i, j) > 0.0)) continue;
        peaks.depth = std::fmax(peaks.depth, value("peak_depth", i, j));
        peaks.speed = std::fmax(peaks.speed, value("peak_speed", i, j));
        peaks.pressure = std::fmax(peaks.pressure, value("peak_dynamic_pressure", i, j));
        peaks.arrival = std::fmin(peaks.arrival, value("arrival_time", i, j));
    }
    return peaks;
}

Attributes attributes_of(const std::string& name, const PeaksThere& peaks) {
    return {{"name", name},
            {"peak_depth_m", peaks.depth},
            {"peak_speed_m_s", peaks.speed},
            {"peak_dynamic_pressure_Pa", peaks.pressure},
            {"arrival_s", peaks.arrival}};
}

/// Of a line, places no farther apart than half a pixel.
std::vector<Vec2> places_on(const Polyline& line, double cell) {
    std::vector<Vec2> places;
    for (const Station& station : stations(line, 0.5 * cell)) places.push_back(station.point);
    return places;
}

ShapeLayer section_layer(const Scene& scene, const RunRecord& record) {
    ShapeLayer layer{"sections", {}};
    for (const Section& section : scene.sections)
        for (const SectionSummary& passed : record.sections)
            if (passed.name == section.name)
                layer.shapes.push_back({section.line,
                                        {{"name", section.name},
                                         {"volume_m3", passed.volume},
                                         {"sediment_m3", passed.sediment},
                                         {"peak_discharge_m3_s", passed.peak},
                                         {"peak_s", passed.peak_time}}});
    return layer;
}

ShapeLayer barriers(const std::vector<ProductRaster>& rasters, RunRecord& record) {
    try {
        return barrier_layer(record.barrier_sources, record.barriers, rasters);
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("the barriers were not written for a GIS: {}", error.what()));
        return {"barriers", {}};
    }
}

/// Pixels with material at the start in none of the outlines and masks: of a surface, or all of the terrain.
std::vector<AttributedShape> material_without_shape(const Raster& arrival, const std::vector<ReleaseSource>& sources) {
    Raster elsewhere = arrival;
    if (const std::optional<Raster> marks = released_at_start(sources, arrival))
        for (std::size_t k = 0; k < elsewhere.values.size(); ++k)
            if (marks->values[k] > 0.0) elsewhere.values[k] = Raster::nodata;
    return outlines_where(elsewhere, [](double time) { return time == 0.0; });
}

/// Outlines and masks. A release with neither is known by the pixels where material was at the start.
ShapeLayer releases(const Scene& scene, const std::vector<ProductRaster>& rasters, RunRecord& record) {
    ShapeLayer layer{"release", {}};
    if (rasters.empty()) return layer;
    const auto& all = record.release_sources;
    const bool bare = std::any_of(all.begin(), all.end(),
                                  [](const ReleaseSource& source) { return !source.late && !source.has_shape(); });
    const ProductRaster* const arrival = find_product(rasters, "arrival_time");
    const GridGeometry& terrain = scene.wider ? scene.wider->grid : scene.bed.geometry;
    try {
        layer = release_layer(all, record.extras.late, record.volume_of_releases, terrain.pixel_extent(),
                              rasters.front().raster.crs_wkt);
        if (bare && arrival)
            for (AttributedShape& shape : material_without_shape(arrival->raster, all))
                layer.shapes.push_back(std::move(shape));
    } catch (const UserError& error) {
        record.warnings.push_back(fmt::format("outlines of releases were not written for a GIS: {}", error.what()));
    }
    return layer;
}

}  // namespace

std::vector<ShapeLayer> result_layers(const Scene& scene, const std::vector<ProductRaster>& rasters,
                                      RunRecord& record) {
    std::vector<ShapeLayer> layers{barriers(rasters, record)};
    if (const std::optional<Raster> covered = ever_covered(rasters)) {
        layers.push_back(deeper("footprint", *covered, {scene.output.footprint_depth}));
        layers.push_back(deeper("outlines", *covered, {0.5, 1.0, 2.0, 5.0}));
    }
    layers.push_back(releases(scene, rasters, record));
    ShapeLayer gauges{"gauges", {}}, profiles{"profiles", {}}, survey{"survey", {}};
    if (!rasters.empty()) {
        for (const Gauge& gauge : scene.gauges)
            gauges.shapes.push_back({gauge.point, attributes_of(gauge.name, peaks_at({gauge.point}, rasters))});
        const double cell = rasters.front().raster.geometry.cell;
        for (const Profile& profile : scene.profiles)
            profiles.shapes.push_back(
                {profile.line, attributes_of(profile.name, peaks_at(places_on(profile.line, cell), rasters))});
    }
    layers.push_back(std::move(gauges));
    layers.push_back(std::move(profiles));
    layers.push_back(section_layer(scene, record));
    for (ShapeLayer& layer : inflow_layers(scene, record.inflows)) layers.push_back(std::move(layer));
    if (scene.survey)
        for (const Polygon& part : scene.survey->parts) survey.shapes.push_back({part, {}});
    layers.push_back(std::move(survey));
    return layers;
}

}  // namespace frana
