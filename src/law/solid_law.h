#pragma once
// Laws of material in space: stress of a point from its own numbers, and how these change with the
// deformation. A law is a struct of parameters with
//
//   kStates      numbers that a point keeps for it
//
//   kAverages    whether J is drawn to its mean over the neighbourhood, a cure for noisy pressure in fluids
//
//   stress()     Cauchy stress times J, tension positive [Pa]
//
//   update()     the same numbers after a step
//
//   sound_speed(), explicit_viscosity()   what bounds the step [m/s], [Pa s]
#include <cmath>
#include <variant>

#include "base/types.h"

namespace frana {

/// Symmetric tensor in space.
struct Sym3 {
    double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, yz = 0.0, xz = 0.0;

    double trace() const { return xx + yy + zz; }
    /// sqrt(a : a)
    double norm() const {
        return std::sqrt(xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + xz * xz));
    }
    Sym3 deviator() const {
        const double mean = trace() / 3.0;
        return {xx - mean, yy - mean, zz - mean, xy, yz, xz};
    }
    Sym3 operator+(const Sym3& b) const {
        return {xx + b.xx, yy + b.yy, zz + b.zz, xy + b.xy, yz + b.yz, xz + b.xz};
    }
    Sym3 operator*(double s) const { return {s * xx, s * yy, s * zz, s * xy, s * yz, s * xz}; }
    Sym3 plus_isotropic(double p) const { return {xx + p, yy + p, zz + p, xy, yz, xz}; }
    Mat3 matrix() const { return (Mat3() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished(); }
    static Sym3 of(const Mat3& m) {
        return {m(0, 0),
                m(1, 1),
                m(2, 2),
                0.5 * (m(0, 1) + m(1, 0)),
                0.5 * (m(1, 2) + m(2, 1)),
                0.5 * (m(0, 2) + m(2, 0))};
    }
    static Sym3 read(const double* s) { return {s[0], s[1], s[2], s[3], s[4], s[5]}; }
    void write(double* s) const { s[0] = xx, s[1] = yy, s[2] = zz, s[3] = xy, s[4] = yz, s[5] = xz; }
};

/// What a law learns of a step: L_kl = dv_k/dx_l at the point [1/s], and the step [s].
struct Deformation {
    Mat3 gradient;
    double dt;
};

namespace solid {

/// Weakly compressible fluid: p = K (1 - J), never tension (J is cut at 1). Newtonian viscosity.
struct Fluid {
    static constexpr int kStates = 0;
    static constexpr bool kAverages = true;
    double bulk = 1.0;       ///< K [Pa]
    double viscosity = 0.0;  ///< [Pa s]

    Sym3 stress(double j, const double*, const Mat3& gradient) const {
        return (Sym3::of(gradient).deviator() * (2.0 * viscosity))
                   .plus_isotropic(-bulk * std::fmax(0.0, 1.0 - j)) *
               j;
    }
    void update(const Deformation& d, double& j, double* state) const;
    double sound_speed(double density) const { return std::sqrt(bulk / density); }
    double explicit_viscosity() const { return viscosity; }
};

/// The same with a yield stress: an elastic solid of shear modulus G below it, Bingham's fluid above. The
/// viscous flow is solved in the step, so that any viscosity is stable and material at rest really rests.
struct Bingham {
    static constexpr int kStates = 6;  ///< deviatoric stress [Pa]
    static constexpr bool kAverages = true;
    double bulk = 1.0;          ///< K [Pa]
    double shear = 1.0;         ///< G [Pa]; a hundred yield stresses are stiff enough
    double viscosity = 0.0;     ///< [Pa s]
    double yield_stress = 0.0;  ///< tau_Y [Pa], of sqrt(s:s / 2)

    Sym3 stress(double j, const double* state, const Mat3&) const {
        return Sym3::read(state).plus_isotropic(-bulk * std::fmax(0.0, 1.0 - j)) * j;
    }
    void update(const Deformation& d, double& j, double* state) const;
    double sound_speed(double density) const { return std::sqrt((bulk + 4.0 / 3.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

/// Hencky's elastic solid: Kirchhoff stress linear in the logarithmic strain, tau = 2 G e + lambda tr(e) I.
/// Agrees with the linear theory for small strain, and stays objective for any rotation.
struct Elastic {
    static constexpr int kStates = 6;  ///< logarithmic strain [1]
    static constexpr bool kAverages = false;
    double lambda = 1.0, shear = 1.0;  ///< Lame's constants [Pa]

    static Elastic of(double young, double poisson) {
        return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson)};
    }
    Sym3 stress(double, const double* state, const Mat3&) const {
        const Sym3 e = Sym3::read(state);
        return (e * (2.0 * shear)).plus_isotropic(lambda * e.trace());
    }
    void update(const Deformation& d, double& j, double* state) const;
    double energy(const double* state) const {
        const Sym3 e = Sym3::read(state);
        return shear * e.norm() * e.norm() + 0.5 * lambda * e.trace() * e.trace();
    }
    double sound_speed(double density) const { return std::sqrt((lambda + 2.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

/// Where Drucker and Prager's cone meets Mohr and Coulomb's pyramid: in triaxial compression, or in plane
/// strain, where flow without dilatancy makes the stress across the plane the mean of the others, so that
/// both laws agree.
enum class Cone { compression, plane_strain };

/// Sand, soil: elastic as above within the cone |s| = alpha (p + p_t) of Drucker and Prager, in Kirchhoff
/// stress, p_t = c cot(phi). Flow keeps the volume (no dilatancy). At the apex the material parts: it carries
/// the tension p_t and no more, and the volume it gained has to be closed before it carries pressure again
/// (Tampubolon et al. 2017, sec. 4.3.4).
struct DruckerPrager {
    static constexpr int kStates = 7;  ///< logarithmic elastic strain; volume gained at the apex, ln J [1]
    static constexpr bool kAverages = false;
    Elastic elastic;
    double alpha = 0.0;    ///< |s| per pressure [1]
    double tension = 0.0;  ///< p_t, the pressure at the apex, negated [Pa]

    static DruckerPrager of(const Elastic& elastic, double friction_angle, double cohesion,
                            Cone cone = Cone::compression);
    Sym3 stress(double j, const double* state, const Mat3& gradient) const {
        return elastic.stress(j, state, gradient);
    }
    void update(const Deformation& d, double& j, double* state) const;
    double sound_speed(double density) const { return elastic.sound_speed(density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace solid

using SolidLaw = std::variant<solid::Fluid, solid::Bingham, solid::Elastic, solid::DruckerPrager>;

/// What becomes of the logarithmic strain e by an elastic deformation F = I + grown: ln(F exp(2 e) F^T) / 2,
/// to round-off.
Sym3 carried_strain(const Sym3& e, const Mat3& grown);

}  // namespace frana
