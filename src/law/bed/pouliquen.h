#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// Granular friction mu(I) = mu_s + (mu_2 - mu_s) / (I0/I + 1), I = 5 d |V| / (2 h sqrt(phi g cos(th) h)) from Bagnold's
/// profile (Jop, Forterre and Pouliquen 2006, depth-averaged).
struct Pouliquen {
    double mu_s = 0.38;            ///< friction at I -> 0 [1]
    double mu_2 = 0.65;            ///< friction at I -> infinity [1]
    double i0 = 0.3;               ///< inertial number scale [1]
    double grain_diameter = 1e-3;  ///< [m]
    double solid_fraction = 0.6;   ///< [1]

    static constexpr const char* name = "pouliquen";
    static constexpr const char* is = "mu(I)";
    static std::vector<Key<Pouliquen>> keys() {
        using P = Pouliquen;
        Key<P> fastest{&P::mu_2, "mu_2", "1", ranges::above_to(0.0, 10.0), "friction of the fastest flow"};
        fastest.more_than = "mu_s";
        fastest.way_out = "mu_s is the friction of slow flow, mu_2 that of fast flow; correct one";
        return {{&P::mu_s, "mu_s", "1", ranges::above_to(0.0, 10.0), "friction of the slowest flow"},
                fastest,
                {&P::i0, "i0", "1", ranges::positive, "inertial number between slow and fast", Missing::usual},
                {&P::grain_diameter, "grain_diameter", "m", ranges::positive, "diameter of the grains"},
                {&P::solid_fraction,
                 "solid_fraction",
                 "1",
                 {0.0, 1.0, true, true},
                 "share of the volume that is grains",
                 Missing::usual}};
    }
    double friction_at_rest() const { return mu_s; }

    /// Backward Euler is the positive root of a quadratic. src/shallow/THEORY.md (45) to (47).
    double speed_after(const BedState& bed, double s0, double driven, double dt) const {
        const double h = bed.thickness;
        const double slow = i0 * 0.4 * h * std::sqrt(solid_fraction * bed.gravity * bed.cosine * h) /
                            (grain_diameter * bed.kappa);  // speed at which I = I0 [m/s]
        const double rest = mu_s * bed.normal_gravity, rise = (mu_2 - mu_s) * bed.normal_gravity;
        const double left = driven - dt * rest;
        if (left <= 0.0) return 0.0;
        const double b = slow + dt * rise - left, root = std::sqrt(b * b + 4.0 * left * slow);
        const double euler = b > 0.0 ? 2.0 * left * slow / (b + root) : 0.5 * (root - b);
        return relaxed_speed(s0, euler, dt, [&](double s) { return rise * slow / ((s + slow) * (s + slow)); });
    }
};

}  // namespace frana::bed
