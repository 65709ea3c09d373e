#pragma once
// Bed friction: for each law the exact or implicit solution of one time step. A law only ever slows a node down;
// it may stop it, it never turns it round, and a node at rest stays at rest to the last bit until driven hard enough.
// Numbers of equations: src/shallow/THEORY.md, section 9.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/simd.h"
#include "law/bed_parameters.h"

namespace frana {

/// What a bed law sees of a node. Real: double, or Double4 for four nodes at once.
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
           x * (-1.0 / 3 +
                x * (2.0 / 15 + x * (-17.0 / 315 + x * (62.0 / 2835 + x * (-1382.0 / 155925 + x * (21844.0 / 6081075))))));
}

/// THEORY (38): one step of  ds/dt = drive - coulomb - quadratic s^2, exactly (Riccati): with net = drive - coulomb and
/// T = tangent_ratio(net quadratic dt^2), s = (s0 + net dt T) / (1 + quadratic s0 dt T). `s0`: speed at the start along
/// the driven direction, `driven`: speed that the drive alone would give at the end. Returns the speed after dt >= 0.
/// The drive is taken constant over the step: terminal speeds are exact, any dt is stable.
template <class Real>
[[gnu::always_inline]] inline Real riccati_speed(Real s0, Real driven, Real coulomb, Real quadratic, double dt) {
    const Real gain = driven - s0 - dt * coulomb, x = dt * quadratic * gain, none = {};
    Real ratio = tangent_series(x);
    if constexpr (std::is_same_v<Real, double>) {
        if (!(abs(x) < kTangentSeries)) ratio = tangent_ratio(x);
    } else if (any(abs(x) >= kTangentSeries)) {
        for (int n = 0; n < 4; ++n)
            if (!(std::abs(x[n]) < kTangentSeries)) ratio[n] = tangent_ratio(x[n]);
    }
    const Real speed = max((s0 + gain * ratio) / (1.0 + dt * quadratic * s0 * ratio), none);
    return select((s0 + gain <= 0.0) | (ratio <= 0.0), none, speed);
}

/// THEORY (40): one step of  ds/dt = drive - f(s)  from s0 with f linear about the speed that backward Euler found: its
/// change times (1 + x) (1 - exp(-x)) / x, x = dt f'. Exact for linear friction, third order for any, for stiff
/// friction backward Euler itself; a steady speed stays, and what backward Euler stopped stays stopped. f' is taken two
/// thirds of the way, where the line has the mean of f over the step up to its third derivative. (Not the chord from
/// s0: where granular and yielding beds leave rest f is steep for a moment, and a small change of s0 would come out a
/// thousand times as large.) `slope`: f'(s) [1/s] at s > 0.
template <class Slope>
double relaxed_speed(double s0, double euler, double dt, const Slope& slope) {
    const double change = euler - s0;
    if (euler <= 0.0 || change == 0.0) return euler;
    const double x = dt * slope((s0 + 2.0 * euler) / 3.0);
    if (!(x > 0.0 && x < 1e300)) return euler;
    return std::max(s0 + change * (1.0 + x) * -std::expm1(-x) / x, 0.5 * euler);
}

/// Shares of the depth of a Bingham sheet: its plug (yield stress over bed stress) and the sheared rest, each to full
/// relative precision.
struct SheetShares { double plug, sheared; };

/// THEORY (43): the root z in (0, 1] of z^3 - (3 + b + d) z + 2 + b = 0, b, d >= 0 (Fois et al. 2024, eq. 5, corrected:
/// |v| = tau_B h / (6 mu) (2 + z)(1 - z)^2, then b = 0 and d = 6 mu |v| / (tau_Y h)). Near z = 1, where two roots meet,
/// Newton's method is slow and half the digits are lost; there it runs on y = 1 - z, which solves
/// 3 y^2 - y^3 + (b + d) y = d. Four steps reach round-off from starts that are right to 6 %.
inline SheetShares bingham_sheet(double b, double d) {
    if (!(d > 0.0)) return {1.0, 0.0};
    const double a = b + d;
    if (0.625 + 0.5 * a >= d) {  // y <= 1/2
        double y = 2.0 * d / (a + std::sqrt(a * a + 11.0 * d));
        for (int step = 0; step < 4; ++step) y -= (((3.0 - y) * y + a) * y - d) / ((6.0 - 3.0 * y) * y + a);
        return {1.0 - y, y};
    }
    double z = (2.0 + b) / (3.0 + a);
    for (int step = 0; step < 4; ++step) z -= ((z * z - (3.0 + a)) * z + 2.0 + b) / (3.0 * z * z - (3.0 + a));
    return {z, 1.0 - z};
}

template <class Real>
[[gnu::always_inline]] inline Real speed_after(const bed::None&, const BedStateOf<Real>&, Real, Real driven,
                                               double) {
    return driven;
}

