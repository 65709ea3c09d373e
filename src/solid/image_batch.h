#pragma once
// Up to four mirror images of points, which give to their nodes side by side. Images lie anywhere: unlike points they
// reach their nodes in the grid itself.
#include "solid/material_points.h"
#include "solid/point_batch.h"
#include "solid/space_grid.h"
#include "solid/surfaces.h"

namespace frana {

/// a b of four points.
[[gnu::always_inline]] inline Mat3x4 product(const Mat3x4& a, const Mat3x4& b) {
    Mat3x4 c;
    for (int l = 0; l < 3; ++l)
        for (int k = 0; k < 3; ++k) c(k, l) = a(k, 0) * b(0, l) + a(k, 1) * b(1, l) + a(k, 2) * b(2, l);
    return c;
}

struct ImageBatch {
    Index point[4];
    Double4 place[3];            ///< of the images [cells]
    Mat3x4 turned_back, motion;  ///< the transpose of Image::turn, and Image::motion
    int count = 0;

    void add(Index p, const Vec3& at, const Image& image) {
        point[count] = p;
        for (int k = 0; k < 3; ++k) {
            place[k][count] = at[k];
            for (int l = 0; l < 3; ++l) {
                turned_back(l, k)[count] = image.turn(k, l);
                motion(k, l)[count] = image.motion(k, l);
            }
        }
        ++count;
    }
    /// Lanes without an image become copies of the first: any finite numbers.
    void fill() {
        for (int lane = count; lane < 4; ++lane) {
            point[lane] = point[0];
            for (Double4& p : place) p[lane] = p[0];
            for (Double4& e : turned_back.entry) e[lane] = e[0];
            for (Double4& e : motion.entry) e[lane] = e[0];
        }
    }
    Double4 of(const Column& column) const {
        return Double4{column[point[0]], column[point[1]], column[point[2]], column[point[3]]};
    }
};

/// What the images give: the motion and the stress of their points, mirrored; a point and its image push each other
/// alike.
template <class Law>
[[gnu::always_inline]] inline BatchGift mirrored_gift(const Law& law, const MaterialPoints& q, const ImageBatch& batch,
                                                const Vec3& gravity, double dt) {
    Double4 state[7], v[3];
    Mat3x4 gradient;
    for (int n = 0; n < Law::kStates; ++n) state[n] = batch.of(q.state[n]);
    for (int n = 0; n < 9; ++n) gradient.entry[n] = batch.of(q.gradient[n]);
    for (int k = 0; k < 3; ++k) v[k] = batch.of(q.v[k]) + dt * gravity[k];
    const Double4 push = -dt * batch.of(q.rest_volume);
    const Mat3x4 stress = (law.stress(batch.of(q.j), state, gradient) * push).matrix();
    const Mat3x4 affine = product(product(batch.motion, gradient), batch.turned_back),
                 force = product(product(batch.motion, stress), batch.turned_back);
    BatchGift gift;
    gift.mass = batch.of(q.mass), gift.mass_j = Double4{};
    for (int k = 0; k < 3; ++k) {
        gift.momentum[k] =
            gift.mass * (batch.motion(k, 0) * v[0] + batch.motion(k, 1) * v[1] + batch.motion(k, 2) * v[2]);
        for (int l = 0; l < 3; ++l) gift.affine[l][k] = gift.mass * affine(k, l), gift.force[l][k] = force(k, l);
    }
    return gift;
}

/// Adds what one image gives to its 27 nodes; first: of these, along each axis.
template <Affine affine>
[[gnu::always_inline]] inline void give(const SpaceGrid& grid, double* nodes, const std::array<Index, 3>& first,
                                        const BatchShares<affine, false>& from, int lane) {
    const Index* const across = grid.place(0, first[0]);
    const Index at[3] = {4 * across[0], 4 * across[1], 4 * across[2]};
    const Double4 w[3] = {all(from.w[0][0][lane]), all(from.w[0][1][lane]), all(from.w[0][2][lane])};
    const Double4 x[3] = {from.share[0][0][lane], from.share[0][1][lane], from.share[0][2][lane]};
    for (int k = 0; k < 3; ++k) {
        const Double4 wk = all(from.w[2][k][lane]);
        for (int j = 0; j < 3; ++j) {
            const Double4 wj = all(from.w[1][j][lane]), wjk = wj * wk;
            const Double4 sideways = wk * from.share[1][j][lane] + wj * from.share[2][k][lane];
            double* const row = nodes + 4 * (grid.place(1, first[1])[j] + grid.place(2, first[2])[k]);
            for (int i = 0; i < 3; ++i) store(row + at[i], (load(row + at[i]) + wjk * x[i]) + w[i] * sideways);
        }
    }
}

}  // namespace frana
