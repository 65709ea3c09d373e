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
