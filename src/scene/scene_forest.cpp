// [forest] of a case: trees that take mass out of the flow.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "law/detrainment_keys.h"
#include "scene/law_places.h"
#include "scene/nodes_of_place.h"
#include "scene/remarks.h"

namespace frana {
namespace {

constexpr const char* kKey = "forest.detrainment";

template <class Body>
void for_each_node(const GridGeometry& grid, Body&& body) {
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) body(static_cast<std::size_t>(j * grid.nx + i), grid.x(i), grid.y(j));
}

/// Of the pixel at each node; 0 where there is none.
Raster pressure_of(const CaseFile& file, const GisReader& reader, Scene& scene) {
    const GridGeometry& grid = scene.bed.geometry;
    if (!file.is_text(kKey)) return Raster::filled(grid, file.number(kKey));
    const std::filesystem::path path = file.path(kKey);
    const Raster pixels = pixels_on(path, reader, scene);
    require_range(pixels, find_parameter(kKey)->range, path.string());
    Raster pressure = Raster::filled(grid, 0.0);
    Index missing = 0;
    for_each_node(grid, [&](std::size_t k, double x, double y) {
        const double value = pixel_at(pixels, x, y);
        if (std::isnan(value))
            ++missing;
        else
            pressure.values[k] = value;
    });
    if (missing > 0)
        scene.log.push_back(fmt::format("{}: {:.3g} % of {} have no data there and no forest", file.place(kKey),
                                        100.0 * double(missing) / double(grid.size()), nodes_text(scene)));
    return pressure;
}

/// Nodes outside of all polygons have no forest.
void clear_outside(const CaseFile& file, const GisReader& reader, Scene& scene, Raster& pressure) {
    const GridGeometry& grid = scene.bed.geometry;
    NodeMarks inside(pressure.values.size(), 0);
    const Polygons outline = reader.read_polygons(file.path("forest.outline"), scene.bed.crs_wkt, scene.log);
    for (const Polygon& polygon : outline.parts) mark_inside(polygon, grid, inside);
    if (std::count(inside.begin(), inside.end(), 1) == 0 && !may_begin_beyond(outline, scene))
        throw UserError(
            "found no node of the terrain in it; expected some; correct the outline or its CRS, or remove it");
    for (std::size_t k = 0; k < inside.size(); ++k)
        if (!inside[k]) pressure.values[k] = 0.0;
}

/// Whether and how much forest there is: beyond a part that is held there may be some. Ground without elevation has none.
bool any_forest(const CaseFile& file, Scene& scene, Raster& pressure) {
    double low = INFINITY, high = 0.0, area = 0.0;
    for (std::size_t k = 0; k < pressure.values.size(); ++k) {
        double& value = pressure.values[k];
        if (std::isnan(scene.bed.values[k])) value = 0.0;
        if (!(value > 0.0)) continue;
        low = std::min(low, value), high = std::max(high, value);
        area += pressure.geometry.cell * pressure.geometry.cell;
    }
    for (const double value : low < high ? std::vector<double>{low, high} : std::vector<double>{high})
        if (value > 0.0) remark_on(scene.log, Remark::detrainment, file.place(kKey), {value});
    if (area > 0.0)
        scene.log.push_back(fmt::format(
            "forest: {:.4g} ha{}, with a detrainment of {} Pa", 1e-4 * area, scene.wider ? " around the releases" : "",
            low < high ? fmt::format("{:.4g} to {:.4g}", low, high) : fmt::format("{:.4g}", high)));
    else if (!scene.wider)
        scene.log.push_back(fmt::format("{}: it is 0 everywhere on the terrain: no forest", file.place(kKey)));
    return area > 0.0 || scene.wider;
}

}  // namespace

std::optional<Forest> read_forest(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    if (!file.given(kKey)) return {};
    Forest forest;
    if (!problems.attempt(file.place(kKey), [&] { forest.pressure = pressure_of(file, reader, scene); })) return {};
    if (file.given("forest.outline") &&
        !problems.attempt(file.place("forest.outline"), [&] { clear_outside(file, reader, scene, forest.pressure); }))
        return {};
    if (!any_forest(file, scene, forest.pressure)) return {};
    read_numbers(file, "forest.", laws::detrainment_keys(), forest.law);
    return forest;
}

}  // namespace frana
