#include "scene/nodes_of_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Where the edges of a polygon cross each row of nodes [m].
std::vector<std::vector<double>> crossings_of(const Polygon& polygon, const GridGeometry& grid) {
    std::vector<std::vector<double>> rows(static_cast<std::size_t>(grid.ny));
    const auto first_row = [&](double y) {  // that lies at y or above it
        return static_cast<Index>(std::clamp(std::ceil((y - grid.y0) / grid.cell) - 1.0, 0.0, double(grid.ny)));
    };
    for (const auto& ring : polygon.rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
            const double low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y());
            for (Index j = first_row(low); j < grid.ny && grid.y(j) < high; ++j)
                if ((a.y() <= grid.y(j)) != (b.y() <= grid.y(j)))
                    rows[static_cast<std::size_t>(j)].push_back(a.x() + (grid.y(j) - a.y()) / (b.y() - a.y()) *
                                                                            (b.x() - a.x()));
        }
    return rows;
}

/// Whether a raster touches the terrain, but not the part of it that the scene holds.
bool misses_part(const std::filesystem::path& file, const GisReader& reader, const Scene& scene) {
    if (!scene.wider) return false;
    const auto touches = [&](const GridGeometry& grid) {
        return reader.place_of(file, grid.pixel_extent(), scene.bed.crs_wkt).touches;
    };
    return !touches(scene.bed.geometry) && touches(scene.wider->grid);
}

}  // namespace

std::string place_text(const GridGeometry& g, std::size_t k) {
    const auto n = static_cast<Index>(k);
    return fmt::format("x {:.10g}, y {:.10g}", g.x(n % g.nx), g.y(n / g.nx));
}

double pixel_at(const Raster& raster, double x, double y) {
    const Index pixel = pixel_of(raster.geometry, x, y);
    return pixel < 0 ? Raster::nodata : raster.values[static_cast<std::size_t>(pixel)];
}

std::string nodes_text(const Scene& scene) {
    return scene.wider ? "the nodes around the releases" : "the terrain's nodes";
}

Raster pixels_on(const std::filesystem::path& file, const GisReader& reader, Scene& scene) {
    if (misses_part(file, reader, scene)) return Raster::filled({1, 1, 0.0, 0.0, 1.0}, Raster::nodata);
    return reader.read_raster(file, scene.bed.geometry.pixel_extent(), scene.bed.crs_wkt, scene.log);
}

Raster field_on(const std::filesystem::path& file, const GisReader& reader, Scene& scene) {
    if (misses_part(file, reader, scene)) return Raster::filled(scene.bed.geometry, Raster::nodata);
    return reader.read_onto(file, scene.bed.geometry, scene.bed.crs_wkt, scene.log);
}

Raster field_within_pixels(const std::filesystem::path& file, const Raster& pixels, const GisReader& reader,
                           Scene& scene) {
    constexpr double kRoundOff = 1e-9;
    const GridGeometry& grid = scene.bed.geometry;
    const bool none = pixels.geometry.size() == 1 && std::isnan(pixels.values.front());  // it lies elsewhere
    const bool larger = !none && pixels.geometry.cell > (1.0 + kRoundOff) * grid.cell;
    const auto extent = grid.pixel_extent();
    if (!larger || reader.place_of(file, extent, scene.bed.crs_wkt).needs_warp) return field_on(file, reader, scene);
    const double around = 2.0 * pixels.geometry.cell;  // neighbours of the outermost pixels
    scene.log.push_back(
        fmt::format("{}: values of {:.6g} m pixels interpolated to {:.6g} m cells, none beyond the pixels around",
                    file.filename().string(), pixels.geometry.cell, grid.cell));
    return on_closer_nodes(
        reader.read_raster(file, {extent[0] - around, extent[1] - around, extent[2] + around, extent[3] + around},
                           scene.bed.crs_wkt, scene.log),
        grid);
}

bool may_begin_beyond(const Polygons& polygons, const Scene& scene) {
    if (!scene.wider) return false;
    std::vector<Vec2> corners;
    for (const Polygon& polygon : polygons.parts)
        for (const auto& ring : polygon.rings) corners.insert(corners.end(), ring.begin(), ring.end());
    const auto met = [&](const GridGeometry& grid) { return common(cells_of(corners, grid), NodeBox::all(grid)); };
    const NodeBox here = met(scene.bed.geometry), there = met(scene.wider->grid);
    return there.nx > here.nx || there.ny > here.ny;
}

void require_range(const Raster& pixels, const Range& range, const std::string& file) {
    std::size_t bad = 0, first = 0;
    for (std::size_t k = pixels.values.size(); k-- > 0;)
        if (!std::isnan(pixels.values[k]) && !range.holds(pixels.values[k])) ++bad, first = k;
    if (bad == 0) return;
    throw UserError(
        fmt::format("{}: found {} pixel(s) out of range, such as {:.6g} at {}; expected numbers {}; correct them", file,
                    bad, pixels.values[first], place_text(pixels.geometry, first), range.text()));
}

void mark_inside(const Polygon& polygon, const GridGeometry& grid, NodeMarks& marks) {
    Index row = 0;
    for (std::vector<double>& crossings : crossings_of(polygon, grid)) {
        std::sort(crossings.begin(), crossings.end());
        for (std::size_t n = 0; n + 1 < crossings.size(); n += 2) {
            const auto node = [&](double x) {
                const double i = std::ceil((x - grid.x0) / grid.cell);
                return static_cast<Index>(std::clamp(i, 0.0, static_cast<double>(grid.nx)));
            };
            std::fill(marks.begin() + row + node(crossings[n]), marks.begin() + row + node(crossings[n + 1]), char{1});
        }
        row += grid.nx;
    }
}

}  // namespace frana
