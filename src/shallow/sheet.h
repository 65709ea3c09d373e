#pragma once
// What a sheet's shear is made of at points: its speed along the bed, and its thickness across it (THEORY (24), (25)).
#include <cmath>

#include "base/simd.h"
#include "mpm/stencils.h"
#include "shallow/flow.h"

namespace frana {

template <class Real>
struct Sheet {
    Real speed, thickness;
};  ///< [m/s], [m]

/// On gentle terrain those of the map. S: the scheme's stencil.
template <class S>
Sheet<double> sheet_at(const Flow& flow, const S& sx, const S& sy, double vx, double vy, double depth) {
    const double on_map = std::hypot(vx, vy);
    if (!flow.bed.smooth_x) return {on_map, depth};
    double bx = 0.0, by = 0.0;
    for (int j = 0; j < S::kNodes; ++j)
        for (int i = 0; i < S::kNodes; ++i) {
            const Index k = flow.grid.at(sx.base + i, sy.base + j);
            bx += sx.w[i] * sy.w[j] * flow.bed.smooth_x[k], by += sx.w[i] * sy.w[j] * flow.bed.smooth_y[k];
        }
    return {std::hypot(on_map, vx * bx + vy * by), depth / std::sqrt(1.0 + bx * bx + by * by)};
}

/// The same of four points at x, y [cells], with quadratic splines.
[[gnu::always_inline]] inline Sheet<Double4> sheet_of_four(const Flow& flow, Double4 x, Double4 y, int lanes,
                                                           Double4 vx, Double4 vy, Double4 depth) {
    Double4 bx = {}, by = {};
    if (flow.bed.smooth_x) {
        const Stencils sx(x), sy(y);
        const Index stride = flow.grid.stride();
        for (int lane = 0; lane < lanes; ++lane) {
            const Reach reach(sx, sy, stride, lane);
            const auto mean = [&](const LazyArray<double>& nodes) {
                const double* row = nodes.data() + reach.node;
                double sum = 0.0;
                for (int j = 0; j < 3; ++j, row += stride)
                    sum += reach.wy[j] * (reach.wx[0] * row[0] + reach.wx[1] * row[1] + reach.wx[2] * row[2]);
                return sum;
            };
            bx[lane] = mean(flow.bed.smooth_x), by[lane] = mean(flow.bed.smooth_y);
        }
    }
    const Double4 rise = vx * bx + vy * by;
    return {sqrt(vx * vx + vy * vy + rise * rise), depth / sqrt(1.0 + bx * bx + by * by)};
}

}  // namespace frana
