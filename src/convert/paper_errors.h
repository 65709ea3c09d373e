#pragma once
// The error measures of Fois, de Falco, Formaggia (2025), eq. (4). They tell how far the points' masses and momenta are
// from those of points that were all alike. They are absolute and shrink with the points themselves; what conversion
// conserves is in conservation.h.
#include <functional>

#include "convert/solid_points.h"

namespace frana {

/// What the measures need of a particle.
struct ErrorParticle {
    double depth = 0.0, mass = 0.0, volume = 0.0, momentum = 0.0;
};

/// sqrt(sum V_p |q_p - Q / N|^2 / sum V_p) over the N points, Q the exact total.
struct ConversionErrors {
    double mass = 0.0;      ///< [kg]
    double momentum = 0.0;  ///< along x [kg m/s]
    double points = 0.0;    ///< N
};

/// Exact totals of the material.
struct ExactTotals {
    double mass = 0.0;      ///< [kg]
    double momentum = 0.0;  ///< along x [kg m/s]
};

/// Of plug-flow points that particles_to_points() would make, found particle by particle. Their number may be beyond
/// any memory (the paper's finest has 1e12). `particle` is called twice for each index.
ConversionErrors conversion_errors(Index particles, const std::function<ErrorParticle(Index)>& particle, double spacing,
                                   const ExactTotals& exact);

/// The same from the points themselves.
ConversionErrors conversion_errors(const SolidPoints& points, const ExactTotals& exact);

}  // namespace frana
