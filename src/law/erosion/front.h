#pragma once
#include <vector>

#include "law/erosion/state.h"
#include "law/key.h"

namespace frana::erosion {

/// The flow ploughs: each column takes what lies in the strip, as wide as the column, that it goes over (after the
/// entrainment at the front of AvaFrame's com1DFA): E = e u / sqrt(A), e the depth that is left and A the column's area. So a
/// layer goes within some columns of the front, and the mass grows by what lies on the way: m = m_0 + l s.
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
    Real rate(const StateOf<Real>& s) const {
        return s.left * s.speed / s.edge;
    }
};

}  // namespace frana::erosion
