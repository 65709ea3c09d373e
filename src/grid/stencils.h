#pragma once
// The quadratic shape function of four points at once (grid/stencil.h has one point's).
#include "base/simd.h"
#include "grid/tile_grid.h"

namespace frana {

/// Quadratic B-splines (grid/stencil.h) of four points in one direction.
struct Stencils {
    Int4 first;      ///< node of the first weight, counted from the storage's first
    Double4 offset;  ///< position minus first node, 1/2 to 3/2
    Double4 w[3];
    [[gnu::always_inline]] explicit Stencils(Double4 u) : first(floor_positive(u + (kTile - 0.5))) {
        const Double4 f = u - (to_double(first) - kTile);
        offset = f;
        w[0] = 0.5 * (1.5 - f) * (1.5 - f);
        w[1] = 0.75 - (f - 1.0) * (f - 1.0);
        w[2] = 0.5 * (f - 0.5) * (f - 0.5);
    }
};

/// One lane of two Stencils: weights and slopes of the 3 x 3 nodes from storage index `node` on.
struct Reach {
    Index node;
    double wx[3], wy[3], sx[3], sy[3];
    [[gnu::always_inline]] Reach(const Stencils& x, const Stencils& y, Index stride, int lane)
        : node(y.first[lane] * stride + x.first[lane]) {
        const double f = x.offset[lane], g = y.offset[lane];
        for (int n = 0; n < 3; ++n) wx[n] = x.w[n][lane], wy[n] = y.w[n][lane];
        sx[0] = f - 1.5, sx[1] = 2.0 - 2.0 * f, sx[2] = f - 0.5;
        sy[0] = g - 1.5, sy[1] = 2.0 - 2.0 * g, sy[2] = g - 0.5;
    }
};

/// Weights, times `scale`, of a sub-point at t in [1/2, 5/2) from the first of four nodes.
[[gnu::always_inline]] inline void window_weights(Double4 t, Double4 scale, Double4 w[4]) {
    const Mask4 second = t >= 1.5;
    const Double4 f = second ? t - 1.0 : t, half = 0.5 * scale;
    const Double4 w0 = half * (1.5 - f) * (1.5 - f), w1 = scale * (0.75 - (f - 1.0) * (f - 1.0)),
                  w2 = half * (f - 0.5) * (f - 0.5);
    const Double4 zero = {};
    w[0] = second ? zero : w0;
    w[1] = second ? w0 : w1;
    w[2] = second ? w1 : w2;
    w[3] = second ? w2 : zero;
}

}  // namespace frana
