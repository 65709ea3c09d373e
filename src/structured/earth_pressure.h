#pragma once
// Lateral pressure of grains over that across the bed (Rankine 1857; Savage and Hutter 1989).
#include <cmath>
#include <cstring>

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

/// exp(-x) of four numbers from 0 to 700, to round-off: 2^n exp(r), |r| <= ln(2) / 2, whose thirteenth power over 13! is
/// below 2e-16. ln(2) in two parts (fdlibm's), the first short enough for n times it to be exact.
[[gnu::always_inline]] inline Double4 exp_of_minus(Double4 x) {
    const Double4 n = floor(0.5 - 1.4426950408889634 * x);
    const Double4 r = (-x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    Double4 sum = all(1.0);
    for (int k = 12; k > 0; --k) sum = 1.0 + (1.0 / k) * r * sum;
    const Mask4 bits = (__builtin_convertvector(__builtin_convertvector(n, Int4), Mask4) + 1023) << 52;
    Double4 power;
    std::memcpy(&power, &bits, sizeof power);
    return power * sum;
}

/// tanh where x is above zero, otherwise zero. Four numbers: right to 3e-16, which is round-off of a one.
[[gnu::always_inline]] inline double tanh_above_zero(double x) { return x > 0.0 ? std::tanh(x) : 0.0; }
[[gnu::always_inline]] inline Double4 tanh_above_zero(Double4 x) {
    const Double4 none = {};
    if (!any(x > 0.0)) return none;
    constexpr double kOne = 20.0;  // from where on it is 1
    const Double4 e = exp_of_minus(2.0 * min(max(x, none), all(kOne)));
    return (1.0 - e) / (1.0 + e);
}

/// THEORY (6): K along the principal axes of the strain rate [1/s]. It is active where the layer extends or rests. It
/// is passive where the layer is squeezed much faster than its own fall takes, sqrt(depth / pull) [s] / 10.
template <class Real>
[[gnu::always_inline]] inline Sym2Of<Real> earth_pressure_of(const Sym2Of<Real>& rate, Real depth, Real normal_gravity,
                                                             const Rankine& k) {
    const Real centre = 0.5 * (rate.xx + rate.yy), half = 0.5 * (rate.xx - rate.yy);
    const Real radius = sqrt(half * half + rate.xy * rate.xy), fall = 10.0 * sqrt(depth / normal_gravity);
    const auto along = [&](Real r) { return k.active + (k.passive - k.active) * tanh_above_zero(-r * fall); };
    const Real first = along(centre + radius), second = along(centre - radius);
    const Real mean = 0.5 * (first + second), none = {};
    const Real spread = 0.5 * (first - second) / select(radius > 0.0, radius, none + 1.0);
    return {mean + spread * half, mean - spread * half, spread * rate.xy};
}
inline Sym2 earth_pressure(const Sym2& rate, double depth, double normal_gravity, const Rankine& k) {
    return earth_pressure_of<double>(rate, depth, normal_gravity, k);
}

}  // namespace frana
