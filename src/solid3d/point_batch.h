#pragma once
// Four material points at once: their weights, what they give to the nodes of a block, what they take.
#include "law/sym3.h"
#include "solid3d/node_block.h"
#include "solid3d/spline.h"

namespace frana {

/// First nodes of four points, and where each lies behind its own [cells].
struct BatchPlace {
    Int4 first[3];
    Double4 f[3];

    /// x >= 1/2 [cells]
    [[gnu::always_inline]] explicit BatchPlace(const Double4* x) {
        for (int axis = 0; axis < 3; ++axis) {
            first[axis] = floor_positive(x[axis] - 0.5);
            f[axis] = x[axis] - to_double(first[axis]);
        }
    }
    /// Storage index of the first node in a block.
    [[gnu::always_inline]] Int4 in_block(const Box3d& box) const {
        const Int4 i = first[0] - static_cast<std::int32_t>(box.first[0]),
                   j = first[1] - static_cast<std::int32_t>(box.first[1]),
                   k = first[2] - static_cast<std::int32_t>(box.first[2]);
        return i + j * static_cast<std::int32_t>(NodeBlock::kRow) + k * static_cast<std::int32_t>(NodeBlock::kPlane);
    }
};

/// What four points give: mass, momentum m (v + L d), and the impulse of stress, dt V sigma grad w.
struct BatchContribution {
    Double4 mass, momentum[3];
    Double4 weight[3];     ///< impulse of gravity, where it is not in the momentum (BatchShares)
    Double4 affine[3][3];  ///< m dv_k/dx_l at [l][k]
    Double4 force[3][3];   ///< - dt V sigma_kl at [l][k]
    Double4 mass_j;
};

/// What each of four points gives along each axis. The share of node (i, j, k) is w_j w_k X_i + w_i (w_k Y_j + w_j
/// Z_k). X holds mass and momentum too. Laid out point by point. `flip`: so too what they had before the step's
/// impulses, with m J in the place of the mass.
template <Affine affine, bool flip>
struct BatchShares {
    Double4 share[3][3][4];           ///< axis, node, point: mass and momentum
    Double4 had[flip ? 3 : 1][3][4];  ///< what points had before
    Double4 w[3][3];
    Double4 mass_j;

