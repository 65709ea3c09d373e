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

/// The root in (0, 1] of z^3 - (3 + a) z + 2 + b = 0 with 0 <= b < a (or a = b = 0): yield stress over bed stress of a
/// Bingham sheet (Fois et al. 2024, eq. 5, corrected: |v| = tau_B h / (6 mu) (2 + z)(1 - z)^2). Newton from the
/// left is monotone since the cubic is convex there.
inline double bingham_zeta(double a, double b) {
    double z = (2.0 + b) / (3.0 + a);
    for (int iteration = 0; iteration < 60; ++iteration) {
        const double value = (z * z - (3.0 + a)) * z + 2.0 + b, slope = 3.0 * z * z - (3.0 + a);
        if (!(value > 0.0) || !(slope < 0.0)) break;
        const double next = z - value / slope;
        if (next <= z) break;
        z = next;
    }
    return std::min(z, 1.0);
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

/// Bingham sheet flow on the bed, backward Euler of the exact closure: the cubic of bingham_zeta with the time
/// step in its constant term. Yields exactly: no motion while the bed stress is below the yield stress.
inline double speed_after(const bed::Bingham& law, const BedState& bed, double, double driven, double dt) {
    const double h = bed.thickness, left = driven - dt * law.mu * bed.normal_gravity;
    if (left <= 0.0) return 0.0;
    const double relax = dt / (bed.density * h * h);
    if (law.yield_stress <= 0.0) return left / (1.0 + 3.0 * law.viscosity * relax);
    const double yield_speed = dt * law.yield_stress / (bed.density * h * bed.kappa);
    if (left <= yield_speed) return 0.0;
    if (law.viscosity <= 0.0) return left - yield_speed;
    const double zeta = bingham_zeta(6.0 * law.viscosity * bed.kappa * left / (law.yield_stress * h),
                                     6.0 * law.viscosity * relax);
    return std::max(0.0, left - yield_speed / zeta);
}

/// mu(I) = mu_s + (mu_2 - mu_s) / (I0/I + 1), I = 5 d |V| / (2 h sqrt(phi g cos(th) h)) from Bagnold's profile
/// (Jop, Forterre and Pouliquen 2006, depth-averaged); backward Euler, the positive root of a quadratic.
inline double speed_after(const bed::Pouliquen& law, const BedState& bed, double, double driven, double dt) {
    const double h = bed.thickness;
    const double slow = law.i0 * 0.4 * h * std::sqrt(law.solid_fraction * bed.gravity * bed.cosine * h) /
                        (law.grain_diameter * bed.kappa);  // speed at which I = I0 [m/s]
    const double left = driven - dt * law.mu_s * bed.normal_gravity;
    if (left <= 0.0) return 0.0;
    const double b = slow + dt * (law.mu_2 - law.mu_s) * bed.normal_gravity - left;
    const double root = std::sqrt(b * b + 4.0 * left * slow);
    return b > 0.0 ? 2.0 * left * slow / (b + root) : 0.5 * (root - b);
}

}  // namespace frana
