#pragma once
// A parabolic pile of granular material slides down a plane and spreads both ways. (Hutter, Siegel, Savage and Nohguchi
// 1993.) It is the setting of AvaFrame's avaSimilaritySol.
#include <vector>

#include "checks/verify/ode.h"
#include "checks/verify/problem.h"

namespace frana::verify {

/// Lengths along the slope (x down it, y across) and normal to it; at rest at t = 0, pressure coefficient 1.
class SimilarityPile {
public:
    SimilarityPile(double slope_deg, double friction_deg, double length, double depth);

    /// The pile at one time: axes' stretches g (x), f (y) and their rates in the pile's own time.
    struct Shape {
        double g, g_rate, f, f_rate, time;
    };
    /// At t [s]. `start`: end of the opening series g = 1 + B s^2, in the pile's own time; 1e-3 is exact to 1e-12.
    Shape shape(double t, double start = 1e-3) const;

    struct Place {
        double depth, u, v;
    };  ///< normal depth [m], velocity along x and y [m/s]
    Place at(const Shape& shape, double x, double y) const;
    double centre(double t) const { return 0.5 * drive_ * t * t * gravity_; }  ///< along the slope [m]

    /// The two stretching equations by differences, volume, and the printed figures at 5 s and 10 s.
    static std::vector<Residual> residuals();

private:
    static std::vector<Residual> published();
    State<4> rate(double time, const State<4>& y) const;

    double gravity_ = 9.81;
    double length_, depth_;                 ///< half axis and height at the start [m]
    double scale_;                          ///< sqrt(length / g), the pile's unit of time [s]
    double drive_, brake_, spread_, sine_;  ///< A - C, C, B = D of Hutter et al., A
};

}  // namespace frana::verify
