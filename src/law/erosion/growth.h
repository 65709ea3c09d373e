#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// The flow's mass grows by the same share on each metre of its way (Hungr 1995, Can. Geotech. J. 32; McDougall and
/// Hungr 2005, 42): E = E_s (rho / rho_b) h u, so that m = m_0 exp(E_s s).
struct Growth {
    double growth = 0.0;  ///< E_s [1/m]

    static constexpr const char* name = "growth";
    static constexpr const char* is = "";
    static constexpr bool kProportional = true;  ///< E grows as the depth does: the step is exact by an exponential
    static constexpr bool kSeesStress = false;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Growth>> keys() {
        return {{&Growth::growth, "growth", "1/m", ranges::positive,
                 "share of its mass that the flow takes up on a metre of its way along the bed"}};
    }

    /// src/shallow/THEORY.md (67)
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        return s.density / s.bed_density * s.thickness * share_rate(s);
    }
    /// Share of its mass that the flow gains [1/s].
    template <class Real>
    [[gnu::always_inline]] Real share_rate(const StateOf<Real>& s) const {
        return growth * s.speed;
    }
};

}  // namespace frana::erosion
