#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// Friction's work loosens the bed, which needs the energy e_b for each kilogram (AvaFrame's com1DFA): rho_b E = tau u / e_b.
struct Energy {
    double energy = 5000.0;  ///< e_b [J/kg]

    static constexpr const char* name = "energy";
    static constexpr const char* is = "";
    static constexpr bool kProportional = false;
    static constexpr bool kSeesStress = true;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Energy>> keys() {
        return {{&Energy::energy, "energy", "J/kg", ranges::positive,
                 "work of friction that loosens a kilogram of the bed", laws::Missing::usual}};
    }

    /// src/shallow/THEORY.md (70)
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        return s.stress * s.speed / (s.bed_density * energy);
    }
};

}  // namespace frana::erosion
