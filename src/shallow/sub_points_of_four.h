#pragma once
// Four points at once: their columns on the nodes, from their sub-points (sub_points.h), and gradients as they feel them.
#include "mpm/stencils.h"
#include "shallow/sub_points.h"

namespace frana {

/// Edges of the domains of four points [cells].
struct Domains {
    Double4 r1x, r1y, r2x, r2y;
};

/// Gradients as domains feel them (mpm/domain.h): few points are so narrow that it matters.
[[gnu::always_inline]] inline void limit_gradients(const Domains& r, Double4& cxx, Double4& cxy, Double4& cyx,
                                                   Double4& cyy) {
    constexpr double least = 1.01 / 256.0;  // of 12 times the smaller moment; a little early
    const Double4 xx = r.r1x * r.r1x + r.r2x * r.r2x, yy = r.r1y * r.r1y + r.r2y * r.r2y,
                  xy = r.r1x * r.r1y + r.r2x * r.r2y;
    const Mask4 wide = (xx >= least) & ((xx - least) * (yy - least) >= xy * xy);
    if (!any(~wide)) return;
    for (int n = 0; n < 4; ++n) {
        const Gradient g = spanned({cxx[n], cxy[n], cyx[n], cyy[n]}, r.r1x[n], r.r1y[n], r.r2x[n], r.r2y[n]);
        cxx[n] = g.xx, cxy[n] = g.xy, cyx[n] = g.yx, cyy[n] = g.yy;
    }
}

/// The sub-points of four points of masses m. All of a point's lie within four nodes each way if none is farther than half
/// a cell; their weights are summed there first. Otherwise nothing is done, and returns false.
/// `into`: an array on the grid's storage.
[[gnu::always_inline]] inline bool spread_four(const Flow& flow, double* into, int lanes, Double4 x, Double4 y,
                                               Double4 m, const Domains& r) {
    const double reach = flow.scheme.sub_point_reach;
    const Double4 ax = reach * (r.r1x + r.r2x), bx = reach * (r.r1x - r.r2x);
    const Double4 ay = reach * (r.r1y + r.r2y), by = reach * (r.r1y - r.r2y);
    const Double4 far = max(max(abs(ax), abs(bx)), max(abs(ay), abs(by)));
    if (any(far > 0.5)) return false;
    const Double4 left = floor(x + (kTile - 1.0)), below = floor(y + (kTile - 1.0));
    const Double4 tx = x - (left - (kTile - 1.5)), ty = y - (below - (kTile - 1.5));
    Double4 wx[4][4], wy[4][4];
    window_weights(tx + ax, wx[0]), window_weights(ty + ay, wy[0]);
    window_weights(tx - ax, wx[1]), window_weights(ty - ay, wy[1]);
    window_weights(tx + bx, wx[2]), window_weights(ty + by, wy[2]);
    window_weights(tx - bx, wx[3]), window_weights(ty - by, wy[3]);
    Double4 of_lane[4][4];  // row, lane: the masses of four nodes
    for (int b = 0; b < 4; b += 2) {
        Double4 lower[4], upper[4];
        for (int a = 0; a < 4; ++a) {
            lower[a] = wy[0][b] * wx[0][a], upper[a] = wy[0][b + 1] * wx[0][a];
            for (int k = 1; k < 4; ++k) lower[a] += wy[k][b] * wx[k][a], upper[a] += wy[k][b + 1] * wx[k][a];
        }
        transpose(lower[0], lower[1], lower[2], lower[3], of_lane[b]);
        transpose(upper[0], upper[1], upper[2], upper[3], of_lane[b + 1]);
    }
    const Index stride = flow.grid.stride();
    const Int4 i = floor_positive(left), j = floor_positive(below);
    const Double4 share = 1.0 / 256.0 * m;  // a quarter each, weights come eightfold
    for (int lane = 0; lane < lanes; ++lane) {
        double* row = into + j[lane] * stride + i[lane];
        for (int b = 0; b < 4; ++b, row += stride) store(row, load(row) + share[lane] * of_lane[b][lane]);
    }
    return true;
}

}  // namespace frana
