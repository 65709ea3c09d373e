#pragma once
#include <vector>

#include "law/key.h"
#include "law/rheology/strain_state.h"

namespace frana::rheology {

/// A viscous fluid.
struct Newtonian {
    double viscosity = 0.0;  ///< [Pa s]

    static constexpr const char* name = "newtonian";
    static constexpr const char* is = "";
    static std::vector<laws::Key<Newtonian>> keys() {
        return {{&Newtonian::viscosity, "viscosity", "Pa s", ranges::not_negative, "viscosity"}};
    }

    template <class Real>
    [[gnu::always_inline]] PlaneOf<Real> stress(const StrainState<Real>& s) const {
        return viscous_stress(viscosity, s);
    }
};

}  // namespace frana::rheology
