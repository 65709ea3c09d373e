#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// tau = mu sigma_n + rho g |V|^2 / xi (Voellmy 1955)
struct Voellmy {
    double mu = 0.0;     ///< [1]
    double xi = 1000.0;  ///< turbulence coefficient [m/s^2]

    static constexpr const char* name = "voellmy";
    static constexpr const char* is = "";
    static std::vector<Key<Voellmy>> keys() {
        return {
            friction_angle(&Voellmy::mu),
            friction(&Voellmy::mu),
            {&Voellmy::xi, "xi", "m/s^2", ranges::positive, "Voellmy's turbulence coefficient: larger runs faster"}};
    }
    double friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (39)
    template <class Real>
    [[gnu::always_inline]] Real speed_after(const BedStateOf<Real>& bed, Real s0, Real driven, double dt) const {
        const Real quadratic = bed.gravity * bed.kappa / (xi * bed.thickness);
        return riccati_speed<Real>(s0, driven, mu * bed.normal_gravity, quadratic, dt);
    }
};

}  // namespace frana::bed
