#pragma once
// Lateral pressure of grains over that across the bed (Rankine 1857; Savage and Hutter 1989).
#include <cmath>

namespace frana {

/// A symmetric tensor in the plane.
struct Sym2 {
    double xx = 0.0, yy = 0.0, xy = 0.0;
};

/// Ka and Kp, Rankine's coefficients [1].
struct Rankine {
    double active = 1.0, passive = 1.0;
};

/// K along the principal axes of the strain rate [1/s]: active where the layer extends or rests, passive
/// where it is squeezed much faster than its own fall takes, sqrt(depth / pull) [s] / 10.
inline Sym2 earth_pressure(const Sym2& rate, double depth, double pull, const Rankine& k) {
    const double centre = 0.5 * (rate.xx + rate.yy), half = 0.5 * (rate.xx - rate.yy);
    const double radius = std::sqrt(half * half + rate.xy * rate.xy);
    const double fall = 10.0 * std::sqrt(depth / pull);
    const auto along = [&](double r) {
        return r >= 0.0 ? k.active : k.active + (k.passive - k.active) * std::tanh(-r * fall);
    };
    const double first = along(centre + radius), second = along(centre - radius);
    const double mean = 0.5 * (first + second);
    if (!(radius > 0.0)) return {mean, mean, 0.0};
    const double spread = 0.5 * (first - second) / radius;
    return {mean + spread * half, mean - spread * half, spread * rate.xy};
}

}  // namespace frana
