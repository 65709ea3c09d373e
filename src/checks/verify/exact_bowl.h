#pragma once
// Water that swings without friction in parabolic bowls, shorelines included (Thacker 1981): exact solutions of the
// shallow-water equations.
#include <functional>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// Depth [m] and velocity [m/s]; beyond the shoreline the formula of the depth goes on below zero.
struct BowlState {
    double depth, u, v;
};

/// A swing in the square [0, 4 m]^2, or in the strip [0, 4 m] x [0, 1 m], about x = 2 m.
struct Bowl {
    double width = 4.0;   ///< in y [m]
    bool round = false;   ///< unchanged when turned about the middle
    double period = 0.0;  ///< [s]
    double volume = 0.0;  ///< [m^3]
    double swing = 0.0;   ///< total energy above that of the same water at rest, over its density [m^5/s^2]
    Function bed, rest;   ///< elevation [m]; depth of the same water at rest [m]
    std::function<BowlState(double x, double y, double t)> at;
    std::function<double(double t)> centre_x;  ///< of mass [m]
    std::vector<Residual> published;           ///< numbers printed in the literature, less ours
};

Bowl planar_bowl();       ///< the surface stays a plane and turns
Bowl radial_bowl();       ///< the surface stays a paraboloid and breathes
Bowl parabolic_trough();  ///< the planar swing in one dimension

/// Differential equations by differences of the fourth order, volume and energy by quadrature, published numbers.
std::vector<Residual> residuals_of(const Bowl& bowl);

}  // namespace frana::verify
