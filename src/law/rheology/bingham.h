#pragma once
#include <type_traits>
#include <vector>

#include "law/key.h"
#include "law/rheology/strain_state.h"

namespace frana::rheology {

/// src/shallow/THEORY.md (25): plug share of a Bingham sheet whose bed is braked by nothing else, to absolute round-off
/// (bingham_sheet, b = 0). y = 1 - plug solves 3 y^2 - y^3 + d (y - 1) = 0. Convex and rising for y < 1; two steps of
/// Halley's method from a start that is right to 5 % leave 2e-17.
template <class Real>
[[gnu::always_inline]] inline Real plug_share(Real d) {
    d = min(d, Real{} + 1e100);  // squares must not overflow
    Real y = 2.0 * d / (d + sqrt(d * d + 11.0 * d) + 1e-300);
    for (int step = 0; step < 2; ++step) {
        const Real f = ((3.0 - y) * y + d) * y - d, slope = (6.0 - 3.0 * y) * y + d;
        y -= f * slope / (slope * slope - f * (3.0 - 3.0 * y) + 1e-300);
    }
    return 1.0 - y;
}

/// A viscous fluid that yields. Number: double, or Double4 for four points that differ.
template <class Number>
struct BinghamOf {
    Number viscosity{};     ///< [Pa s]
    Number yield_stress{};  ///< [Pa]

    static constexpr const char* name = "bingham";
    static constexpr const char* is = "";
    static std::vector<laws::Key<BinghamOf>> keys() {
        return {{&BinghamOf::viscosity, "viscosity", "Pa s", ranges::not_negative, "viscosity"},
                {&BinghamOf::yield_stress, "yield_stress", "Pa", ranges::not_negative,
                 "stress below which the mass does not flow"}};
    }

    /// src/shallow/THEORY.md (23), (24): sigma = (2 mu + tau_Y / sqrt(I2 + floor^2)) eps (Fois et al. 2024, eq. 3,
    /// corrected). I2 holds the plane strain rate, its incompressible vertical part, and the shear across the bed. That
    /// is 3/(2 + zeta) V/T, of a Bingham sheet (eq. 4). Where nothing yields it is Newton's.
    template <class Real>
    [[gnu::always_inline]] PlaneOf<Real> stress(const StrainState<Real>& s) const {
        const auto yields = yield_stress > 0.0;
        if (!any(yields)) return viscous_stress(viscosity, s);
        const Number yield = select(yields, yield_stress, Number{} + 1.0);
        // I2 + floor^2 times (2 + zeta)^2: a division less.
        const Real two_zeta = 2.0 + plug_share(6.0 * viscosity / yield * s.shear), shear = 3.0 * s.shear;
        const Real zz = s.rate.xx + s.rate.yy;
        const Real plane =
            0.5 * (s.rate.xx * s.rate.xx + s.rate.yy * s.rate.yy + zz * zz) + s.rate.xy * s.rate.xy + s.floor * s.floor;
        const Real i2 = two_zeta * two_zeta * plane + 0.25 * shear * shear;
        const Real viscous = 2.0 * viscosity + yield * two_zeta / sqrt(i2);
        const Real whole = min(viscous, Real{} + s.cap);
        if constexpr (std::is_same_v<Number, double>)
            return scaled(s.rate, whole);
        else
            return scaled(s.rate, select(yields, whole, min(2.0 * viscosity, Real{} + s.cap)));
    }
};
using Bingham = BinghamOf<double>;

}  // namespace frana::rheology