    [[gnu::always_inline]] BatchShares(const BatchPlace& at, const BatchContribution& contribution, double h)
        : mass_j(contribution.mass_j) {
        for (int axis = 0; axis < 3; ++axis) {
            const Spline<affine, Double4> s(at.f[axis], h);
            for (int n = 0; n < 3; ++n) {
                w[axis][n] = s.w[n];
                const Double4 wd = s.w[n] * s.d[n];
                Double4 part[3], mass = {};
                if constexpr (flip) bring(contribution, axis, n, s.w[n], wd);
                for (int k = 0; k < 3; ++k)
                    part[k] = wd * contribution.affine[axis][k] + s.slope[n] * contribution.force[axis][k];
                if (axis == 0) {
                    mass = s.w[n] * contribution.mass;
                    for (int k = 0; k < 3; ++k)
                        part[k] += s.w[n] * (flip ? contribution.momentum[k] + contribution.weight[k]
                                                  : contribution.momentum[k]);
                }
                transpose(mass, part[0], part[1], part[2], share[axis][n]);
            }
        }
    }

private:
    [[gnu::always_inline]] void bring(const BatchContribution& contribution, int axis, int n, Double4 weight,
                                      Double4 wd) {
        Double4 part[3], mean = {};
        for (int k = 0; k < 3; ++k) part[k] = wd * contribution.affine[axis][k];
        if (axis == 0) {
            mean = weight * contribution.mass_j;
            for (int k = 0; k < 3; ++k) part[k] += weight * contribution.momentum[k];
        }
        transpose(mean, part[0], part[1], part[2], had[axis][n]);
    }
};

/// Adds what one point gives to its 27 nodes, the first of them at `at` of the block.
template <bool averages, Affine affine, bool flip>
[[gnu::always_inline]] inline void contribute(NodeBlock& block, Index at, const BatchShares<affine, flip>& from,
                                              int point) {
    const Double4 w[3] = {all(from.w[0][0][point]), all(from.w[0][1][point]), all(from.w[0][2][point])};
    const Double4 x[3] = {from.share[0][0][point], from.share[0][1][point], from.share[0][2][point]};
    const Double4 weights{from.w[0][0][point], from.w[0][1][point], from.w[0][2][point], 0.0};
    Double4* const first = block.node + at;
    double* const first_j = block.mass_j + at;
    const Double4 row_j = averages && !flip ? from.mass_j[point] * weights : Double4{};
    for (int k = 0; k < 3; ++k) {
        const Double4 wk = all(from.w[2][k][point]);
        for (int j = 0; j < 3; ++j) {
            const Double4 wj = all(from.w[1][j][point]), wjk = wj * wk;
            const Double4 across = wk * from.share[1][j][point] + wj * from.share[2][k][point];
            const Index row = k * NodeBlock::kPlane + j * NodeBlock::kRow;
            Double4* const node = first + row;
            for (int i = 0; i < 3; ++i) node[i] = (node[i] + wjk * x[i]) + w[i] * across;
            if constexpr (flip) {
                const Double4 had = wk * from.had[1][j][point] + wj * from.had[2][k][point];
                Double4* const flip_sums = block.flip_sums + at + row;
                for (int i = 0; i < 3; ++i) flip_sums[i] = (flip_sums[i] + wjk * from.had[0][i][point]) + w[i] * had;
            } else if constexpr (averages)
                store(first_j + row, load(first_j + row) + wjk * row_j);
        }
    }
}

/// What four points take: mean J and velocity, and their slopes along each axis [1/m], as four lanes each.
struct BatchTaken {
    Double4 mean[4], slope[3][4];
    Double4 flip_sums[4];  ///< of NodeBlock::flip_sums
};

/// The same of one point: laid out node's number by node's number.
struct PointTaken {
    Double4 mean, slope[3], flip_sums;
};

template <Affine affine>
struct BatchWeights {
    Spline<affine, Double4> along[3];
    [[gnu::always_inline]] BatchWeights(const BatchPlace& at, double h)
        : along{{at.f[0], h}, {at.f[1], h}, {at.f[2], h}} {}

    template <bool flip>
    [[gnu::always_inline]] PointTaken take(const NodeBlock& block, Index at, int point) const {
        const auto w = [&](int axis, int n) { return all(along[axis].w[n][point]); };
        const auto slope = [&](int axis, int n) { return all(along[axis].slope[n][point]); };
        const Double4 wi[3] = {w(0, 0), w(0, 1), w(0, 2)};
        const Double4 si[3] = {slope(0, 0), slope(0, 1), slope(0, 2)};
        const Double4* const first = block.node + at;
        PointTaken taken{};
        for (int k = 0; k < 3; ++k) {
            Double4 plane{}, slope_x{}, slope_y{}, flip_sums{};
            for (int j = 0; j < 3; ++j) {
                const Double4* const node = first + k * NodeBlock::kPlane + j * NodeBlock::kRow;
                const Double4 row = wi[0] * node[0] + wi[1] * node[1] + wi[2] * node[2];
                const Double4 tilt = si[0] * node[0] + si[1] * node[1] + si[2] * node[2];
                const Double4 wj = w(1, j);
                plane += wj * row;
                slope_x += wj * tilt;
                slope_y += slope(1, j) * row;
                if constexpr (flip) {
                    const Double4* const k_row = block.flip_sums + at + k * NodeBlock::kPlane + j * NodeBlock::kRow;
                    flip_sums += wj * (wi[0] * k_row[0] + wi[1] * k_row[1] + wi[2] * k_row[2]);
                }
            }
            const Double4 wk = w(2, k);
            taken.mean += wk * plane;
            taken.slope[0] += wk * slope_x;
            taken.slope[1] += wk * slope_y;
            taken.slope[2] += slope(2, k) * plane;
            if constexpr (flip) taken.flip_sums += wk * flip_sums;
        }
        return taken;
    }
};

}  // namespace frana
