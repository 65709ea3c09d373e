#include "vtk_io/figures/map_figure_overlay.h"

#include <algorithm>
#include <cmath>

#include "vtk_io/figures/map_figure_paint.h"
#include "vtk_io/hillshade.h"

namespace frana {

std::vector<char> nodes_inside(const std::vector<Polyline>& rings, const GridGeometry& grid) {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(grid.ny));
    const auto first_at_or_above = [](double nodes, Index count) {
        return static_cast<Index>(std::clamp(std::ceil(nodes), 0.0, static_cast<double>(count)));
    };
    for (const Polyline& ring : rings)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            Vec2 low = ring[k], high = ring[(k + 1) % ring.size()];
            if (low.y() > high.y()) std::swap(low, high);
            for (Index j = first_at_or_above((low.y() - grid.y0) / grid.cell, grid.ny);
                 j < grid.ny && grid.y(j) < high.y(); ++j) {
                const double share = (grid.y(j) - low.y()) / (high.y() - low.y());
                crossings[static_cast<std::size_t>(j)].push_back(low.x() + share * (high.x() - low.x()));
            }
        }
    std::vector<char> inside(static_cast<std::size_t>(grid.size()), 0);
    for (Index j = 0; j < grid.ny; ++j) {
        auto& row = crossings[static_cast<std::size_t>(j)];
        std::sort(row.begin(), row.end());
        for (std::size_t k = 0; k + 1 < row.size(); k += 2) {
            const Index from = first_at_or_above((row[k] - grid.x0) / grid.cell, grid.nx);
            const Index to = first_at_or_above((row[k + 1] - grid.x0) / grid.cell, grid.nx);
            for (Index i = from; i < to; ++i) inside[static_cast<std::size_t>(j * grid.nx + i)] = 1;
        }
    }
    return inside;
}

Pixels painted_overlay(const Raster& bed, const std::vector<Polyline>& simulated,
                       const std::vector<Polyline>& surveyed) {
    const GridGeometry& g = bed.geometry;
    Pixels pixels(static_cast<int>(g.nx), static_cast<int>(g.ny));
    const auto shade = hillshade(bed, shading_exaggeration(bed));
    const ReliefGrey relief(shade);
    const std::vector<char> ours = nodes_inside(simulated, g), theirs = nodes_inside(surveyed, g);
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) {
            const std::size_t k = static_cast<std::size_t>(y) * pixels.width + x;
            const bool bare = std::isnan(shade[k]);
            const double grey = bare ? 0.0 : relief(shade[k]);
            const Colour ground = bare ? colours::no_data : scaled(colours::white, grey);
            if (!ours[k] && !theirs[k]) {
                pixels.set(x, y, ground);
                continue;
            }
            const Colour& area = !theirs[k] ? colours::beyond : ours[k] ? colours::hit : colours::missed;
            pixels.set(x, y, bare ? area : colour_on_ground(area, grey));
        }
    return pixels;
}

std::vector<Polyline> all_rings(const Polygons& polygons) {
    std::vector<Polyline> rings;
    for (const Polygon& part : polygons.parts) rings.insert(rings.end(), part.rings.begin(), part.rings.end());
    return rings;
}

}  // namespace frana
