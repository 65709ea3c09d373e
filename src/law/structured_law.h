#pragma once
// Structured solids: how the stress of a depth-averaged particle goes on with its deformation in the plane. It is
// elastic until it yields, and yielding breaks it. After van den Bout et al. (2021, doi:10.5194/gmd-14-1841-2021, sec.
// 2.2, with the stress across the bed prescribed by the weight). Tension is positive. Functions are for one particle
// (Real is double) or for four at once (Double4). Numbers of equations: src/structured/THEORY.md.
#include <cmath>

#include "base/simd.h"

namespace frana {

/// Stress of a particle, the mean over its depth [Pa]; zz across the bed.
template <class Real>
struct StructuredStressOf {
    Real xx{}, yy{}, zz{}, xy{};
};
using StructuredStress = StructuredStressOf<double>;

/// What a step does to a particle in the plane: strain [1], xy as the tensor has it, and turn,
/// counter-clockwise [rad].
template <class Real>
struct StructuredStepOf {
    Real xx{}, yy{}, xy{}, turn{};

    /// Of the velocity gradient L_kl = dv_k/dx_l [1/s] over dt [s].
    [[gnu::always_inline]] static StructuredStepOf of(Real lxx, Real lxy, Real lyx, Real lyy, double dt) {
        return {dt * lxx, dt * lyy, 0.5 * dt * (lxy + lyx), 0.5 * dt * (lyx - lxy)};
    }
};
using StructuredStep = StructuredStepOf<double>;

/// What a particle of this law stores.
template <class Real>
struct StructuredStateOf {
    StructuredStressOf<Real> stress;
    Real damage{};  ///< 0 whole, 1 grains
    Real strain{};  ///< sum of |strain| so far, which DamageBy::strain counts its onset by [1]
};
using StructuredState = StructuredStateOf<double>;

/// Where the particle yields. Cones of Drucker and Prager that meet Mohr and Coulomb's pyramid in triaxial
/// compression, or in plane strain without dilatancy. Or the pyramid itself, which the prescribed zz cuts in a hexagon.
enum class StructuredYield { compression, plane_strain, hexagon };

/// THEORY (18): what breaks bonds while the particle yields, in parts of the critical strain. dilation: the plastic
/// dilation in the plane, as in the paper. extension: the largest principal plastic strain. strain: any strain at all,
/// behind an onset, with what is left decaying exponentially, as in the paper's source code.
enum class DamageBy { dilation, extension, strain };

/// What a user says of a structured solid.
struct StructuredMaterial {
    double young = 1e6;      ///< E [Pa]
    double poisson = 0.3;    ///< nu [1]
    double friction = 0.5;   ///< phi, internal angle [rad], 0 to pi / 2
    double dilatancy = 0.0;  ///< psi [rad], 0 to phi
    StructuredYield yield = StructuredYield::compression;
    DamageBy damage_by = DamageBy::dilation;
    double critical_strain = 0.1;  ///< eps_c at which no bond is left [1]
    double onset = 0.0;            ///< strain before which DamageBy::strain breaks nothing [1]
};

/// eps_c on cells of `cell` [m], of a material that has `reference` on cells of `reference_cell` [m]. Strain
/// localises in a crack of one cell, so that a crack opens by the same way on any grid.
inline double critical_strain(double reference, double reference_cell, double cell) {
    return reference * reference_cell / cell;
}

/// A stress brought back to a cone, and the multiplier of the flow.
struct ConeReturn {
    double scale;       ///< of the trial's deviator
    double first;       ///< first invariant afterwards [Pa]
    double multiplier;  ///< d lambda [1]; 0 when the trial does not yield
};

/// In-plane plastic strain of a step.
template <class Real>
struct PlasticStepOf {
    Real dilation{};   ///< trace in the plane [1]
    Real extension{};  ///< largest principal value in the plane [1]
};
using PlasticStep = PlasticStepOf<double>;

/// Cosine and sine of twice an angle: what turns a stress by it.
template <class Real>
struct TurnOf {
    Real cosine, sine;
    [[gnu::always_inline]] static TurnOf by(Real angle);
};

class StructuredLaw {
public:
    explicit StructuredLaw(const StructuredMaterial& material);
    const StructuredMaterial& material() const { return material_; }
    bool is_hexagon() const { return material_.yield == StructuredYield::hexagon; }
    double bulk() const { return bulk_; }
    double shear() const { return shear_; }
    double alpha() const { return alpha_; }                           ///< of the cone: sqrt(J2) + alpha I1 = k
    double strength(double cohesion) const { return k_ * cohesion; }  ///< k [Pa]
    double active() const { return active_; }                         ///< Ka, Rankine's
    double passive() const { return 1.0 / active_; }                  ///< Kp
    /// Of waves in the plane, zz given, THEORY (19): sqrt(E / (rho (1 - nu^2))) [m/s]
    double sound_speed(double density) const { return std::sqrt(plane_ / density); }

