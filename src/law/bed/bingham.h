#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// Shares of the depth of a Bingham sheet, each to full relative precision. They are its plug (yield stress over bed
/// stress) and the sheared rest.
struct SheetShares {
    double plug, sheared;
};

/// src/shallow/THEORY.md (43): the root z in (0, 1] of z^3 - (3 + b + d) z + 2 + b = 0, b, d >= 0 (Fois et al. 2024,
/// eq. 5, corrected). It follows from |v| = tau_B h / (6 mu) (2 + z)(1 - z)^2, then b = 0 and d = 6 mu |v| / (tau_Y h).
/// Near z = 1, where two roots meet, Newton's method is slow and half the digits are lost. There it runs on y = 1 - z,
/// which solves 3 y^2 - y^3 + (b + d) y = d. Four steps reach round-off from starts that are right to 6 %.
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

/// A sheet of a Bingham fluid that shears at the bed below a plug, over Coulomb friction.
struct Bingham {
    double viscosity = 0.0;     ///< [Pa s]
    double yield_stress = 0.0;  ///< [Pa]
    double mu = 0.0;            ///< [1]

    static constexpr const char* name = "bingham";
    static constexpr const char* is = "";
    static std::vector<Key<Bingham>> keys() {
        return {friction_angle(&Bingham::mu, Missing::none),
                friction(&Bingham::mu, Missing::none),
                {&Bingham::viscosity, "viscosity", "Pa s", ranges::positive, "viscosity of the sheared layer"},
                {&Bingham::yield_stress, "yield_stress", "Pa", ranges::not_negative,
                 "stress below which the layer does not shear"}};
    }
    double friction_at_rest() const { return mu; }

    /// Backward Euler of the exact closure (bingham_sheet with the time step in b), made second order by relaxed_speed.
    /// Yields exactly: no motion while the bed stress is below the yield stress. THEORY (41) to (44).
    double speed_after(const BedState& bed, double s0, double driven, double dt) const {
        const double h = bed.thickness, coulomb = mu * bed.normal_gravity, left = driven - dt * coulomb;
        if (left <= 0.0) return 0.0;
        const double rate = 3.0 * viscosity / (bed.density * h * h);  // of a Newtonian sheet [1/s]
        if (yield_stress <= 0.0) return relaxed_speed(s0, left / (1.0 + rate * dt), dt, [&](double) { return rate; });
        const double yield = yield_stress / (bed.density * h * bed.kappa);  // deceleration of the plug [m/s^2]
        if (left <= dt * yield) return 0.0;
        if (viscosity <= 0.0) return left - dt * yield;
        const double scale = yield_stress * h / (6.0 * viscosity * bed.kappa);  // [m/s]
        const SheetShares after = bingham_sheet(2.0 * rate * dt, (left - dt * yield) / scale);
        const double euler = scale * (3.0 - after.sheared) * after.sheared * after.sheared / after.plug;
        return relaxed_speed(s0, euler, dt, [&](double s) {
            const double y = bingham_sheet(0.0, s / scale).sheared;
            return 0.5 * yield / (scale * std::max(y * (3.0 - (3.0 - y) * y), 1e-30));  // d(yield / plug) / ds
        });
    }
};

}  // namespace frana::bed
