#pragma once
// Laws of 3D material: stress of a point from its own numbers, and how these change with the
// deformation. Numbers of equations: src/solid3d/THEORY.md, section 7. A law is a struct of parameters with
//
//   kStates      numbers that a point stores for it
//
//   kAverages    whether J is drawn to its mean over the neighbourhood, a cure for noisy pressure in fluids
//
//   stress()     Cauchy stress times J, tension positive [Pa]
//
//   update()     the same numbers after a step
//
//   stored()     energy that unloading gives back, per volume without stress [J/m^3]
//
//   sound_speed(), explicit_viscosity()   what bounds the step [m/s], [Pa s]
//
// stress(), update() and stored() are for one point (Real is double) or for four at once (Double4).
#include <cmath>
#include <variant>

#include "law/strain.h"

namespace frana {

/// A law's input of a step: L_kl = dv_k/dx_l at the point [1/s], and the step [s].
template <class Real>
struct DeformationOf {
    Square<Real> gradient;
    double dt;
};
using Deformation = DeformationOf<double>;

/// The stress-like state turned with the spin, W = (L - L^T) / 2: s + dt (W s - s W).
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> spun(const SymOf<Real>& s, const DeformationOf<Real>& d) {
    const double half = 0.5 * d.dt;
    const Real xy = half * (d.gradient(0, 1) - d.gradient(1, 0)), yz = half * (d.gradient(1, 2) - d.gradient(2, 1)),
               xz = half * (d.gradient(0, 2) - d.gradient(2, 0));
    return s + SymOf<Real>{2.0 * (xy * s.xy + xz * s.xz),
                           2.0 * (yz * s.yz - xy * s.xy),
                           -2.0 * (xz * s.xz + yz * s.yz),
                           xy * (s.yy - s.xx) + xz * s.yz + yz * s.xz,
                           yz * (s.zz - s.yy) - xy * s.xz - xz * s.xy,
                           xz * (s.zz - s.xx) + xy * s.yz - yz * s.xy};
}

/// F - I of the step, F = I + dt L.
template <class Real>
[[gnu::always_inline]] inline Square<Real> grown_in(const DeformationOf<Real>& d) {
    Square<Real> grown;
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) grown(k, l) = d.dt * d.gradient(k, l);
    return grown;
}

namespace solid {

/// THEORY (16): weakly compressible fluid, p = K (1 - J), never tension (J is cut at 1). Newtonian viscosity.
struct Fluid {
    static constexpr int kStates = 0;
    static constexpr bool kAverages = true;
    double bulk = 1.0;       ///< K [Pa]
    double viscosity = 0.0;  ///< [Pa s]

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>*, const Square<Real>& gradient) const {
        return (SymOf<Real>::of(gradient).deviator() * (Real{} + 2.0 * viscosity))
                   .plus_isotropic(-bulk * max(1.0 - j, Real{})) *
               j;
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>*) const {
        j = min(j * (1.0 + d.dt * trace<Real>(d.gradient)), Real{} + 1.0);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>*) const {
        const Real pressed = max(1.0 - j, Real{});
        return 0.5 * bulk * pressed * pressed;
    }
    double sound_speed(double density) const { return std::sqrt(bulk / density); }
    double explicit_viscosity() const { return viscosity; }
};

/// Of a yield-stress fluid: what it is pressed, and its deviatoric stress, s : s / (4 G).
template <class Real>
[[gnu::always_inline]] inline Real stored_in(Real j, const SymOf<Real>& s, double bulk, double shear) {
    const Real pressed = max(1.0 - j, Real{});
    return 0.5 * bulk * pressed * pressed + 0.25 / shear * j * contracted(s, s);
}