    /// THEORY (11), (12): the step with zz = `weight` [Pa, negative] at its end and the undamaged `cohesion` [Pa]. It
    /// is half the turn, the strain, half the turn. Damage of this step weakens the next.
    template <class Real>
    [[gnu::always_inline]] void update(const StructuredStepOf<Real>& step, Real weight, Real cohesion,
                                       StructuredStateOf<Real>& state) const {
        if (is_hexagon())
            update_as<true>(step, weight, cohesion, state);
        else
            update_as<false>(step, weight, cohesion, state);
    }
    /// The same where the yield surface is known before a loop.
    template <bool kHexagon, class Real>
    [[gnu::always_inline]] void update_as(const StructuredStepOf<Real>& step, Real weight, Real cohesion,
                                          StructuredStateOf<Real>& state) const {
        const Real left = cohesion * (1.0 - state.damage);
        const TurnOf<Real> half = TurnOf<Real>::by(0.5 * step.turn);
        StructuredStressOf<Real> s = predicted<Real>(turned<Real>(state.stress, half), step, weight);
        state.strain += abs(step.xx) + abs(step.yy) + 2.0 * abs(step.xy);
        const auto yields = excess_as<kHexagon, Real>(s, left) > 0.0;
        if (__builtin_expect(any(yields), 0)) give_way(yields, step, left, s, state);
        state.stress = turned<Real>(s, half);
    }

    /// THEORY (13), (17): how far a stress lies outside the yield surface [Pa]: sqrt(J2) + alpha I1 - k, or the largest
    /// of the hexagon's.
    template <class Real>
    [[gnu::always_inline]] Real excess(const StructuredStressOf<Real>& s, Real cohesion) const {
        return is_hexagon() ? excess_as<true, Real>(s, cohesion) : excess_as<false, Real>(s, cohesion);
    }
    template <bool kHexagon, class Real>
    [[gnu::always_inline]] Real excess_as(const StructuredStressOf<Real>& s, Real cohesion) const {
        if constexpr (kHexagon) return hexagon_excess<Real>(s, cohesion);
        const Real first = s.xx + s.yy + s.zz, mean = (1.0 / 3.0) * first;
        const Real x = s.xx - mean, y = s.yy - mean, z = s.zz - mean;
        return sqrt(0.5 * (x * x + y * y + z * z) + s.xy * s.xy) + alpha_ * first - k_ * cohesion;
    }

