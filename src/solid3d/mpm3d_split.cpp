// 3D points that stand for too much room become two.
#include <algorithm>

#include "solid3d/mpm3d.h"
#include "solid3d/split_points.h"

namespace frana {

/// Halves retain state and gradient, and have the velocities of the point's field at their places. Mass, momentum and
/// centre stay. The energy of motion that they gain is recorded as what the scheme gave.
void Mpm3d::split() {
    MaterialPoints& q = body_.points;
    const GridGeometry3d& g = body_.grid.geometry();
    const auto free = [&](const Vec3& x) {
        for (int k = 0; k < 3; ++k)
            if (!(x[k] >= 0.5 && x[k] <= static_cast<double>(g.nodes[static_cast<std::size_t>(k)]) - 1.5)) return false;
        for (const Surface& surface : body_.surfaces)
            if (surface.inside(g.origin + g.cell * x)) return false;
        return true;
    };
    for (const SplitPoint& s : points_to_split(q, body_.grid, body_.gone)) {
        const Vec3 x(q.x[0][s.point], q.x[1][s.point], q.x[2][s.point]);
        if (!free(x - s.way) || !free(x + s.way)) continue;
        const Index p = s.point, other = q.count();
        q.resize(other + 1);
        body_.gone.push_back(0);
        q.each([&](Array& array) { array[other] = array[p]; });
        q.id[other] = next_id_++;
        if (notes_) births_.push_back({q.id[other], q.id[p]});
        q.mass[p] = q.mass[other] = 0.5 * q.mass[p];
        q.rest_volume[p] = q.rest_volume[other] = 0.5 * q.rest_volume[p];
        const Vec3 faster = gradient(p) * (g.cell * s.way);
        for (int k = 0; k < 3; ++k) {
            q.x[k][p] -= s.way[k], q.x[k][other] += s.way[k];
            q.v[k][p] -= faster[k], q.v[k][other] += faster[k];
        }
        status_.kinetic += q.mass[p] * faster.squaredNorm();
        for (const Index half : {p, other}) status_.max_speed = std::max(status_.max_speed, velocity(half).norm());
        status_.points += 1;
    }
}

}  // namespace frana
