#include "terrain/part_of.h"

#include <algorithm>
#include <cmath>

namespace frana {

std::optional<NodeBox> box_of(const GridGeometry& grid, const GridGeometry& whole) {
    constexpr double round_off = 1e-6;  // of a cell
    const double i = (grid.x0 - whole.x0) / whole.cell, j = (grid.y0 - whole.y0) / whole.cell;
    const double cells = static_cast<double>(std::max(grid.nx, grid.ny));
    if (!(std::abs(i - std::round(i)) < round_off && std::abs(j - std::round(j)) < round_off)) return {};
    if (!(std::abs(grid.cell - whole.cell) * cells < round_off * whole.cell)) return {};
    return NodeBox{std::lround(i), std::lround(j), grid.nx, grid.ny};
}

Raster part_of(const Raster& raster, const NodeBox& box) {
    const GridGeometry& g = raster.geometry;
    Raster part = Raster::filled(box.of(g), Raster::nodata);
    part.crs_wkt = raster.crs_wkt, part.source = raster.source;
    const Index i0 = std::max<Index>(0, box.i0), i1 = std::min(g.nx, box.i0 + box.nx);
    const Index j0 = std::max<Index>(0, box.j0), j1 = std::min(g.ny, box.j0 + box.ny);
    for (Index j = j0; j < j1; ++j)
        for (Index i = i0; i < i1; ++i) part.at(i - box.i0, j - box.j0) = raster.at(i, j);
    return part;
}

NodeBox united(const NodeBox& a, const NodeBox& b) {
    if (a.nx <= 0 || a.ny <= 0) return b;
    if (b.nx <= 0 || b.ny <= 0) return a;
    const Index i0 = std::min(a.i0, b.i0), j0 = std::min(a.j0, b.j0);
    return {i0, j0, std::max(a.i0 + a.nx, b.i0 + b.nx) - i0, std::max(a.j0 + a.ny, b.j0 + b.ny) - j0};
}

NodeBox common(const NodeBox& a, const NodeBox& b) {
    const Index i0 = std::max(a.i0, b.i0), j0 = std::max(a.j0, b.j0);
    return {i0, j0, std::max<Index>(0, std::min(a.i0 + a.nx, b.i0 + b.nx) - i0),
            std::max<Index>(0, std::min(a.j0 + a.ny, b.j0 + b.ny) - j0)};
}

NodeBox widened(const NodeBox& box, Index more) {
    if (box.nx <= 0 || box.ny <= 0) return box;
    return {box.i0 - more, box.j0 - more, box.nx + 2 * more, box.ny + 2 * more};
}

NodeBox cells_of(const std::vector<Vec2>& points, const GridGeometry& grid) {
    constexpr double kFar = 1e9;  // nodes: no terrain is so large
    NodeBox box;
    for (const Vec2& point : points) {
        const double x = (point.x() - grid.x0) / grid.cell, y = (point.y() - grid.y0) / grid.cell;
        if (!(std::abs(x) < kFar && std::abs(y) < kFar)) continue;
        box = united(box, {static_cast<Index>(std::floor(x)), static_cast<Index>(std::floor(y)), 2, 2});
    }
    return box;
}

}  // namespace frana