    /// THEORY (14): closed-form return of a trial stress in 3D with invariants sqrt(J2) = q and I1. It goes to the cone
    /// of strength k, its apex included, for any dilatancy.
    ConeReturn to_cone(double q, double first, double k) const;
    /// Elastic stress `s`, zz as prescribed, to the yield surface with zz as it is.
    PlasticStep yield(double cohesion, StructuredStress& s) const;

private:
    /// R s R^T; zz stays.
    template <class Real>
    [[gnu::always_inline]] static StructuredStressOf<Real> turned(const StructuredStressOf<Real>& s,
                                                                  const TurnOf<Real>& turn) {
        const Real centre = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
        const Real across = half * turn.cosine - s.xy * turn.sine;
        return {centre + across, centre - across, s.zz, half * turn.sine + s.xy * turn.cosine};
    }
    template <class Real>
    [[gnu::always_inline]] StructuredStressOf<Real> predicted(const StructuredStressOf<Real>& s,
                                                              const StructuredStepOf<Real>& step, Real weight) const {
        const Real lift = weight_share_ * (weight - s.zz);
        return {s.xx + plane_ * (step.xx + material_.poisson * step.yy) + lift,
                s.yy + plane_ * (step.yy + material_.poisson * step.xx) + lift, weight, s.xy + 2.0 * shear_ * step.xy};
    }
    template <class Real>
    [[gnu::always_inline]] Real hexagon_excess(const StructuredStressOf<Real>& s, Real cohesion) const {
        const Real centre = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
        const Real radius = sqrt(half * half + s.xy * s.xy);
        const Real most = max(centre + radius, s.zz), least = min(centre - radius, s.zz);
        return (most - least) + (most + least) * sine_ - 2.0 * cosine_ * cohesion;
    }
    // Four by reference: by value they travel differently between files built for different instruction sets.
    void give_way(bool yields, const StructuredStep& step, double left, StructuredStress& s,
                  StructuredState& state) const;
    void give_way(const Mask4& yields, const StructuredStepOf<Double4>& step, const Double4& left,
                  StructuredStressOf<Double4>& s, StructuredStateOf<Double4>& state) const;
    template <class Real, class Mask>
    [[gnu::always_inline]] Mask newton_to_cone(Mask yields, Real k, StructuredStressOf<Real>& s,
                                               PlasticStepOf<Real>& plastic) const;
    PlasticStep yield_to_cone(double k, StructuredStress& s) const;
    PlasticStep search_cone(double k, StructuredStress& s) const;
    PlasticStep yield_to_hexagon(double cohesion, StructuredStress& s) const;

    StructuredMaterial material_;
    double shear_, bulk_, plane_, weight_share_;    ///< G, K, E / (1 - nu^2) [Pa]; nu / (1 - nu)
    double sine_, cosine_, active_;                 ///< of phi; Ka
    double alpha_ = 0.0, k_ = 0.0, dilates_ = 0.0;  ///< of the cone; k over cohesion; alpha at psi
};

/// cos and sin of a small angle to round-off: the terms left out are below 0.05^12 / 12! < 1e-24.
constexpr double kSmallTurn = 0.05;  // [rad]
template <class Real>
[[gnu::always_inline]] inline void small_turn(Real a, Real& cosine, Real& sine) {
    const Real b = a * a;
    cosine = 1.0 - 0.5 * b * (1.0 - 1.0 / 12 * b * (1.0 - 1.0 / 30 * b * (1.0 - 1.0 / 56 * b * (1.0 - 1.0 / 90 * b))));
    sine = a * (1.0 - 1.0 / 6 * b *
                          (1.0 - 1.0 / 20 * b * (1.0 - 1.0 / 42 * b * (1.0 - 1.0 / 72 * b * (1.0 - 1.0 / 110 * b)))));
}
void large_turn(double a, double& cosine, double& sine);
void large_turn(const Double4& a, Double4& cosine, Double4& sine);

template <class Real>
[[gnu::always_inline]] inline TurnOf<Real> TurnOf<Real>::by(Real angle) {
    const Real twice = 2.0 * angle;
    TurnOf turn;
    if (__builtin_expect(any(abs(twice) > kSmallTurn), 0))
        large_turn(twice, turn.cosine, turn.sine);
    else
        small_turn<Real>(twice, turn.cosine, turn.sine);
    return turn;
}

}  // namespace frana
