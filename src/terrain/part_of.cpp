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

}  // namespace frana
