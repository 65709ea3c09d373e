#pragma once
// What yield-stress fluids share.
#include "law/solid/deformation.h"

namespace frana::solid {

/// Of a yield-stress fluid: what it is pressed, and its deviatoric stress, s : s / (4 G).
template <class Real>
[[gnu::always_inline]] inline Real stored_in(Real j, const SymOf<Real>& s, double bulk, double shear) {
    const Real pressed = max(1.0 - j, Real{});
    return 0.5 * bulk * pressed * pressed + 0.25 / shear * j * contracted(s, s);
}

}  // namespace frana::solid
