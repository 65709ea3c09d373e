#pragma once
// What yield-stress fluids share.
#include <cmath>

#include "law/solid/deformation.h"
#include "law/solid/key.h"

namespace frana::solid {

/// Shear modulus of yield-stress fluids where none is given, in yield stresses. Stiffer ones cost steps and change nothing.
constexpr double kStiff = 100.0;

/// Cauchy stress times J: the pressure, never tension, and the deviatoric stress that a point stores.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> stress_in(Real j, const Given<Real>* state, double bulk) {
    return SymOf<Real>::read(state).plus_isotropic(-bulk * max(1.0 - j, Real{})) * j;
}

/// A step without flow: J, and the deviatoric stress that an elastic solid would have after it.
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> elastic_trial(const DeformationOf<Real>& d, Real& j, const Given<Real>* state,
                                                        double shear) {
    j = min(j * (1.0 + d.dt * trace<Real>(d.gradient)), Real{} + 1.0);
    return spun<Real>(SymOf<Real>::read(state), d) +
           SymOf<Real>::of(d.gradient).deviator() * (Real{} + 2.0 * shear * d.dt);
}

/// Of waves in a solid of these moduli [m/s].
inline double sound_speed_in(double bulk, double shear, double density) {
    return std::sqrt((bulk + 4.0 / 3.0 * shear) / density);
}

/// Of a yield-stress fluid: what it is pressed, and its deviatoric stress, s : s / (4 G).
template <class Real>
[[gnu::always_inline]] inline Real stored_in(Real j, const SymOf<Real>& s, double bulk, double shear) {
    const Real pressed = max(1.0 - j, Real{});
    return 0.5 * bulk * pressed * pressed + 0.25 / shear * j * contracted(s, s);
}

}  // namespace frana::solid