/// THEORY (17), (18): the same with a yield stress. Below it an elastic solid of shear modulus G, above it Bingham's
/// fluid. The viscous flow is solved in the step, so that any viscosity is stable and material at rest really rests.
struct Bingham {
    static constexpr int kStates = 6;  ///< deviatoric stress [Pa]
    static constexpr bool kAverages = true;
    double bulk = 1.0;          ///< K [Pa]
    double shear = 1.0;         ///< G [Pa]; a hundred yield stresses are stiff enough
    double viscosity = 0.0;     ///< [Pa s]
    double yield_stress = 0.0;  ///< tau_Y [Pa], of sqrt(s:s / 2)

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>&) const {
        return SymOf<Real>::read(state).plus_isotropic(-bulk * max(1.0 - j, Real{})) * j;
    }
    /// Elastic trial, then flow: of the stress beyond the yield stress what a viscous element in series
    /// leaves after dt.
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        j = min(j * (1.0 + d.dt * trace<Real>(d.gradient)), Real{} + 1.0);
        const SymOf<Real> trial = spun<Real>(SymOf<Real>::read(state), d) +
                                  SymOf<Real>::of(d.gradient).deviator() * (Real{} + 2.0 * shear * d.dt);
        const double relaxation = viscosity / (shear * d.dt);
        const Real size = trial.norm() * std::sqrt(0.5), divisor = select(size > 0.0, size, Real{} + 1.0);
        const Real left = (size * relaxation + yield_stress) / ((1.0 + relaxation) * divisor);
        (trial * select(size > yield_stress, left, Real{} + 1.0)).deviator().write(state);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return stored_in(j, SymOf<Real>::read(state), bulk, shear);
    }
    double sound_speed(double density) const { return std::sqrt((bulk + 4.0 / 3.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

/// THEORY (19): Herschel and Bulkley's fluid, as Bingham's above. But beyond the yield stress tau = tau_Y + K rate^n:
/// mud thins with shear, n < 1. In pure shear of rate gamma: tau = tau_Y + K gamma^n.
struct HerschelBulkley {
    static constexpr int kStates = 6;  ///< deviatoric stress [Pa]
    static constexpr bool kAverages = true;
    double bulk = 1.0;          ///< [Pa]
    double shear = 1.0;         ///< G [Pa]; a hundred yield stresses are stiff enough
    double consistency = 1.0;   ///< K [Pa s^n]
    double exponent = 1.0;      ///< n [1]
    double yield_stress = 0.0;  ///< tau_Y [Pa], of sqrt(s:s / 2)

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>&) const {
        return SymOf<Real>::read(state).plus_isotropic(-bulk * max(1.0 - j, Real{})) * j;
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        j = min(j * (1.0 + d.dt * trace<Real>(d.gradient)), Real{} + 1.0);
        const SymOf<Real> trial = spun<Real>(SymOf<Real>::read(state), d) +
                                  SymOf<Real>::of(d.gradient).deviator() * (Real{} + 2.0 * shear * d.dt);
        const Real size = trial.norm() * std::sqrt(0.5), over = max(size - yield_stress, Real{});
        if (!any(over > 0.0)) return trial.deviator().write(state);
        const Real left = (yield_stress + left_of(over, d.dt)) / select(size > 0.0, size, Real{} + 1.0);
        (trial * select(size > yield_stress, left, Real{} + 1.0)).deviator().write(state);
    }
    /// What flow leaves after dt of a stress beyond the yield stress, s + G dt (s / K)^(1/n) = over. It is the trial's
    /// stress less what relaxes at the end's rate [Pa].
    double left_of(double over, double dt) const;
    [[gnu::always_inline]] Double4 left_of(const Double4& over, double dt) const {
        return Double4{left_of(over[0], dt), left_of(over[1], dt), left_of(over[2], dt), left_of(over[3], dt)};
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return stored_in(j, SymOf<Real>::read(state), bulk, shear);
    }
    double sound_speed(double density) const { return std::sqrt((bulk + 4.0 / 3.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

/// THEORY (20): Hencky's elastic solid, Kirchhoff stress linear in the logarithmic strain, tau = 2 G e + lambda tr(e)
/// I. Agrees with the linear theory for small strain, and stays objective for any rotation.
struct Elastic {
    static constexpr int kStates = 6;  ///< logarithmic strain [1]
    static constexpr bool kAverages = false;
    double lambda = 1.0, shear = 1.0;  ///< Lame's constants [Pa]

    static Elastic of(double young, double poisson) {
        return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson)};
    }
    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real, const Given<Real>* state, const Square<Real>&) const {
        const SymOf<Real> e = SymOf<Real>::read(state);
        return (e * (Real{} + 2.0 * shear)).plus_isotropic(lambda * e.trace());
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const Square<Real> grown = grown_in<Real>(d);
        carried<Real>(SymOf<Real>::read(state), grown).write(state);
        j *= volume_ratio<Real>(grown);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real, const Given<Real>* state) const {
        const SymOf<Real> e = SymOf<Real>::read(state);
        return shear * contracted(e, e) + 0.5 * lambda * e.trace() * e.trace();
    }
    double sound_speed(double density) const { return std::sqrt((lambda + 2.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

/// Where Drucker and Prager's cone meets Mohr and Coulomb's pyramid: in triaxial compression, or in plane
/// strain. In plane strain, flow without dilatancy makes the stress across the plane the mean of the others. Both laws
/// then agree.
enum class Cone { compression, plane_strain };

/// THEORY (21), (22): sand, soil. It is elastic as above within the cone |s| = alpha (p + p_t) of Drucker and Prager,
/// in Kirchhoff stress, p_t = c cot(phi). Flow conserves the volume (no dilatancy). At the apex the material parts: it
/// carries the tension p_t and no more. The volume it gained has to be closed before it carries pressure again
/// (Tampubolon et al. 2017, sec. 4.3.4).
struct DruckerPrager {
    static constexpr int kStates = 7;  ///< logarithmic elastic strain; volume gained at the apex, ln J [1]
    static constexpr bool kAverages = false;
    /// Volume over that without stress of points that have parted: twice as far apart in each direction. What flies
    /// apart further leaves room between points, which need not close before they carry pressure again.
    static constexpr double kLoosest = 8.0;
    Elastic elastic;
    double alpha = 0.0;    ///< |s| per pressure [1]
    double tension = 0.0;  ///< p_t, the pressure at the apex, negated [Pa]

    static DruckerPrager of(const Elastic& elastic, double friction_angle, double cohesion,
                            Cone cone = Cone::compression);
    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>& gradient) const {
        return elastic.stress(j, state, gradient);
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const Square<Real> grown = grown_in<Real>(d);
        const SymOf<Real> trial = carried<Real>(SymOf<Real>::read(state), grown);
        j *= volume_ratio<Real>(grown);
        const double bulk = elastic.lambda + 2.0 / 3.0 * elastic.shear;
        const double apex = tension / bulk;  // the volume strain at which nothing is carried any more
        const Real volume = trial.trace() + state[6];
        const auto parted = volume >= apex;
        const SymOf<Real> shear_strain = trial.deviator();
        const Real size = 2.0 * elastic.shear * shear_strain.norm();
        const Real strength = alpha * bulk * (apex - volume);
        const Real yielding = strength / select(size > 0.0, size, Real{} + 1.0);
        const Real kept = select(parted, Real{}, select(size > strength, yielding, Real{} + 1.0));
        (shear_strain * kept).plus_isotropic(select(parted, Real{} + apex, volume) / 3.0).write(state);
        const Real gap = select(parted, volume - apex, Real{}), widest = Real{} + std::log(kLoosest);
        state[6] = min(gap, widest);
        j = min(j, Real{} + kLoosest);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return elastic.stored(j, state);
    }
    double sound_speed(double density) const { return elastic.sound_speed(density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace solid

using SolidLaw =
    std::variant<solid::Fluid, solid::Bingham, solid::Elastic, solid::DruckerPrager, solid::HerschelBulkley>;

}  // namespace frana
