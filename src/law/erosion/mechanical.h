#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// Flow and bed slide on one another with the shear velocity of a stress. It is the stress that friction in the bed
/// does not hold (Pudasaini and Fischer 2020; Pudasaini and Krautblatter 2021, Nat. Commun. 12). The bed that goes has
/// 1 / (1 + rho_b / rho) of the flow's speed. E = nu sqrt((tau - rho_b mu_b g_n h) / (rho - rho_b / (1 + rho_b / rho))).
/// That is the second model of r.avaflow for one phase, as its program of January 2023 has it, by an author of both
/// papers. The papers' own text was not at hand. Its branch of deposition is left out: E >= 0. tau is of the run's bed
/// law; Coulomb friction is theirs.
struct Mechanical {
    double bed_friction = 0.0;    ///< mu_b [1]
    double shear_velocity = 1.0;  ///< nu, E over the shear velocity [1]

    static constexpr const char* name = "mechanical";
    static constexpr const char* is = "";
    static constexpr bool kProportional = false;
    static constexpr bool kSeesStress = true;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Mechanical>> keys() {
        return {
            {&Mechanical::bed_friction, "bed_friction", "1", ranges::positive,
             "friction coefficient inside of the bed, which holds it back"},
            {&Mechanical::shear_velocity, "shear_velocity", "1", ranges::positive,
             "speed at which the bed sinks, over the shear velocity of the stress that the bed does not hold, up to "
             "the flow's speed: with 1 the bed sinks at metres a second under a metre of flow; checks of this "
             "program have 0.03 to 0.1; it is cvshear in r.avaflow, whose papers' values are not known here",
             laws::Missing::usual}};
    }

    /// src/shallow/THEORY.md, section 18
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        const Real held = s.bed_density * bed_friction * s.normal_gravity * s.thickness;
        const double inertia = s.density * s.density / (s.density + s.bed_density);
        return shear_velocity * sqrt(max(s.stress - max(s.bears, held), Real{}) / inertia);
    }
};

}  // namespace frana::erosion
