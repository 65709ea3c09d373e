#pragma once
// A viscous sheet of constant volume that spreads under its own weight (Huppert 1982, J. Fluid Mech. 121; Nature 300).
// dh/dt = (g / (3 nu)) div(h^3 grad h). It is the law of a Newtonian sheet whose friction is 3 mu u / h and without
// inertia.
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// Between a wall at x = 0 and the front.
struct PlanarSpreading {
    double nu, volume;  ///< kinematic viscosity [m^2/s], volume per width [m^2]
    double g = 9.81;
    double front(double t) const;            ///< 1.41124477 (g A^3 t / (3 nu))^(1/5) [m]
    double depth(double x, double t) const;  ///< h(0) (1 - (x/x_N)^2)^(1/3) [m]
    double speed(double x, double t) const { return x < front(t) ? x / (5 * t) : 0.0; }
    double contour(double level, double t) const;  ///< where the depth is `level` [m]
    std::vector<Residual> residuals() const;
};

/// Round an axis.
struct RoundSpreading {
    double nu, volume;  ///< [m^2/s], of the full circle [m^3]
    double g = 9.81;
    double front(double t) const;  ///< 0.89391385 (g V^3 t / (3 nu))^(1/8) [m]
    double depth(double r, double t) const;
    double speed(double r, double t) const { return r < front(t) ? r / (8 * t) : 0.0; }
    double contour(double level, double t) const;
    std::vector<Residual> residuals() const;
};

/// Down an incline from a wall: h = sqrt(nu X / (g sin th t)) behind the front X_N = (9 A^2 g sin th t / (4 nu))^(1/3).
/// h is normal to the bed, X along it. Where the sheet ends, gravity along its own slope rounds the step off over a
/// length h_N / tan th. In the frame of the front u is uniform, 1 - cot(th) dh/dX = (h_N / h)^2, hence X_f - X = h_N
/// cot(th) (artanh(h/h_N) - h/h_N). `depth` is the product of both, with X_f = X_N + (ln 2 - 1/2) h_N cot th so that
/// the volume stays. What it neglects is of the order (h_N cot th / X_N)^2.
struct InclineSpreading {
    double nu, volume;  ///< [m^2/s], volume per width [m^2]
    double slope;       ///< [rad]
    double g = 9.81;
    double outer_front(double t) const;                      ///< X_N [m]
    double front_thickness(double t) const;                  ///< h_N [m]
    double length(double t) const;                           ///< h_N cot th [m]
    double front(double t) const;                            ///< X_f [m]
    double thickness(double along, double t) const;          ///< at X [m]
    double contour(double thickness_there, double t) const;  ///< X near the front of that thickness [m]
    /// The rounded step: h/h_N at a distance behind the front, in h_N cot th.
    static double step(double distance);
    std::vector<Residual> residuals() const;
};

}  // namespace frana::verify
