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
        Double4 along[4];
        transpose(sx.w[0], sx.w[1], sx.w[2], Double4{}, along);
        for (int lane = 0; lane < 4; ++lane) {
            node_[lane] = sy.first[lane] * stride_ + sx.first[lane];
            for (int j = 0; j < 3; ++j) weights_[lane][j] = sy.w[j][lane] * along[lane];
        }
    }
    /// Of some arrays at once. Where there are fewer than four points, the other lanes have numbers of the grid's first
    /// node.
    template <class... Nodes>
    [[gnu::always_inline]] std::array<Double4, sizeof...(Nodes)> of(const Nodes&... nodes) const {
        constexpr std::size_t kCount = sizeof...(Nodes);
        const double* const first[kCount] = {nodes.data()...};
        Double4 rows[kCount][4];
        for (int lane = 0; lane < 4; ++lane) {
            const Double4 a = weights_[lane][0], b = weights_[lane][1], c = weights_[lane][2];
            for (std::size_t n = 0; n < kCount; ++n) {
                const double* row = first[n] + node_[lane];
                rows[n][lane] = (a * load(row) + b * load(row + stride_)) + c * load(row + 2 * stride_);
            }
        }
        std::array<Double4, kCount> means;
        for (std::size_t n = 0; n < kCount; ++n) means[n] = sums_of_each(rows[n]);
        return means;
    }

private:
    Index stride_, node_[4];
    Double4 weights_[4][3];  ///< of a point, of a row: three nodes, and zero
};

/// The bed law's input below four points that have a speed, and their speeds along it and on the map; on gentle ground they
/// are the same.
struct GroundOfFour {
    BedStateOf<Double4> below;
    Double4 speed, on_map;
    [[gnu::always_inline]] GroundOfFour(const Flow& flow, bool curved, const MeansOfFour& means, Double4 vx, Double4 vy,
                                        Double4 depth) {
        const Double4 one = all(1.0), none = {};
        Double4 bx = none, by = none, gravity = all(flow.gravity);
        const BedGeometry& bed = flow.bed;
        if (curved) {
            const auto [sx, sy, hxx, hxy, hyy] = means.of(bed.slope_x, bed.slope_y, bed.hxx, bed.hxy, bed.hyy);
            bx = sx, by = sy;
            gravity = max(none, gravity + vx * vx * hxx + 2.0 * vx * vy * hxy + vy * vy * hyy);
        } else if (flow.steep) {
            const auto [sx, sy] = means.of(bed.slope_x, bed.slope_y);
            bx = sx, by = sy;
        }
        const Double4 on_map2 = vx * vx + vy * vy, rise = vx * bx + vy * by;
        const Double4 cosine = one / sqrt(one + bx * bx + by * by);
        on_map = sqrt(on_map2);
        speed = sqrt(on_map2 + rise * rise);
        below = {gravity * cosine * (on_map / speed),
                 max(depth * cosine, all(1e-9)),
                 speed / on_map,
                 cosine,
                 flow.gravity,
                 flow.density};
    }
};

}  // namespace frana
