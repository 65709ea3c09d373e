#pragma once
// Where points and mirror particles are in the grid, one by one: they lie anywhere.
#include <algorithm>
#include <array>
#include <cmath>

#include "solid3d/mpm3d.h"

namespace frana {

/// Of a point [cells].
inline Vec3 position(const SolidBody& body, Index p) {
    return {body.points.x[0][p], body.points.x[1][p], body.points.x[2][p]};
}

/// The 27 nodes of a point or mirror particle in the grid.
template <Affine affine>
struct Stencil3d {
    Index place[3][3];  ///< shares of the nodes' storage indices
    double w[3][3], slope[3][3], d[3][3];

    [[gnu::always_inline]] Stencil3d(const Grid3d& grid, const Vec3& x) {
        for (int axis = 0; axis < 3; ++axis) {
            const double first = std::floor(x[axis] - 0.5);
            const Spline<affine, double> s(x[axis] - first, grid.cell());
            std::copy_n(grid.place(axis, static_cast<Index>(first)), 3, place[axis]);
            std::copy_n(s.w, 3, w[axis]), std::copy_n(s.slope, 3, slope[axis]), std::copy_n(s.d, 3, d[axis]);
        }
    }
};

/// Whether any tile that a mirror particle's stencil touches is on the work list.
inline bool seen(const SolidBody& body, const Vec3& place) {
    std::array<Index, 3> first;
    for (int axis = 0; axis < 3; ++axis) first[axis] = static_cast<Index>(std::floor(place[axis] - 0.5));
    if (!body.grid.holds(first)) return false;
    bool listed = false;
    for (int corner = 0; corner < 8; ++corner)
        listed |= body.active.in_work[body.grid.tile_of(first[0] + Index{2} * (corner & 1), first[1] + (corner & 2),
                                                        first[2] + (corner & 4) / 2)] != 0;
    return listed;
}

}  // namespace frana
