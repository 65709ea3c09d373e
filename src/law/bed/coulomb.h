#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// tau = mu sigma_n. Number: double, or Double4 for four nodes that differ.
template <class Number>
struct CoulombOf {
    Number mu{};  ///< tan(friction angle) [1]

    static constexpr const char* name = "coulomb";
    static constexpr const char* is = "";
    static std::vector<Key<CoulombOf>> keys() { return {friction_angle(&CoulombOf::mu), friction(&CoulombOf::mu)}; }
    Number friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (37)
    template <class Real>
    [[gnu::always_inline]] Real speed_after(const BedStateOf<Real>& bed, Real, Real driven, double dt) const {
        const Real none = {};
        return max(driven - dt * mu * bed.normal_gravity, none);
    }
};
using Coulomb = CoulombOf<double>;

}  // namespace frana::bed