/// THEORY (37)
template <class Real>
[[gnu::always_inline]] inline Real speed_after(const bed::Coulomb& law, const BedStateOf<Real>& bed, Real, Real driven,
                                               double dt) {
    const Real none = {};
    return max(driven - dt * law.mu * bed.normal_gravity, none);
}

/// tau = mu sigma_n + rho g |V|^2 / xi (Voellmy 1955), THEORY (39)
template <class Real>
[[gnu::always_inline]] inline Real speed_after(const bed::Voellmy& law, const BedStateOf<Real>& bed, Real s0,
                                               Real driven, double dt) {
    const Real quadratic = bed.gravity * bed.kappa / (law.xi * bed.thickness);
    return riccati_speed<Real>(s0, driven, law.mu * bed.normal_gravity, quadratic, dt);
}

/// tau = mu sigma_n + rho g n^2 |V|^2 / h^(1/3), THEORY (39)
inline double speed_after(const bed::Manning& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness;
    const double quadratic = bed.gravity * law.n * law.n * bed.kappa / (h * std::cbrt(h));
    return riccati_speed(s0, driven, law.mu * bed.normal_gravity, quadratic, dt);
}

/// Bingham sheet flow on the bed: backward Euler of the exact closure (bingham_sheet with the time step in b), made second
/// order by relaxed_speed. Yields exactly: no motion while the bed stress is below the yield stress. THEORY (41) to
/// (44).
inline double speed_after(const bed::Bingham& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness, coulomb = law.mu * bed.normal_gravity, left = driven - dt * coulomb;
    if (left <= 0.0) return 0.0;
    const double rate = 3.0 * law.viscosity / (bed.density * h * h);  // of a Newtonian sheet [1/s]
    if (law.yield_stress <= 0.0)
        return relaxed_speed(s0, left / (1.0 + rate * dt), dt, [&](double) { return rate; });
    const double yield = law.yield_stress / (bed.density * h * bed.kappa);  // deceleration of the plug [m/s^2]
    if (left <= dt * yield) return 0.0;
    if (law.viscosity <= 0.0) return left - dt * yield;
    const double scale = law.yield_stress * h / (6.0 * law.viscosity * bed.kappa);  // [m/s]
    const SheetShares after = bingham_sheet(2.0 * rate * dt, (left - dt * yield) / scale);
    const double euler = scale * (3.0 - after.sheared) * after.sheared * after.sheared / after.plug;
    return relaxed_speed(s0, euler, dt, [&](double s) {
        const double y = bingham_sheet(0.0, s / scale).sheared;
        return 0.5 * yield / (scale * std::max(y * (3.0 - (3.0 - y) * y), 1e-30));  // d(yield / plug) / ds
    });
}

/// mu(I) = mu_s + (mu_2 - mu_s) / (I0/I + 1), I = 5 d |V| / (2 h sqrt(phi g cos(th) h)) from Bagnold's profile
/// (Jop, Forterre and Pouliquen 2006, depth-averaged); backward Euler is the positive root of a quadratic.
/// THEORY (45) to (47).
inline double speed_after(const bed::Pouliquen& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness;
    const double slow = law.i0 * 0.4 * h * std::sqrt(law.solid_fraction * bed.gravity * bed.cosine * h) /
                        (law.grain_diameter * bed.kappa);  // speed at which I = I0 [m/s]
    const double rest = law.mu_s * bed.normal_gravity, rise = (law.mu_2 - law.mu_s) * bed.normal_gravity;
    const double left = driven - dt * rest;
    if (left <= 0.0) return 0.0;
    const double b = slow + dt * rise - left, root = std::sqrt(b * b + 4.0 * left * slow);
    const double euler = b > 0.0 ? 2.0 * left * slow / (b + root) : 0.5 * (root - b);
    return relaxed_speed(s0, euler, dt, [&](double s) { return rise * slow / ((s + slow) * (s + slow)); });
}

/// Four nodes at once by any law.
template <class Law>
[[gnu::always_inline]] inline Double4 speeds_after(const Law& law, const BedStateOf<Double4>& bed, Double4 s0,
                                                   Double4 driven, double dt) {
    if constexpr (std::is_same_v<Law, bed::None> || std::is_same_v<Law, bed::Coulomb> ||
                  std::is_same_v<Law, bed::Voellmy>) {
        return speed_after(law, bed, s0, driven, dt);
    } else {
        Double4 speed = {};
        for (int n = 0; n < 4; ++n)
            speed[n] = speed_after(law, BedState{bed.normal_gravity[n], bed.thickness[n], bed.kappa[n], bed.cosine[n],
                                                 bed.gravity, bed.density}, s0[n], driven[n], dt);
        return speed;
    }
}
template <class Law>
inline double speeds_after(const Law& law, const BedState& bed, double s0, double driven, double dt) {
    return speed_after(law, bed, s0, driven, dt);
}

}  // namespace frana
