#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// tau = mu sigma_n + rho g n^2 |V|^2 / h^(1/3)
struct Manning {
    double n = 0.03;  ///< roughness [s/m^(1/3)]
    double mu = 0.0;  ///< [1]

    static constexpr const char* name = "manning";
    static constexpr const char* is = "";
    static std::vector<Key<Manning>> keys() {
        return {friction_angle(&Manning::mu, Missing::none),
                friction(&Manning::mu, Missing::none),
                {&Manning::n, "manning_n", "s/m^(1/3)", ranges::above_to(0.0, 1.0), "Manning's roughness"}};
    }
    double friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (39)
    double speed_after(const BedState& bed, double s0, double driven, double dt) const {
        const double h = bed.thickness;
        const double quadratic = bed.gravity * n * n * bed.kappa / (h * std::cbrt(h));
        return riccati_speed(s0, driven, mu * bed.normal_gravity, quadratic, dt);
    }
};

}  // namespace frana::bed
