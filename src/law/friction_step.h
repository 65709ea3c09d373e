#pragma once
// One time step of a speed that friction brakes: the state for a bed law, and solutions that several laws share.
// Numbers of equations: src/shallow/THEORY.md, section 9.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/simd.h"

namespace frana {

/// A node's state for a bed law. Real: double, or Double4 for four nodes at once.
template <class Real>
struct BedStateOf {
    Real normal_gravity;  ///< N / kappa: normal force per mass, over |V|/|v| [m/s^2]
    Real thickness;       ///< normal to the bed, > 0 [m]
    Real kappa;           ///< |V|/|v|, speed along the bed over speed along the map [1]
    Real cosine;          ///< cosine of the bed's slope [1]
    double gravity;       ///< [m/s^2]
    double density;       ///< [kg/m^3]
};
using BedState = BedStateOf<double>;

/// tanh(sqrt(x)) / sqrt(x), for x < 0 tan(sqrt(-x)) / sqrt(-x); -1 where that would be infinite or negative.
inline double tangent_ratio(double x) {
    const double root = std::sqrt(std::abs(x));
    if (root == 0.0) return 1.0;
    if (x > 0.0) return std::tanh(root) / root;
    return root < 1.5 ? std::tan(root) / root : -1.0;
}

/// Largest |x| for which tangent_series is right to round-off: the next term is 1.5e-3 x^7.
constexpr double kTangentSeries = 1e-2;

/// The same by its Taylor series.
template <class Real>
[[gnu::always_inline]] inline Real tangent_series(Real x) {
    return 1.0 +
           x * (-1.0 / 3 + x * (2.0 / 15 + x * (-17.0 / 315 +
                                                x * (62.0 / 2835 + x * (-1382.0 / 155925 + x * (21844.0 / 6081075))))));
}

/// Largest |x| for which tangent_fraction is right to round-off.
constexpr double kTangentFraction = 1.0;

/// The same by the ninth convergent of Lambert's continued fraction (1768), 1 / (1 + x / (3 + x / (5 + ...))).
template <class Real>
[[gnu::always_inline]] inline Real tangent_fraction(Real x) {
    const Real above = 1.0 + x * (7.0 / 51 + x * (1.0 / 255 + x * (2.0 / 69615 + x * (1.0 / 34459425))));
    const Real below = 1.0 + x * (8.0 / 17 + x * (7.0 / 255 + x * (4.0 / 9945 + x * (1.0 / 765765))));
    return above / below;
}

/// THEORY (38): one step of  ds/dt = drive - coulomb - quadratic s^2, exactly (Riccati): with net = drive - coulomb and
/// T = tangent_ratio(net quadratic dt^2), s = (s0 + net dt T) / (1 + quadratic s0 dt T). `s0`: speed at the start along
/// the driven direction, `driven`: speed that the drive alone would give at the end. Returns the speed after dt >= 0.
/// The drive is taken constant over the step: terminal speeds are exact, any dt is stable.
template <class Real>
[[gnu::always_inline]] inline Real riccati_speed(Real s0, Real driven, Real coulomb, Real quadratic, double dt) {
    const Real gain = driven - s0 - dt * coulomb, x = dt * quadratic * gain, none = {};
    const Real size = abs(x);
    Real ratio = tangent_series(x);
    if (any(size >= kTangentSeries)) ratio = select(size < kTangentSeries, ratio, tangent_fraction(x));
    if constexpr (std::is_same_v<Real, double>) {
        if (!(size < kTangentFraction)) ratio = tangent_ratio(x);
    } else if (any(size >= kTangentFraction)) {
        for (int n = 0; n < 4; ++n)
            if (!(size[n] < kTangentFraction)) ratio[n] = tangent_ratio(x[n]);
    }
    const Real speed = max((s0 + gain * ratio) / (1.0 + dt * quadratic * s0 * ratio), none);
    return select((s0 + gain <= 0.0) | (ratio <= 0.0), none, speed);
}

/// THEORY (40): one step of  ds/dt = drive - f(s)  from s0, with f linear about the speed that backward Euler found.
/// The result is its change times (1 + x) (1 - exp(-x)) / x, x = dt f'. Exact for linear friction, third order for any,
/// for stiff friction backward Euler itself. A steady speed stays, and what backward Euler stopped stays stopped. f' is
/// taken two thirds of the way. There the line has the mean of f over the step up to its third derivative. It is not
/// the chord from s0. Where granular and yielding beds leave rest f is steep for a moment. A small change of s0 would
/// then come out a thousand times as large. `slope`: f'(s) [1/s] at s > 0.
template <class Slope>
double relaxed_speed(double s0, double euler, double dt, const Slope& slope) {
    const double change = euler - s0;
    if (euler <= 0.0 || change == 0.0) return euler;
    const double x = dt * slope((s0 + 2.0 * euler) / 3.0);
    if (!(x > 0.0 && x < 1e300)) return euler;
    return std::max(s0 + change * (1.0 + x) * -std::expm1(-x) / x, 0.5 * euler);
}

}  // namespace frana
