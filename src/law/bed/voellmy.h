#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// tau = mu sigma_n + rho g |V|^2 / xi (Voellmy 1955). Number: double, or Double4 for four nodes that
/// differ.
template <class Number>
struct VoellmyOf {
    Number mu{};                    ///< [1]
    Number xi = Number{} + 1000.0;  ///< turbulence coefficient [m/s^2]

    static constexpr const char* name = "voellmy";
    static constexpr const char* is = "";
    static std::vector<Key<VoellmyOf>> keys() {
        return {
            friction_angle(&VoellmyOf::mu),
            friction(&VoellmyOf::mu),
            {&VoellmyOf::xi, "xi", "m/s^2", ranges::positive, "Voellmy's turbulence coefficient: larger runs faster"}};
    }
    Number friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (39)
    template <class Real>
    [[gnu::always_inline]] Real speed_after(const BedStateOf<Real>& bed, Real s0, Real driven, double dt) const {
        const Real quadratic = bed.gravity * bed.kappa / (xi * bed.thickness);
        return riccati_speed<Real>(s0, driven, mu * bed.normal_gravity, quadratic, dt);
    }
};
using Voellmy = VoellmyOf<double>;

}  // namespace frana::bed
