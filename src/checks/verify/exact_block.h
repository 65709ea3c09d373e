#pragma once
// Blocks and infinite slabs on a plane: constant gravity, Coulomb friction, Voellmy's drag.
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// An infinite layer of constant thickness; all along the slope and normal to it. xi infinite: a Coulomb block.
struct Slab {
    double slope_deg, mu;
    double xi = std::numeric_limits<double>::infinity();  ///< Voellmy's turbulence coefficient [m/s^2]
    double thickness = 1.0;                               ///< [m]
    double gravity = 9.81;

    double drive() const;           ///< g (sin - mu cos) [m/s^2], 0 where friction holds
    double terminal() const;        ///< sqrt(xi h (sin - mu cos)) [m/s]
    double speed(double t) const;   ///< from rest: v_inf tanh(a t / v_inf)
    double travel(double t) const;  ///< v_inf^2 / a ln cosh(a t / v_inf)
    /// dv/dt = a - g v^2 / (xi h) and dx/dt = v by differences.
    std::vector<Residual> residuals() const;
};

/// Printed figures of blocks and slabs.
std::vector<Residual> published_blocks();

}  // namespace frana::verify
