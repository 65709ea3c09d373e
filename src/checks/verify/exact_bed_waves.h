#pragma once
// Small waves on a uniform flow that takes up its bed: rates of growth by linear theory. Lengths run along the slope and
// normal to it.
#include <complex>

#include "checks/verify/problem.h"
#include "law/erosion/laws.h"

namespace frana::verify {

/// A wave exp(st + ikx): its rate s and what its depth, bed and speed have of it.
struct BedWave {
    std::complex<double> rate;               ///< [1/s]
    std::complex<double> depth, bed, speed;  ///< the largest of them, over depth and speed of the flow, is 1
    double growth() const { return rate.real(); }
};

/// A layer with the drag g u^2 / (xi h). It slides down a plane at its normal speed over a bed of its own density:
///   h_t + (h u)_x = E,   b_t = -E,   u_t + u u_x + g cos (h + b)_x = g sin - g u^2 / (xi h) - (1 - kappa) E u / h + 2 nu u_xx.
/// Without nu waves on it are ill-posed at a Froude number of 1 (Langham et al. 2021, J. Fluid Mech.). There the slow
/// wave stands over the bed. Short ones grow at a rate that goes as the root of k, see short_limit().
struct ErodingSheet {
    double froude = 1.0;     ///< u / sqrt(g cos h)
    double gradient = 0.05;  ///< tangent of the slope
    double gravity = 9.81, density = 1000.0, thickness = 1.0;
    double kappa = 0.0;      ///< share of the flow's velocity that what is taken brings along
    double viscosity = 0.0;  ///< nu [m2/s]
    ErosionLaw law;

    double cosine() const;
    double xi() const;                       ///< with which that slope has that Froude number [m/s2]
    double speed() const;                    ///< [m/s]
    double stress() const;                   ///< on the bed [Pa]
    double taken(double h, double u) const;  ///< E [m/s]

    /// Of the three waves with the wave number k [1/m] the one that grows fastest.
    BedWave fastest(double k) const;
    /// Rate at a Froude number of 1, leading order in k: Re sqrt(i k g cos (u E_u - h E_h) / (2 u)). So a law whose
    /// rate goes as h u has no such growth (growth). One that depends only on u (jump) or only on h (steady) has it.
    double short_limit(double k) const;
    /// What is left of the three equations for that wave, over the largest term of each.
    double residual(double k, const BedWave& wave) const;

private:
    /// Derivatives at the uniform flow: of E, and of all that brakes.
    struct Slopes {
        double taken_h, taken_u, brake_h, brake_u;
    };
    Slopes slopes() const;
    double brake(double h, double u) const;
};

/// Waves satisfy their equations; short ones at a Froude number of 1 their limit.
std::vector<Residual> bed_wave_residuals();

}  // namespace frana::verify
