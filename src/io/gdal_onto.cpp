#include "io/gdal_onto.h"

#include <fmt/core.h>

#include <algorithm>

namespace frana::gdal {

std::vector<double> onto_grid(const RasterFile& file, const GridGeometry& grid) {
    std::vector<NodeWeights> in_x = axis_weights(file.x_axis(), grid.x0, grid.cell, grid.nx);
    const std::vector<NodeWeights> in_y = axis_weights(file.y_axis(), grid.y0, grid.cell, grid.ny);
    Index first = file.x_axis().count, end = 0;
    for (const NodeWeights& node : in_x) {
        if (node.fine.empty()) continue;
        first = std::min(first, node.first);
        end = std::max(end, node.first + Index(node.fine.size()));
    }
    if (end <= first) return std::vector<double>(std::size_t(grid.size()), Raster::nodata);
    first = std::max<Index>(first - 1, 0);  // neighbours of the outermost columns, for their slopes
    end = std::min(end + 1, file.x_axis().count);
    for (NodeWeights& node : in_x) node.first -= first;
    return resample(in_x, in_y, {end - first, file.y_axis().count, [&](Index row, Index rows) {
                                     return file.read(first, row, end - first, rows);
                                 }});
}

std::string how_resampled(const RasterFile& file, double cell) {
    const double dx = file.x_axis().size, dy = file.y_axis().size;
    const std::string pixels =
        file.square() ? fmt::format("{:.6g} m pixels", dx) : fmt::format("pixels of {:.6g} m by {:.6g} m", dx, dy);
    const double near_equal = 1.0 - 1e-6;
    const bool coarser = cell > near_equal * std::max(dx, dy), finer = cell < near_equal * std::min(dx, dy);
    return fmt::format("{} {} to {:.6g} m cells", pixels,
                       coarser ? "averaged"
                       : finer ? "interpolated (cubic)"
                               : "resampled",
                       cell);
}

std::string extent_text(const std::array<double, 4>& extent) {
    return fmt::format("[{:.12g}, {:.12g}, {:.12g}, {:.12g}]", extent[0], extent[1], extent[2], extent[3]);
}

}  // namespace frana::gdal
