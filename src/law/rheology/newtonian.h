#pragma once
#include <vector>

#include "law/key.h"
#include "law/rheology/strain_state.h"

namespace frana::rheology {

/// A viscous fluid. Number: double, or Double4 for four points that differ.
template <class Number>
struct NewtonianOf {
    Number viscosity{};  ///< [Pa s]

    static constexpr const char* name = "newtonian";
    static constexpr const char* is = "";
    static std::vector<laws::Key<NewtonianOf>> keys() {
        return {{&NewtonianOf::viscosity, "viscosity", "Pa s", ranges::not_negative, "viscosity"}};
    }

    template <class Real>
    [[gnu::always_inline]] PlaneOf<Real> stress(const StrainState<Real>& s) const {
        return viscous_stress(viscosity, s);
    }
};
using Newtonian = NewtonianOf<double>;

}  // namespace frana::rheology
