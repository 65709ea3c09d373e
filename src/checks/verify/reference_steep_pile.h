#pragma once
// A pile of granular material on a steep plane by the equations that particles on steep terrain obey.
#include <Eigen/Dense>
#include <array>
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// Map coordinates, x down the plane z = -slope x, y across; at rest at t = 0 with the depth
/// height (1 - (x / length_x)^2 - (y / length_y)^2) [m], vertical. With e = grad(h) - (slope, 0), q = -slope e_x:
///   dv/dt = -g e / (1 + max(0, q)) - mu g cos v / |V|,   |V| along the plane.
/// Linearised in grad(h) and in the direction of friction this is the theory of Hutter et al. (1993). The direction is
/// v / V with the speed of the centre. Its answer is a linear map of the start. Here the map from the start, x(a, b, t)
/// and y(a, b, t), is a polynomial. Its coefficients obey the equations in the mean over the mass (Galerkin),
/// Runge-Kutta in time. No grid, no diffusion.
class SteepPile {
public:
    struct Plane {
        double slope, friction, height, length_x, length_y, gravity;
    };
    enum class Form { steep, linearised };

    SteepPile(const Plane& plane, Form form, int degree, double end, double step = 0.01);

    struct Place {
        double depth = 0.0, u = 0.0, v = 0.0;
    };                                   ///< [m], [m/s]
    Place at(double x, double y) const;  ///< at `end`
    double centre() const;               ///< x of the mass [m]

private:
    struct Motion {
        Eigen::VectorXd x, y, u, v;
    };  ///< coefficients of places and velocities
    struct Basis {
        Eigen::MatrixXd value, by_a, by_b, by_aa, by_ab, by_bb;
    };             ///< at the quadrature points
    struct Local;  ///< the map and what follows of it at one place of the start

    Motion rate(const Motion& now) const;
    Vec2 steep(const Local& here) const;                    ///< acceleration [m/s^2]
    Vec2 linearised(const Local& here, double fall) const;  ///< the same; `fall`: speed of the centre [m/s]
    Local local(const Motion& now, Index point) const;

    Plane plane_;
    Form form_;
    std::vector<std::array<int, 2>> powers_x_, powers_y_;
    Eigen::VectorXd a_, b_, weight_;
    Basis basis_x_, basis_y_;
    Eigen::LDLT<Eigen::MatrixXd> mass_x_, mass_y_;
    Motion end_;
};

/// What its linearised form differs from the similarity solution, and how far the steep one changes with the degree.
std::vector<Residual> steep_pile_residuals();

}  // namespace frana::verify
