#pragma once
// Flows that take up their bed: slabs on a plane, the trench behind a block, a growing cap. Lengths run along
// the slope and normal to it. kappa is the share of the flow's velocity that what is taken brings along.
#include "checks/verify/problem.h"

namespace frana::verify {

/// Speed along the bed, way along it and thickness of a slab.
struct SlabState {
    double speed, way, thickness;
};

/// An infinite layer on a plane with Coulomb friction: h du/dt = a h - (1 - kappa) E u, dh/dt = E.
struct ErodingSlab {
    double slope_deg = 30.0, mu = 0.3, gravity = 9.81;
    double thickness = 1.0, speed = 0.0;  ///< at the start [m], [m/s]
    double kappa = 0.0;
    double drive() const;     ///< a = g (sin - mu cos) [m/s^2]
    double friction() const;  ///< mu g cos [m/s^2]
    /// Of that drive and friction [m/s^2], by slope and mu.
    static ErodingSlab with(double drive, double friction);

    /// E constant [m/s].
    SlabState at_rate(double rate, double t) const;
    /// E = growth h u, from rest: u = sqrt(a / ((1 - kappa) growth)) tanh(w t).
    SlabState grown(double growth, double t) const;
    /// The same with Voellmy's drag g u^2 / (xi h), by integration.
    SlabState grown_voellmy(double growth, double xi, double t) const;
    /// E = mu g cos h / u: friction's stress goes into what is set in motion. u = u_0 + b t, b = a - (1 - kappa) mu g cos,
    /// h = h_0 (u / u_0)^(mu g cos / b).
    SlabState jumped(double t) const;
    /// The time in which it goes so far from rest, of grown().
    double time_to(double growth, double way) const;
};

/// The slab of jumped() in `slab_jump`. Its drive is that of 30 degrees and mu 0.3, its friction 4 % of the one there. D-Claw's
/// law for dry material has such a share.
ErodingSlab jumping_slab(double kappa);

/// Depth that a rigid block takes at x behind its first front, after the way S, by E = growth h u. The block has
/// uniform thickness h0 and length L.
struct Trench {
    double growth = 2e-3, length = 50.0, thickness = 1.0, way = 300.0;
    double depth(double x) const;
    double volume() const;  ///< per width: h0 L (exp(growth S) - 1) [m^2]
};

/// A parabolic cap from rest that grows by E = eps h and spreads by its pressure: h = h_m (1 - (X/L)^2), u = u_c + X
/// L'/L. There L'' = 2 g cos(slope) h_m / L - (1 - kappa) eps L', u_c' = a - (1 - kappa) eps u_c.
struct GrowingCap {
    double slope_deg = 35.0, friction_deg = 25.0, gravity = 9.81;
    double height = 4.0, half_length = 80.0, eps = 0.05, kappa = 0.0;
    struct State {
        double half_length, spreading, centre, speed, height;
    };
    State at(double t) const;
};

/// Equations of all of them, and published figures.
std::vector<Residual> eroding_slab_residuals();
std::vector<Residual> growing_slab_residuals();
std::vector<Residual> voellmy_slab_residuals();
std::vector<Residual> jumping_slab_residuals();
std::vector<Residual> trench_residuals();
std::vector<Residual> growing_cap_residuals();

}  // namespace frana::verify
