#pragma once
#include <cmath>

#include "law/solid/yield_stress.h"

namespace frana::solid {

/// src/solid3d/THEORY.md (19): Herschel and Bulkley's fluid, as Bingham's above. But beyond the yield stress tau = tau_Y +
/// K rate^n: mud thins with shear, n < 1. In pure shear of rate gamma: tau = tau_Y + K gamma^n.
struct HerschelBulkley {
    static constexpr const char* name = "herschel_bulkley";
    static std::vector<Key> keys() {
        return {
            {"consistency", "Pa s^n", ranges::positive, "K of herschel_bulkley: tau = yield_stress + K rate^exponent"},
            {"exponent", "1", ranges::above_to(0.0, 2.0), "n of herschel_bulkley, below one for what thins with shear"},
            solid::yield_stress(),
            shear_modulus(),
            solid::sound_speed()};
    }
    static HerschelBulkley of(const Values& value) {
        const double yield_stress = value("yield_stress").value_or(0.0);
        return {0.0, value("shear_modulus").value_or(kStiff * yield_stress), *value("consistency"), *value("exponent"),
                yield_stress};
    }
    static constexpr int kStates = 6;  ///< deviatoric stress [Pa]
    static constexpr bool kAverages = true;
    double bulk = 1.0;          ///< [Pa]
    double shear = 1.0;         ///< G [Pa]; a hundred yield stresses are stiff enough
    double consistency = 1.0;   ///< K [Pa s^n]
    double exponent = 1.0;      ///< n [1]
    double yield_stress = 0.0;  ///< tau_Y [Pa], of sqrt(s:s / 2)

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>&) const {
        return stress_in(j, state, bulk);
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const SymOf<Real> trial = elastic_trial<Real>(d, j, state, shear);
        const Real size = trial.norm() * std::sqrt(0.5), over = max(size - yield_stress, Real{});
        if (!any(over > 0.0)) return trial.deviator().write(state);
        const Real left = (yield_stress + left_of(over, d.dt)) / select(size > 0.0, size, Real{} + 1.0);
        (trial * select(size > yield_stress, left, Real{} + 1.0)).deviator().write(state);
    }
    /// What flow leaves after dt of a stress beyond the yield stress, s + G dt (s / K)^(1/n) = over. It is the trial's
    /// stress less what relaxes at the end's rate [Pa].
    double left_of(double over, double dt) const;
    [[gnu::always_inline]] Double4 left_of(const Double4& over, double dt) const {
        return Double4{left_of(over[0], dt), left_of(over[1], dt), left_of(over[2], dt), left_of(over[3], dt)};
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return stored_in(j, SymOf<Real>::read(state), bulk, shear);
    }
    double sound_speed(double density) const { return sound_speed_in(bulk, shear, density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
