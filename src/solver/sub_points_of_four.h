#pragma once
// Four points at once: their columns on the nodes, from their sub-points (sub_points.h), and gradients as they feel them.
#include "grid/stencils.h"
#include "solver/sub_points.h"

namespace frana {

/// Edges of the domains of four points [cells].
struct Domains { Double4 r1x, r1y, r2x, r2y; };

/// Gradients as domains feel them (domain.h): few points are so narrow that it matters.
[[gnu::always_inline]] inline void limit_gradients(const Domains& r, Double4& cxx, Double4& cxy, Double4& cyx, Double4& cyy) {
    constexpr double least = 1.01 / 256.0;  // of 12 times the smaller moment; a little early
    const Double4 xx = r.r1x * r.r1x + r.r2x * r.r2x, yy = r.r1y * r.r1y + r.r2y * r.r2y, xy = r.r1x * r.r1y + r.r2x * r.r2y;
    const Mask4 wide = (xx >= least) & ((xx - least) * (yy - least) >= xy * xy);
    if (!any(~wide)) return;
    for (int n = 0; n < 4; ++n) {
        const Gradient g = spanned({cxx[n], cxy[n], cyx[n], cyy[n]}, r.r1x[n], r.r1y[n], r.r2x[n], r.r2y[n]);
        cxx[n] = g.xx, cxy[n] = g.xy, cyx[n] = g.yx, cyy[n] = g.yy;
    }
}

/// The sub-points of four points, `quarter` of their masses each. All of a point's lie within four nodes each way if none is
/// farther than half a cell; their weights are summed there first. Otherwise nothing is done, and returns false.
[[gnu::always_inline]] inline bool spread_four(Flow& flow, int lanes, Double4 x, Double4 y, Double4 quarter,
                                               const Domains& r) {
    const double reach = flow.scheme.sub_point_reach;
    const Double4 ax = reach * (r.r1x + r.r2x), bx = reach * (r.r1x - r.r2x);
    const Double4 ay = reach * (r.r1y + r.r2y), by = reach * (r.r1y - r.r2y);
    const Double4 far = max(max(abs(ax), abs(bx)), max(abs(ay), abs(by)));
    if (any(far > 0.5)) return false;
    const Int4 i = floor_positive(x + (kTile - 1.0)), j = floor_positive(y + (kTile - 1.0));
    const Double4 tx = x - (to_double(i) - kTile), ty = y - (to_double(j) - kTile), one = all(1.0);
    Double4 wx[4][4], wy[4][4];
    window_weights(tx + ax, one, wx[0]), window_weights(ty + ay, quarter, wy[0]);
    window_weights(tx - ax, one, wx[1]), window_weights(ty - ay, quarter, wy[1]);
    window_weights(tx + bx, one, wx[2]), window_weights(ty + by, quarter, wy[2]);
    window_weights(tx - bx, one, wx[3]), window_weights(ty - by, quarter, wy[3]);
    Double4 of_lane[4][4];  // row, lane: the masses of four nodes
    for (int b = 0; b < 4; ++b) {
        Double4 of_node[4];
        for (int a = 0; a < 4; ++a)
            of_node[a] = (wy[0][b] * wx[0][a] + wy[1][b] * wx[1][a]) + (wy[2][b] * wx[2][a] + wy[3][b] * wx[3][a]);
        transpose(of_node[0], of_node[1], of_node[2], of_node[3], of_lane[b]);
    }
    const Index stride = flow.grid.stride();
    for (int lane = 0; lane < lanes; ++lane) {
        double* row = flow.nodes.column_mass.data() + j[lane] * stride + i[lane];
        for (int b = 0; b < 4; ++b, row += stride) store(row, load(row) + of_lane[b][lane]);
    }
    return true;
}

}  // namespace frana
