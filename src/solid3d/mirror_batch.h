#pragma once
// Up to four mirror particles of points, which give to their nodes side by side. Mirror particles lie anywhere: unlike
// points they reach their nodes in the grid itself.
#include "solid3d/grid3d.h"
#include "solid3d/material_points.h"
#include "solid3d/point_batch.h"
#include "solid3d/surfaces.h"

namespace frana {

/// a b of four points.
[[gnu::always_inline]] inline Mat3x4 product(const Mat3x4& a, const Mat3x4& b) {
    Mat3x4 c;
    for (int l = 0; l < 3; ++l)
        for (int k = 0; k < 3; ++k) c(k, l) = a(k, 0) * b(0, l) + a(k, 1) * b(1, l) + a(k, 2) * b(2, l);
    return c;
}

struct MirrorBatch {
    Index point[4];
    Double4 place[3];            ///< of the mirror particles [cells]
    Mat3x4 turned_back, motion;  ///< the transpose of MirrorParticle::turn, and MirrorParticle::motion
    Double4 normal[3], above;    ///< MirrorParticle::held_normal and MirrorParticle::held_above [m]
    Double4 shift, steeper;      ///< of held mirror particles: 2 d^2 / m^2 and 4 d / m^2 [1/m] (see bend)
    Double4 slide[3][3];         ///< MirrorParticle::slide; zero beyond
    int slides = 0;              ///< most of one mirror particle
    int count = 0;

    void add(Index p, const Vec3& at, const MirrorParticle& mirror, double cell) {
        constexpr double kLeast = 0.75;  // of m [cells]: nearer to the surface a profile's bend is mostly noise
        const double d = mirror.held_above, m = std::max(d, kLeast * cell);
        point[count] = p, above[count] = d, shift[count] = 2.0 * d * d / (m * m), steeper[count] = 4.0 * d / (m * m);
        for (int k = 0; k < 3; ++k) {
            place[k][count] = at[k], normal[k][count] = mirror.held_normal[k];
            for (int s = 0; s < 3; ++s) slide[s][k][count] = s < mirror.slides ? mirror.slide[s][k] : 0.0;
            for (int l = 0; l < 3; ++l) {
                turned_back(l, k)[count] = mirror.turn(k, l);
                motion(k, l)[count] = mirror.motion(k, l);
            }
        }
        slides = std::max(slides, mirror.slides);
        ++count;
    }
    /// Lanes without a mirror particle become copies of the first: any finite numbers.
    void fill() {
        for (int lane = count; lane < 4; ++lane) {
            point[lane] = point[0];
            for (Double4& p : place) p[lane] = p[0];
            for (Double4& e : turned_back.entry) e[lane] = e[0];
            for (Double4& e : motion.entry) e[lane] = e[0];
            for (Double4& n : normal) n[lane] = n[0];
            for (auto& s : slide)
                for (Double4& n : s) n[lane] = n[0];
            above[lane] = above[0], shift[lane] = shift[0], steeper[lane] = steeper[0];
        }
    }
    Double4 of(const Array& array) const {
        return Double4{array[point[0]], array[point[1]], array[point[2]], array[point[3]]};
    }
};

struct Vec3x4 {
    Double4 entry[3];
    Double4& operator[](int k) { return entry[k]; }
    const Double4& operator[](int k) const { return entry[k]; }
};

[[gnu::always_inline]] inline Vec3x4 times(const Mat3x4& a, const Double4* b) {
    Vec3x4 c{};
    for (int k = 0; k < 3; ++k) c[k] = a(k, 0) * b[0] + a(k, 1) * b[1] + a(k, 2) * b[2];
    return c;
}

/// Square of the part of a vector that lies along a surface with that unit normal.
[[gnu::always_inline]] inline Double4 squared_along(const Vec3x4& a, const Double4* normal) {
    const Double4 across = a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2];
    Double4 sum{};
    for (int k = 0; k < 3; ++k) {
        const Double4 along = a[k] - across * normal[k];
        sum += along * along;
    }
    return sum;
}

/// Whether the stress holds the layer next to a stuck surface. 1 where the change of speed over the distance m is at
/// most the shear velocity. 0 where its square is twice as large. A faster layer has a thinner boundary layer than
/// these nodes can show. The transfer has made its profile. Carried on behind the surface that would drive the layer,
/// not hold it. THEORY.md, section 4.
[[gnu::always_inline]] inline Double4 settled(const MirrorBatch& batch, const Vec3x4& slope, const Vec3x4& traction,
                                              const Double4& per_mass) {
    const Double4 none{}, one = none + 1.0;
    const auto held = (batch.above > 0.0) | (batch.above < 0.0);  // below the ground both are negative
    const Double4 m2 = 4.0 * batch.above / select(held, batch.steeper, one);
    const Double4 speed2 = squared_along(slope, batch.normal) * m2;
    const Double4 friction2 = sqrt(squared_along(traction, batch.normal)) * per_mass;
    return min(max(2.0 * friction2 - speed2, none), friction2) / select(friction2 > 0.0, friction2, one);
}

