#pragma once
// The quadratic shape function of four points at once (mpm/stencil.h has one point's).
#include "base/simd.h"
#include "mpm/tile_grid.h"

namespace frana {

/// Quadratic B-splines (mpm/stencil.h) of four points in one direction.
struct Stencils {
    Int4 first;      ///< node of the first weight, counted from the storage's first
    Double4 offset;  ///< position minus first node, 1/2 to 3/2
    Double4 w[3];    ///< weights
    Double4 s[3];    ///< and their slopes per cell
    [[gnu::always_inline]] explicit Stencils(Double4 u) {
        const Double4 node = floor(u + (kTile - 0.5)), f = u - (node - kTile);
        first = floor_positive(node);
        offset = f;
        const Double4 a = 1.5 - f, b = f - 0.5;
        w[0] = 0.5 * a * a;
        w[1] = 0.75 - (f - 1.0) * (f - 1.0);
        w[2] = 0.5 * b * b;
        s[0] = f - 1.5, s[1] = 2.0 - 2.0 * f, s[2] = b;
    }
};

/// One lane of two Stencils: weights and slopes of the 3 x 3 nodes from storage index `node` on.
struct Reach {
    Index node;
    double wx[3], wy[3], sx[3], sy[3];
    [[gnu::always_inline]] Reach(const Stencils& x, const Stencils& y, Index stride, int lane)
        : node(y.first[lane] * stride + x.first[lane]) {
        for (int n = 0; n < 3; ++n) wx[n] = x.w[n][lane], wy[n] = y.w[n][lane];
        for (int n = 0; n < 3; ++n) sx[n] = x.s[n][lane], sy[n] = y.s[n][lane];
    }
};

/// Weights, times 8, of a sub-point that lies d, -1 to 1, behind the middle of four nodes. No choice of three among
/// them. `before` and `behind` are zero where d has the other sign. They take from a parabola what it has too much there.
[[gnu::always_inline]] inline void window_weights(Double4 d, Double4 w[4]) {
    const Double4 before = d - abs(d), behind = d + abs(d), from_first = 2.0 - 2.0 * d, from_last = 2.0 + 2.0 * d;
    w[0] = before * before;
    w[1] = from_first * from_first - 3.0 * w[0];
    w[3] = behind * behind;
    w[2] = from_last * from_last - 3.0 * w[3];
}

}  // namespace frana
