#pragma once
// A slab in a forest, on a plane with friction that leaves it an even acceleration (Feistl et al. 2014).
#include "checks/verify/exact_erosion.h"

namespace frana::verify {

/// u = u0 + a t, rho dh/dt = -K/u. Lengths run along the slope and normal to it.
struct DetrainedSlab {
    double speed = 20.0, acceleration = -0.5;  ///< at the start [m/s]; [m/s^2]
    double density = 300.0, pressure = 50.0;   ///< [kg/m^3]; K [Pa]
    double thickness = 2.0;                    ///< at the start [m]

    /// h = h0 - K/(rho a) ln(u/u0).
    SlabState at(double t) const;
};

/// Its equation, and a published figure.
std::vector<Residual> detrained_slab_residuals();

}  // namespace frana::verify
