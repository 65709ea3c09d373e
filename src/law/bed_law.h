#pragma once
// Bed friction: for each law the exact or implicit solution of one time step. A law only ever slows a node down;
// it may stop it, it never turns it round, and a node at rest stays at rest to the last bit until driven hard enough.
#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace frana {

/// What a bed law sees of a node.
struct BedState {
    double normal_gravity;  ///< N / kappa: normal force per mass, over |V|/|v| [m/s^2]
    double thickness;       ///< normal to the bed, > 0 [m]
    double kappa;           ///< |V|/|v|, speed along the bed over speed along the map [1]
    double cosine;          ///< cosine of the bed's slope [1]
    double gravity;         ///< [m/s^2]
    double density;         ///< [kg/m^3]
};

/// One step of  ds/dt = drive - coulomb - quadratic s^2, exactly (Riccati). `s0`: speed at the start along the
/// driven direction, `driven`: speed that the drive alone would give at the end. Returns the speed after dt >= 0.
/// The drive is taken constant over the step: terminal speeds are exact, any dt is stable.
inline double riccati_speed(double s0, double driven, double coulomb, double quadratic, double dt) {
    const double net = (driven - s0) / dt - coulomb;  // drive less Coulomb [m/s^2]
    if (net * dt + s0 <= 0.0) return 0.0;
    if (quadratic == 0.0) return s0 + net * dt;
    const double rate = std::sqrt(std::abs(net) * quadratic) * dt;
    if (rate < 1e-9) return std::max(0.0, (s0 + net * dt) / (1.0 + quadratic * s0 * dt));
    const double scale = std::sqrt(std::abs(net) / quadratic);
    if (net > 0.0) {
        const double t = std::tanh(rate);
        return scale * (s0 + scale * t) / (scale + s0 * t);
    }
    if (rate >= 1.5) return 0.0;  // tan: at rest before a quarter period is over
    const double t = std::tan(rate);
    return std::max(0.0, scale * (s0 - scale * t) / (scale + s0 * t));
}

/// One step of  ds/dt = drive - f(s)  from s0 with f linear between s0 and the speed that backward Euler found:
/// its change times (1 + x) (1 - exp(-x)) / x, x = dt times the slope of f. Exact for linear friction, second order for
/// any, for stiff friction backward Euler itself; a steady speed stays, and what backward Euler stopped stays stopped.
/// `before`: f(s0) [m/s^2]; `driven`: s0 + dt drive [m/s].
inline double relaxed_speed(double s0, double euler, double driven, double before, double dt) {
    const double change = euler - s0;
    if (euler <= 0.0 || change == 0.0) return euler;
    const double x = (driven - euler - dt * before) / change;
    if (!(x > 0.0)) return euler;
    const double speed = s0 + change * (1.0 + x) * -std::expm1(-x) / x;
    return speed > 0.0 ? speed : euler;
}

/// Shares of the depth of a Bingham sheet: its plug (yield stress over bed stress) and the sheared rest, each to full
/// relative precision.
struct SheetShares { double plug, sheared; };

/// The root z in (0, 1] of z^3 - (3 + b + d) z + 2 + b = 0, b, d >= 0 (Fois et al. 2024, eq. 5, corrected:
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

inline double speed_after(const bed::None&, const BedState&, double, double driven, double) { return driven; }

inline double speed_after(const bed::Coulomb& law, const BedState& bed, double s0, double driven, double dt) {
    return riccati_speed(s0, driven, law.mu * bed.normal_gravity, 0.0, dt);
}

/// tau = mu sigma_n + rho g |V|^2 / xi (Voellmy 1955)
inline double speed_after(const bed::Voellmy& law, const BedState& bed, double s0, double driven, double dt) {
    const double quadratic = bed.gravity * bed.kappa / (law.xi * bed.thickness);
    return riccati_speed(s0, driven, law.mu * bed.normal_gravity, quadratic, dt);
}

/// tau = mu sigma_n + rho g n^2 |V|^2 / h^(1/3)
inline double speed_after(const bed::Manning& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness;
    const double quadratic = bed.gravity * law.n * law.n * bed.kappa / (h * std::cbrt(h));
    return riccati_speed(s0, driven, law.mu * bed.normal_gravity, quadratic, dt);
}

/// Bingham sheet flow on the bed: backward Euler of the exact closure (bingham_sheet with the time step in b), made second
/// order by relaxed_speed. Yields exactly: no motion while the bed stress is below the yield stress.
inline double speed_after(const bed::Bingham& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness, coulomb = law.mu * bed.normal_gravity, left = driven - dt * coulomb;
    if (left <= 0.0) return 0.0;
    const double rate = 3.0 * law.viscosity / (bed.density * h * h);  // of a Newtonian sheet [1/s]
    if (law.yield_stress <= 0.0)
        return relaxed_speed(s0, left / (1.0 + rate * dt), driven, coulomb + rate * s0, dt);
    const double yield = law.yield_stress / (bed.density * h * bed.kappa);  // deceleration of the plug [m/s^2]
    if (left <= dt * yield) return 0.0;
    if (law.viscosity <= 0.0) return left - dt * yield;
    const double scale = law.yield_stress * h / (6.0 * law.viscosity * bed.kappa);  // [m/s]
    const SheetShares after = bingham_sheet(2.0 * rate * dt, (left - dt * yield) / scale);
    const double euler = scale * (3.0 - after.sheared) * after.sheared * after.sheared / after.plug;
    return relaxed_speed(s0, euler, driven, coulomb + yield / bingham_sheet(0.0, s0 / scale).plug, dt);
}

/// mu(I) = mu_s + (mu_2 - mu_s) / (I0/I + 1), I = 5 d |V| / (2 h sqrt(phi g cos(th) h)) from Bagnold's profile
/// (Jop, Forterre and Pouliquen 2006, depth-averaged); backward Euler is the positive root of a quadratic.
inline double speed_after(const bed::Pouliquen& law, const BedState& bed, double s0, double driven, double dt) {
    const double h = bed.thickness;
    const double slow = law.i0 * 0.4 * h * std::sqrt(law.solid_fraction * bed.gravity * bed.cosine * h) /
                        (law.grain_diameter * bed.kappa);  // speed at which I = I0 [m/s]
    const double rest = law.mu_s * bed.normal_gravity, rise = (law.mu_2 - law.mu_s) * bed.normal_gravity;
    const double left = driven - dt * rest;
    if (left <= 0.0) return 0.0;
    const double b = slow + dt * rise - left, root = std::sqrt(b * b + 4.0 * left * slow);
    const double euler = b > 0.0 ? 2.0 * left * slow / (b + root) : 0.5 * (root - b);
    return relaxed_speed(s0, euler, driven, rest + rise * s0 / (s0 + slow), dt);
}

}  // namespace frana
