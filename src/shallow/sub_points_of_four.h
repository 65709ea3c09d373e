#pragma once
// Four points at once: their mass on the nodes, from their sub-points (sub_points.h), and gradients as they feel them.
#include "mpm/domain.h"
#include "mpm/stencils.h"
#include "shallow/sub_points.h"

namespace frana {

/// Where the sub-points of four points spread: weights of the four by four nodes that hold all of a point's.
struct WindowOfFour {
    Int4 i, j;              ///< first nodes, counted from the storage's first
    Double4 of_lane[4][4];  ///< of a row, of a point: the weights of four nodes, 256 in all
};

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
    if (any(~wide)) leave_spanned(r.r1x, r.r1y, r.r2x, r.r2y, cxx, cxy, cyx, cyy);
}

/// Fills `window`, for points none of whose sub-points is farther than half a cell away. Otherwise does nothing, and returns
/// false.
[[gnu::always_inline]] inline bool find_window(const Flow& flow, Double4 x, Double4 y, const Domains& r,
                                               WindowOfFour& window) {
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
    for (int b = 0; b < 4; b += 2) {
        Double4 lower[4], upper[4];
        for (int a = 0; a < 4; ++a) {
            lower[a] = wy[0][b] * wx[0][a], upper[a] = wy[0][b + 1] * wx[0][a];
            for (int k = 1; k < 4; ++k) lower[a] += wy[k][b] * wx[k][a], upper[a] += wy[k][b + 1] * wx[k][a];
        }
        transpose(lower[0], lower[1], lower[2], lower[3], window.of_lane[b]);
        transpose(upper[0], upper[1], upper[2], upper[3], window.of_lane[b + 1]);
    }
    window.i = floor_positive(left), window.j = floor_positive(below);
    return true;
}

constexpr double kOfWindow = 1.0 / 256.0;  ///< a sub-point has a quarter, and weights come eightfold in each direction

/// Spreads masses m of four points. `into`: an array on the grid's storage.
[[gnu::always_inline]] inline void spread_window(Index stride, double* into, int lanes, Double4 m,
                                                 const WindowOfFour& window) {
    const Double4 share = kOfWindow * m;
    for (int lane = 0; lane < lanes; ++lane) {
        double* row = into + window.j[lane] * stride + window.i[lane];
        for (int b = 0; b < 4; ++b, row += stride) store(row, load(row) + share[lane] * window.of_lane[b][lane]);
    }
}

/// The same by their sub-points, unless some is too far away: then returns false.
[[gnu::always_inline]] inline bool spread_four(const Flow& flow, double* into, int lanes, Double4 x, Double4 y,
                                               Double4 m, const Domains& r) {
    WindowOfFour window;
    if (!find_window(flow, x, y, r, window)) return false;
    spread_window(flow.grid.stride(), into, lanes, m, window);
    return true;
}

}  // namespace frana
