#pragma once
// How fast a sheet shears at points: its speed along the bed over its thickness across it (THEORY (24), (25)).
#include "base/simd.h"
#include "mpm/stencil.h"
#include "shallow/flow.h"

namespace frana {

/// From the velocity on the map, the vertical depth and the bed's slopes: V / T [1/s], with V^2 = v^2 + (v . grad b)^2 and
/// T = h / sqrt(1 + |grad b|^2).
template <class Real>
[[gnu::always_inline]] inline Real sheet_shear(Real vx, Real vy, Real depth, Real bx, Real by) {
    const Real rise = vx * bx + vy * by;
    return sqrt((vx * vx + vy * vy + rise * rise) * (1.0 + bx * bx + by * by)) / depth;
}

/// At a point at x, y [cells]. The smoothed bed's slopes are linear between nodes; on gentle terrain there are none.
inline double shear_at(const Flow& flow, double x, double y, double vx, double vy, double depth) {
    if (!flow.bed.smooth) return sheet_shear(vx, vy, depth, 0.0, 0.0);
    const Linear sx(x), sy(y);
    double bx = 0.0, by = 0.0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const Pair& slope = flow.bed.smooth[flow.grid.at(sx.base + i, sy.base + j)];
            bx += sx.w[i] * sy.w[j] * slope.x, by += sx.w[i] * sy.w[j] * slope.y;
        }
    return sheet_shear(vx, vy, depth, bx, by);
}

/// The same at four points.
[[gnu::always_inline]] inline Double4 shear_of_four(const Flow& flow, Double4 x, Double4 y, int lanes, Double4 vx,
                                                    Double4 vy, Double4 depth) {
    if (!flow.bed.smooth) return sheet_shear(vx, vy, depth, Double4{}, Double4{});
    const Index stride = flow.grid.stride();
    const Int4 i = floor_positive(x + kTile), j = floor_positive(y + kTile);
    const Double4 along = x + kTile - to_double(i), across = y + kTile - to_double(j);
    Double4 rows[4] = {}, of[4];
    for (int lane = 0; lane < lanes; ++lane) {
        const Pair* first = flow.bed.smooth.data() + (j[lane] * stride + i[lane]);
        const Double4 lower = load(first), upper = load(first + stride);
        rows[lane] = lower + across[lane] * (upper - lower);
    }
    transpose(rows[0], rows[1], rows[2], rows[3], of);
    return sheet_shear(vx, vy, depth, of[0] + along * (of[2] - of[0]), of[1] + along * (of[3] - of[1]));
}

}  // namespace frana
