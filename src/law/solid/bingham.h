#pragma once
#include <cmath>

#include "law/solid/yield_stress.h"

namespace frana::solid {

/// src/solid3d/THEORY.md (17), (18): the same with a yield stress. Below it an elastic solid of shear modulus G, above it
/// Bingham's fluid. The viscous flow is solved in the step, so that any viscosity is stable and material at rest really
/// rests.
struct Bingham {
    static constexpr const char* name = "bingham";
    static std::vector<Key> keys() {
        return {solid::viscosity(), solid::yield_stress(), shear_modulus(), solid::sound_speed()};
    }
    static Bingham of(const Values& value) {
        const double yield_stress = value("yield_stress").value_or(0.0);
        return {0.0, value("shear_modulus").value_or(kStiff * yield_stress), value("viscosity").value_or(0.0),
                yield_stress};
    }
    static constexpr int kStates = 6;  ///< deviatoric stress [Pa]
    static constexpr bool kAverages = true;
    double bulk = 1.0;          ///< K [Pa]
    double shear = 1.0;         ///< G [Pa]; a hundred yield stresses are stiff enough
    double viscosity = 0.0;     ///< [Pa s]
    double yield_stress = 0.0;  ///< tau_Y [Pa], of sqrt(s:s / 2)

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>&) const {
        return stress_in(j, state, bulk);
    }
    /// Elastic trial, then flow: of the stress beyond the yield stress what a viscous element in series
    /// leaves after dt.
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const SymOf<Real> trial = elastic_trial<Real>(d, j, state, shear);
        const double relaxation = viscosity / (shear * d.dt);
        const Real size = trial.norm() * std::sqrt(0.5), divisor = select(size > 0.0, size, Real{} + 1.0);
        const Real left = (size * relaxation + yield_stress) / ((1.0 + relaxation) * divisor);
        (trial * select(size > yield_stress, left, Real{} + 1.0)).deviator().write(state);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return stored_in(j, SymOf<Real>::read(state), bulk, shear);
    }
    double sound_speed(double density) const { return sound_speed_in(bulk, shear, density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
