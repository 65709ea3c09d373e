#pragma once
// Stress inside the depth-averaged mass, from the strain rate of a point. Pressure is not part of it.
// Numbers of equations: src/shallow/THEORY.md, section 7.
#include <cmath>

#include "base/simd.h"
#include "law/rheology_parameters.h"

namespace frana {

/// Symmetric plane tensor: stress [Pa] or strain rate [1/s]. Real: double, or Double4 for four points at once.
template <class Real>
struct PlaneOf { Real xx{}, yy{}, xy{}; };
using Plane = PlaneOf<double>;

/// What a rheology sees of a point.
template <class Real>
struct StrainState {
    PlaneOf<Real> rate;  ///< sym grad v [1/s]
    Real speed;          ///< along the bed [m/s]
    Real depth;          ///< across the bed, > 0 [m]
    double floor;        ///< regularisation of the yield stress [1/s]
    double cap;          ///< largest 2 mu_eff that is stable explicitly [Pa s]
};

template <class Real>
[[gnu::always_inline]] inline PlaneOf<Real> scaled(const PlaneOf<Real>& rate, Real factor) {
    return {factor * rate.xx, factor * rate.yy, factor * rate.xy};
}

/// sigma = 2 mu eps
template <class Real>
[[gnu::always_inline]] inline PlaneOf<Real> stress(const rheology::Newtonian& law, const StrainState<Real>& s) {
    return scaled(s.rate, Real{} + std::fmin(2.0 * law.viscosity, s.cap));
}

/// THEORY (25): plug share of a Bingham sheet whose bed is braked by nothing else (bingham_sheet with b = 0), to
/// absolute round-off: y = 1 - plug solves 3 y^2 - y^3 + d (y - 1) = 0. Convex and rising for y < 1; two steps of
/// Halley's method from a start that is right to 5 % leave 2e-17.
template <class Real>
[[gnu::always_inline]] inline Real plug_share(Real d) {
    d = min(d, Real{} + 1e100);  // squares must not overflow
    Real y = 2.0 * d / (d + sqrt(d * d + 11.0 * d) + 1e-300);
    for (int step = 0; step < 2; ++step) {
        const Real f = ((3.0 - y) * y + d) * y - d, slope = (6.0 - 3.0 * y) * y + d;
        y -= f * slope / (slope * slope - f * (3.0 - 3.0 * y) + 1e-300);
    }
    return 1.0 - y;
}

/// THEORY (23), (24): sigma = (2 mu + tau_Y / sqrt(I2 + floor^2)) eps (Fois et al. 2024, eq. 3, corrected). I2 holds
/// the plane strain rate, its incompressible vertical part, and the shear across the bed, 3/(2 + zeta) V/T, of a Bingham
/// sheet (eq. 4).
template <class Real>
[[gnu::always_inline]] inline PlaneOf<Real> stress(const rheology::Bingham& law, const StrainState<Real>& s) {
    if (law.yield_stress <= 0.0) return scaled(s.rate, Real{} + std::fmin(2.0 * law.viscosity, s.cap));
    const Real rate = s.speed / s.depth;
    // I2 + floor^2 times (2 + zeta)^2: a division less.
    const Real two_zeta = 2.0 + plug_share(6.0 * law.viscosity / law.yield_stress * rate), shear = 3.0 * rate;
    const Real zz = s.rate.xx + s.rate.yy;
    const Real plane = 0.5 * (s.rate.xx * s.rate.xx + s.rate.yy * s.rate.yy + zz * zz) + s.rate.xy * s.rate.xy +
                       s.floor * s.floor;
    const Real i2 = two_zeta * two_zeta * plane + 0.25 * shear * shear;
    const Real viscous = 2.0 * law.viscosity + law.yield_stress * two_zeta / sqrt(i2);
    return scaled(s.rate, min(viscous, Real{} + s.cap));
}

}  // namespace frana
