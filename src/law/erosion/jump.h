#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// The flow's base drags with more than the bed can bear (Fraccarollo and Capart 2002, J. Fluid Mech. 461; Medina et
/// al. 2008, Landslides 5). The excess goes into what is set in motion: E = (tau - tau_c) / (rho u).
struct Jump {
    double threshold = 1000.0;  ///< tau_c [Pa]

    static constexpr const char* name = "jump";
    static constexpr const char* is = "";
    static constexpr bool kProportional = false;
    static constexpr bool kSeesStress = true;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Jump>> keys() {
        return {{&Jump::threshold, "threshold", "Pa", ranges::not_negative, "basal stress up to which the bed resists",
                 laws::Missing::usual}};
    }

    /// src/shallow/THEORY.md (71)
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        return max(s.stress - max(s.bears, Real{} + threshold), Real{}) / (s.density * s.speed);
    }
};

}  // namespace frana::erosion
