#pragma once
// Lateral pressure of grains over that across the bed (Rankine 1857; Savage and Hutter 1989).
#include <cmath>

#include "base/simd.h"

namespace frana {

/// A symmetric tensor in the plane.
template <class Real>
struct Sym2Of {
    Real xx{}, yy{}, xy{};
};
using Sym2 = Sym2Of<double>;

/// Ka and Kp, Rankine's coefficients [1].
struct Rankine {
    double active = 1.0, passive = 1.0;
};

/// tanh where x is above zero, otherwise zero.
[[gnu::always_inline]] inline double tanh_above_zero(double x) { return x > 0.0 ? std::tanh(x) : 0.0; }
[[gnu::always_inline]] inline Double4 tanh_above_zero(Double4 x) {
    Double4 value = {};
    if (any(x > 0.0))
        for (int n = 0; n < 4; ++n) value[n] = tanh_above_zero(x[n]);
    return value;
}

/// K along the principal axes of the strain rate [1/s]: active where the layer extends or rests, passive
/// where it is squeezed much faster than its own fall takes, sqrt(depth / pull) [s] / 10.
template <class Real>
[[gnu::always_inline]] inline Sym2Of<Real> earth_pressure_of(const Sym2Of<Real>& rate, Real depth, Real pull,
                                                             const Rankine& k) {
    const Real centre = 0.5 * (rate.xx + rate.yy), half = 0.5 * (rate.xx - rate.yy);
    const Real radius = sqrt(half * half + rate.xy * rate.xy), fall = 10.0 * sqrt(depth / pull);
    const auto along = [&](Real r) { return k.active + (k.passive - k.active) * tanh_above_zero(-r * fall); };
    const Real first = along(centre + radius), second = along(centre - radius);
    const Real mean = 0.5 * (first + second), none = {};
    const Real spread = 0.5 * (first - second) / select(radius > 0.0, radius, none + 1.0);
    return {mean + spread * half, mean - spread * half, spread * rate.xy};
}
inline Sym2 earth_pressure(const Sym2& rate, double depth, double pull, const Rankine& k) {
    return earth_pressure_of<double>(rate, depth, pull, k);
}

}  // namespace frana
