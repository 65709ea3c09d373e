#pragma once
// Uniform flow down a plane: Bingham and Newtonian sheets, and a granular sheet under mu(I) (Bagnold's profile).
// Thickness h is normal to the bed, z the distance from it, speeds are along the bed.
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// A sheet that shears where the shear stress rho g sin(th) (h - z) exceeds the yield stress. It is a plug above.
struct BinghamSheet {
    double density, viscosity, yield_stress;  ///< [kg/m^3], [Pa s], [Pa]; yield stress 0: Newtonian
    double slope;                             ///< [rad]
    double thickness;                         ///< [m]
    double g = 9.81;

    double plug() const;           ///< thickness that just stands, h_c = tau_Y / (rho g sin th) [m]
    double speed(double z) const;  ///< [m/s]
    /// (rho g sin th h^2 / (3 mu)) (1 - h_c/h)^2 (1 + h_c/(2h)); 0 when h <= h_c [m/s]
    double mean_speed() const;
    /// Mean of the profile, the law at a sheared place, and the published mean and surface speed.
    std::vector<Residual> residuals() const;
};

/// A granular sheet with mu(I) = mu_s + (mu_2 - mu_s) / (I0/I + 1) at every depth; I is then the same at every depth.
struct BagnoldSheet {
    bed::Pouliquen law;
    double slope;      ///< [rad], tan between mu_s and mu_2
    double thickness;  ///< [m]
    double g = 9.81;

    double inertial_number() const;
    double speed(double z) const;  ///< (2 I / (3 d)) sqrt(phi g cos th) (h^(3/2) - (h - z)^(3/2)) [m/s]
    double mean_speed() const;     ///< 3/5 of the surface's [m/s]
    std::vector<Residual> residuals() const;
};

}  // namespace frana::verify
