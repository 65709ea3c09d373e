#include "scene/barrier_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "terrain/bed_points.h"
#include "terrain/outline_nodes.h"

namespace frana {

BarrierBox bounds_of(const Barrier& barrier) {
    const std::vector<Vec2>& ring = barrier.outline.parts.front().rings.front();
    BarrierBox box{ring.front(), ring.front()};
    for (const Vec2& corner : ring) box.low = box.low.cwiseMin(corner), box.high = box.high.cwiseMax(corner);
    return box;
}

BarrierBox box_around(const Barrier& barrier, double cell) {
    BarrierBox box = bounds_of(barrier);
    for (int axis = 0; axis < 2; ++axis) {
        const double lacks = kBoxCells * cell - (box.high[axis] - box.low[axis]);
        if (lacks > 0.0) box.low[axis] -= 0.5 * lacks, box.high[axis] += 0.5 * lacks;
    }
    return box;
}

namespace {

/// Of the way from one place to another the share within [xmin, ymin, xmax, ymax] [1].
double share_inside(const Vec2& from, const Vec2& to, const std::array<double, 4>& window) {
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const double way = to[axis] - from[axis];
        if (way == 0.0) {
            if (from[axis] < window[k] || from[axis] > window[k + 2]) return 0.0;
            continue;
        }
        const double a = (window[k] - from[axis]) / way, b = (window[k + 2] - from[axis]) / way;
        first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
    }
    return std::max(0.0, last - first);
}

}  // namespace

double share_of_foot(const Barrier& barrier, const BarrierBox& box, const std::array<double, 4>& window) {
    const auto& [low, high] = box;
    std::vector<std::vector<Vec2>> lines;
    for (const Polygon& polygon : barrier.outline.parts)
        for (std::vector<Vec2> ring : polygon.rings) ring.push_back(ring.front()), lines.push_back(std::move(ring));
    if (!barrier.line.empty()) lines.push_back(barrier.line);
    if (lines.empty()) lines = {{low, {high.x(), low.y()}, high, {low.x(), high.y()}, low}};
    double length = 0.0, inside = 0.0;
    for (const auto& line : lines)
        for (std::size_t k = 1; k < line.size(); ++k) {
            const double way = (line[k] - line[k - 1]).norm();
            length += way, inside += way * share_inside(line[k - 1], line[k], window);
        }
    return length > 0.0 ? inside / length : 0.0;
}

double lowest_ground(const Barrier& barrier, const Raster& bed) {
    double lowest = INFINITY;
    for (const Polygon& polygon : barrier.outline.parts) lowest = std::min(lowest, lowest_ground(polygon, bed));
    for (std::size_t k = 0; k + 1 < barrier.line.size(); ++k) {
        const Vec2 along = barrier.line[k + 1] - barrier.line[k];
        const double parts = std::max(1.0, std::ceil(2.0 * along.norm() / bed.geometry.cell));
        for (double part = 0.0; part <= parts; ++part) {
            const Vec2 at = barrier.line[k] + part / parts * along;
            if (const double z = bed_elevation(bed, at.x(), at.y()); z < lowest) lowest = z;
        }
    }
    return lowest;
}

bool is_buried(const Barrier& barrier, const Raster& bed) {
    if (!barrier.top) return false;
    const double lowest = lowest_ground(barrier, bed);
    return *barrier.top <= lowest && !std::isinf(lowest);
}

void remark_on_releases_in_boxes(Scene& scene) {
    if (!scene.structure) return;
    const Seeds& seeds = scene.particles;
    for (const Barrier& barrier : scene.barriers) {
        if (is_buried(barrier, scene.bed)) continue;
        const BarrierBox box = box_around(barrier, scene.bed.geometry.cell);
        double volume = 0.0;
        for (std::size_t p = 0; p < seeds.x.size(); ++p)
            if (box.holds({seeds.x[p], seeds.y[p]})) volume += seeds.volume[p];
        if (volume > 0.0)
            scene.log.push_back(fmt::format(
                "barrier \"{}\": found {:.4g} m3 of releases within it; expected none, since structured particles fill "
                "no barrier and depths there are too large; move the outlines apart",
                barrier.name, volume));
    }
}

}  // namespace frana
