#pragma once
// How a particle's material is laid out in layers, and how fast each layer goes.
#include <string>
#include <vector>

#include "base/types.h"

namespace frana {

/// Where the layers' points stand. centres: in the middle of M equal slices of the depth. end_points: from the bed to
/// the free surface in M - 1 steps (Fois, de Falco, Formaggia 2025, eq. 2). So half a slice sticks out at either end. A
/// single layer stands in the middle, where the paper divides by zero.
enum class Layers { centres, end_points };

/// src/coupling/THEORY.md (3): speed over the mean speed at the relative height s = (z - Z) / h over the bed. plug: 1.
/// linear: 2 s. parabolic: 3/2 s (2 - s) (Newtonian film). bagnold: 5/3 (1 - (1 - s)^(3/2)) (Bagnold 1954).
enum class VelocityProfile { plug, linear, parabolic, bagnold };

/// The value of the profile at s in [0, 1] [1].
double profile_value(VelocityProfile profile, double s);

/// Depth mean of the squared profile: 1, 4/3, 6/5, 5/4 [1]. By so much the kinetic energy is above m |mean v|^2 / 2.
double exact_energy_factor(VelocityProfile profile);

/// Number of layers of a particle (Fois et al. 2025, eq. 1): floor(depth / spacing), at least 1. A part in 1e7 is
/// tolerated. Frames hold depths with 7 digits, and 0.3 / 0.1 is below 3 in binary numbers. Not above 1e18.
Index layer_count(double depth, double spacing);

/// Relative heights s of `count` layers, from below [1].
std::vector<double> layer_heights(Layers layers, Index count);

/// The profile at these heights, divided by its mean over them. Layers of equal mass then carry the particle's momentum
/// whatever their number.
std::vector<double> layer_speeds(VelocityProfile profile, const std::vector<double>& heights);

/// Mean of the squares of layer_speeds(): what the layers make of the energy factor [1].
double layer_energy_factor(const std::vector<double>& speeds);

}  // namespace frana
