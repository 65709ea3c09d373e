#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// The flow's mass grows by the same share in each second: E = eps (rho / rho_b) h, so that m = m_0 exp(eps t). As Growth
/// at one speed. A parabolic cap stays one, which makes it the law of an exact answer.
struct Steady {
    double growth_per_second = 0.0;  ///< eps [1/s]

    static constexpr const char* name = "steady";
    static constexpr const char* is = "";
    static constexpr bool kProportional = true;
    static constexpr bool kSeesStress = false;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = false;
    static std::vector<laws::Key<Steady>> keys() {
        return {{&Steady::growth_per_second, "growth_per_second", "1/s", ranges::positive,
                 "share of its mass that the moving flow takes up in a second"}};
    }

    /// src/shallow/THEORY.md (68)
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        return s.density / s.bed_density * s.thickness * share_rate(s);
    }
    /// Share of its mass that the flow gains [1/s].
    template <class Real>
    [[gnu::always_inline]] Real share_rate(const StateOf<Real>&) const {
        return Real{} + growth_per_second;
    }
};

}  // namespace frana::erosion
