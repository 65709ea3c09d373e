#pragma once
// What four points feel of the nodes around them: means by quadratic shapes, the ground, the speed along it.
#include "law/bed/node_friction.h"
#include "mpm/stencils.h"
#include "shallow/flow.h"

namespace frana {

constexpr double kSlowest = 1e-30;  ///< below any speed [m/s]

/// Means of node values at four points.
class MeansOfFour {
public:
    [[gnu::always_inline]] MeansOfFour(const TileGrid& grid, Double4 x, Double4 y) : stride_(grid.stride()) {
        const Stencils sx(x), sy(y);
        for (int lane = 0; lane < 4; ++lane) node_[lane] = sy.first[lane] * stride_ + sx.first[lane];
        transpose(sx.w[0], sx.w[1], sx.w[2], Double4{}, along_);
        for (int j = 0; j < 3; ++j) across_[j] = sy.w[j];
    }
    /// Where there are fewer than four points, the other lanes have numbers of the grid's first node.
    [[gnu::always_inline]] Double4 of(const LazyArray<double>& nodes) const {
        Double4 rows[4], parts[4];
        for (int lane = 0; lane < 4; ++lane) {
            const double* row = nodes.data() + node_[lane];
            const Double4 sum = (across_[0][lane] * load(row) + across_[1][lane] * load(row + stride_)) +
                                across_[2][lane] * load(row + 2 * stride_);
            rows[lane] = along_[lane] * sum;
        }
        transpose(rows[0], rows[1], rows[2], rows[3], parts);
        return parts[0] + parts[1] + parts[2];
    }

private:
    Index stride_, node_[4];
    Double4 along_[4];
    Double4 across_[3];
};

/// The bed law's input below four points, and their speed along it; on gentle ground that of the map.
struct GroundOfFour {
    BedStateOf<Double4> below;
    Double4 speed;
    [[gnu::always_inline]] GroundOfFour(const Flow& flow, bool curved, const MeansOfFour& means, Double4 vx, Double4 vy,
                                        Double4 depth) {
        const Double4 one = all(1.0), none = {};
        Double4 bx = none, by = none, gravity = all(flow.gravity);
        if (flow.steep) bx = means.of(flow.bed.slope_x), by = means.of(flow.bed.slope_y);
        if (curved)
            gravity = max(none, gravity + vx * vx * means.of(flow.bed.hxx) + 2.0 * vx * vy * means.of(flow.bed.hxy) +
                                    vy * vy * means.of(flow.bed.hyy));
        const Double4 on_map2 = vx * vx + vy * vy, rise = vx * bx + vy * by;
        const Double4 kappa = sqrt(one + rise * rise / on_map2), cosine = one / sqrt(one + bx * bx + by * by);
        speed = kappa * sqrt(on_map2);
        below = {gravity * cosine / kappa, max(depth * cosine, all(1e-9)), kappa, cosine, flow.gravity, flow.density};
    }
};

}  // namespace frana