/// In a stuck surface mirror particles turn velocities round. This changes v and its gradient so that what flows along
/// the surface goes on through it with its bend. Otherwise each step would take that bend from the layer at the
/// surface. v and v' are those at the distance d; on the surface there is rest. Then the speed is a z + b z^2, b = (v'
/// d - v) / d^2. At -d it is 2 b d^2 - v, its gradient v' - 4 b d. What bends by more than a third of v over d is no
/// settled layer (kGentle: the square of b d^2 / v). It strikes the surface or is noise, and is turned round only. At
/// 0.47 and more that is so altogether (kRough). A sheet's bend is d / (2 H - d), a third at half of its depth H. Nor
/// is it a layer that has settled where the stress does not hold it (`settled`). `stress` is an impulse, that of a step
/// on the point's volume [J s]; per_mass: 1 over the step and the mass.
[[gnu::always_inline]] inline void bend(const MirrorBatch& batch, const Mat3x4& stress, const Double4& per_mass,
                                        Double4* v, Mat3x4& gradient) {
    constexpr double kGentle = 1.0 / 9.0, kRough = 2.0 / 9.0;
    const Vec3x4 slope = times(gradient, batch.normal);
    Double4 q[3], across{}, sinks{};
    for (int k = 0; k < 3; ++k) {
        q[k] = slope[k] * batch.above - v[k];
        across += q[k] * batch.normal[k], sinks += v[k] * batch.normal[k];
    }
    Double4 bends{}, moves{};
    for (int k = 0; k < 3; ++k) {
        q[k] -= across * batch.normal[k];
        const Double4 along = v[k] - sinks * batch.normal[k];
        bends += q[k] * q[k], moves += along * along;
    }
    const Double4 none{}, share = min(max(kRough * moves - bends, none), (kRough - kGentle) * moves);
    const Double4 whole = (kRough - kGentle) * moves;
    const Double4 weight =
        settled(batch, slope, times(stress, batch.normal), per_mass) * share / select(whole > 0.0, whole, none + 1.0);
    for (int k = 0; k < 3; ++k) {
        v[k] -= weight * batch.shift * q[k];
        for (int l = 0; l < 3; ++l) gradient(k, l) -= weight * batch.steeper * q[k] * batch.normal[l];
    }
}

/// MirrorParticle::without_shear.
[[gnu::noinline]] inline void slide(const MirrorBatch& batch, Mat3x4& gradient) {
    for (int s = 0; s < batch.slides; ++s) {
        const Double4* const n = batch.slide[s];
        const Vec3x4 across = times(gradient, n);
        Double4 out{};
        for (int k = 0; k < 3; ++k) out += across[k] * n[k];
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) gradient(k, l) -= (across[k] - out * n[k]) * n[l];
    }
}

/// The contributions of mirror particles: the motion and the stress of their points, mirrored. Forces between a point
/// and its mirror particle are equal and opposite. bends: also in their speeds along stuck surfaces.
template <bool bends, class Law>
[[gnu::always_inline]] inline BatchContribution mirrored_contribution(const Law& law, const MaterialPoints& q,
                                                                      const MirrorBatch& batch, const Vec3& gravity,
                                                                      double dt) {
    Double4 state[7], v[3];
    Mat3x4 gradient;
    for (int n = 0; n < Law::kStates; ++n) state[n] = batch.of(q.state[n]);
    for (int n = 0; n < 9; ++n) gradient.entry[n] = batch.of(q.gradient[n]);
    const Double4 impulse_scale = -dt * batch.of(q.rest_volume);
    const Mat3x4 stress = (law.stress(batch.of(q.j), state, gradient) * impulse_scale).matrix();
    for (int k = 0; k < 3; ++k) v[k] = batch.of(q.v[k]);
    if (bends && any(batch.above > 0.0)) bend(batch, stress, 1.0 / (dt * batch.of(q.mass)), v, gradient);
    if (batch.slides > 0) slide(batch, gradient);
    for (int k = 0; k < 3; ++k) v[k] += dt * gravity[k];
    const Mat3x4 affine = product(product(batch.motion, gradient), batch.turned_back),
                 force = product(product(batch.motion, stress), batch.turned_back);
    BatchContribution contribution;
    contribution.mass = batch.of(q.mass), contribution.mass_j = Double4{};
    for (int k = 0; k < 3; ++k) {
        contribution.momentum[k] =
            contribution.mass * (batch.motion(k, 0) * v[0] + batch.motion(k, 1) * v[1] + batch.motion(k, 2) * v[2]);
        for (int l = 0; l < 3; ++l)
            contribution.affine[l][k] = contribution.mass * affine(k, l), contribution.force[l][k] = force(k, l);
    }
    return contribution;
}

/// Adds what one mirror particle gives to its 27 nodes; first: of these, along each axis.
template <Affine affine>
[[gnu::always_inline]] inline void contribute(const Grid3d& grid, double* nodes, const std::array<Index, 3>& first,
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
