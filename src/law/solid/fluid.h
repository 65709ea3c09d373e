#pragma once
#include <cmath>

#include "law/solid/deformation.h"
#include "law/solid/key.h"

namespace frana::solid {

/// src/solid3d/THEORY.md (16): weakly compressible fluid, p = K (1 - J), never tension (J is cut at 1). Newtonian
/// viscosity.
struct Fluid {
    static constexpr const char* name = "fluid";
    static std::vector<Key> keys() { return {solid::viscosity(), solid::sound_speed()}; }
    static Fluid of(const Values& value) { return {0.0, value("viscosity").value_or(0.0)}; }
    static constexpr int kStates = 0;
    static constexpr bool kAverages = true;
    double bulk = 1.0;       ///< K [Pa]
    double viscosity = 0.0;  ///< [Pa s]

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>*, const Square<Real>& gradient) const {
        return (SymOf<Real>::of(gradient).deviator() * (Real{} + 2.0 * viscosity))
                   .plus_isotropic(-bulk * max(1.0 - j, Real{})) *
               j;
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>*) const {
        j = min(j * (1.0 + d.dt * trace<Real>(d.gradient)), Real{} + 1.0);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>*) const {
        const Real pressed = max(1.0 - j, Real{});
        return 0.5 * bulk * pressed * pressed;
    }
    double sound_speed(double density) const { return std::sqrt(bulk / density); }
    double explicit_viscosity() const { return viscosity; }
};

}  // namespace frana::solid
