#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// The flow ploughs (after the entrainment at the front of AvaFrame's com1DFA). Each particle takes what lies in the
/// strip that it goes over, as wide as the particle. E = e u / sqrt(A), e the depth that is left and A the particle's
/// area. So a layer is taken within some widths of a particle from the front. The mass grows by what lies on the way:
/// m = m_0 + l s.
struct Front {
    static constexpr const char* name = "front";
    static constexpr const char* is = "";
    static constexpr bool kProportional = false;
    static constexpr bool kSeesStress = false;
    static constexpr bool kSeesEroded = false;
    static constexpr bool kSeesLeft = true;
    static std::vector<laws::Key<Front>> keys() { return {}; }

    /// src/shallow/THEORY.md, section 18
    template <class Real>
    [[gnu::always_inline]] Real rate(const StateOf<Real>& s) const {
        return s.left * s.speed / s.edge;
    }
};

}  // namespace frana::erosion
