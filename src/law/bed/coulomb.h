#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// tau = mu sigma_n
struct Coulomb {
    double mu = 0.0;  ///< tan(friction angle) [1]

    static constexpr const char* name = "coulomb";
    static constexpr const char* is = "";
    static std::vector<Key<Coulomb>> keys() { return {friction_angle(&Coulomb::mu), friction(&Coulomb::mu)}; }
    double friction_at_rest() const { return mu; }

    /// src/shallow/THEORY.md (37)
    template <class Real>
    [[gnu::always_inline]] Real speed_after(const BedStateOf<Real>& bed, Real, Real driven, double dt) const {
        const Real none = {};
        return max(driven - dt * mu * bed.normal_gravity, none);
    }
};

}  // namespace frana::bed
