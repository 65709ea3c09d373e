#include "compare/given_path.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "compare/nearest.h"
#include "compare/runout.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Whether `holds` of any place along a path, `step` apart at most [m].
template <class Holds>
bool any_along(const Polyline& path, double step, const Holds& holds) {
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const Vec2 along = path[k + 1] - path[k];
        const double parts = std::max(1.0, std::ceil(along.norm() / step));
        for (double part = 0.0; part < parts; ++part)
            if (holds(path[k] + part / parts * along)) return true;
    }
    return !path.empty() && holds(path.back());
}

/// Whether `holds` of the value of any node within a cell of a path.
template <class Holds>
bool any_node_along(const Polyline& path, const Raster& raster, const Holds& holds) {
    const GridGeometry& g = raster.geometry;
    return any_along(path, g.cell, [&](const Vec2& place) {
        const NodeAt at = nearest_node(g, place);
        for (Index dj = -1; dj <= 1; ++dj)
            for (Index di = -1; di <= 1; ++di) {
                const NodeAt node{at.i + di, at.j + dj};
                if (has_node(g, node) && holds(raster.at(node.i, node.j))) return true;
            }
        return false;
    });
}

}  // namespace

bool comes_to_flow(const Polyline& path, const Raster& depth, double limit) {
    return any_node_along(path, depth, [&](double h) { return h > limit; });
}

bool comes_to_changes(const Polyline& path, const Raster& change, double noise) {
    return any_node_along(path, change, [&](double dz) { return std::abs(dz) > noise; });
}

bool comes_to_polygons(const Polyline& path, const Polygons& polygons, double reach) {
    return any_along(path, reach, [&](const Vec2& place) {
        return std::any_of(polygons.parts.begin(), polygons.parts.end(),
                           [&](const Polygon& polygon) { return distance_to(polygon, place) <= reach; });
    });
}

double distance_to_start(const Vec2& place, const Raster& arrival_time, const std::vector<Vec2>& starts) {
    const GridGeometry& g = arrival_time.geometry;
    std::vector<double> times = {0.0};
    double nearest = Raster::nodata;
    const auto add = [&](const Vec2& start) { nearest = std::fmin(nearest, (place - start).norm()); };
    for (const Vec2& start : starts) {
        add(start);
        if (const NodeAt node = nearest_node(g, start); has_node(g, node))
            times.push_back(arrival_time.at(node.i, node.j));
    }
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (std::count(times.begin(), times.end(), arrival_time.at(i, j)) > 0) add({g.x(i), g.y(j)});
    return nearest;
}

std::string words_on_stray(const std::string& source) {
    return fmt::format(
        "{}: found a line that touches neither what was simulated nor what was surveyed; expected the path of the "
        "flow, from the release to the toe; draw it along the flow, or check its coordinates and its CRS",
        source);
}

}  // namespace frana
