#include "compare/overlap.h"

#include <cmath>

namespace frana {
namespace {

std::vector<double> pixel_edges(double first_node, double cell, Index count) {
    std::vector<double> lines;
    for (Index k = 0; k <= count; ++k) lines.push_back(first_node + (static_cast<double>(k) - 0.5) * cell);
    return lines;
}

}  // namespace

double Overlap::area_difference_percent() const { return 100.0 * std::abs(simulated() - surveyed()) / surveyed(); }

void for_each_pixel_area(const GridGeometry& grid, const Rings& rings,
                         const std::function<void(Index i, Index j, double area)>& body) {
    OutlineArea pixels(rings, pixel_edges(grid.x0, grid.cell, grid.nx), pixel_edges(grid.y0, grid.cell, grid.ny));
    std::vector<double> area(static_cast<std::size_t>(grid.nx), 0.0);
    for (Index j = 0; j < grid.ny; ++j) {
        const auto [begin, end] = pixels.row(j, area);
        for (Index i = 0; i < grid.nx; ++i) body(i, j, i >= begin && i < end ? area[static_cast<std::size_t>(i)] : 0.0);
    }
}

Overlap overlap(const Raster& depth, double limit, const Rings& survey) {
    Overlap result;
    double missed_inside = 0.0;
    const double pixel = depth.geometry.cell * depth.geometry.cell;
    for_each_pixel_area(depth.geometry, survey, [&](Index i, Index j, double surveyed) {
        if (depth.at(i, j) > limit) {
            result.hit += surveyed;
            result.beyond += pixel - surveyed;
        } else {
            missed_inside += surveyed;
        }
    });
    const double all = area_of(survey), outside = all - result.hit - missed_inside;
    constexpr double round_off = 1e-9;  // of the survey's area: sums of many pixels
    result.missed_outside = outside > round_off * all ? outside : 0.0;
    result.missed = missed_inside + result.missed_outside;
    return result;
}

}  // namespace frana
