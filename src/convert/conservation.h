#pragma once
// What the conversion to 3D conserves, and what it does to the kinetic energy.
#include <string>
#include <vector>

#include "convert/solid_points.h"

namespace frana {

/// One conserved quantity before and after.
struct Kept {
    std::string name, unit;
    double particles = 0.0;       ///< total of the particles
    double points = 0.0;          ///< total of the points
    double relative_error = 0.0;  ///< of the total; of momenta relative to the sum of m |v|, since they may cancel
    double worst_particle = 0.0;  ///< the largest of a single particle, relative to its own mass, volume, m |v|
};

struct Conservation {
    std::vector<Kept> kept;          ///< mass, volume, momentum_x, momentum_y
    double kinetic_particles = 0.0;  ///< sum of m |v|^2 / 2, v the horizontal mean velocity [J]
    double kinetic_points = 0.0;     ///< the same of the points' horizontal velocities [J]
    double kinetic_vertical = 0.0;   ///< of the points' vertical velocities [J]
    double energy_factor = 1.0;      ///< kinetic_points / kinetic_particles; 1 where nothing moves
    double exact_factor = 1.0;       ///< of the profile, exact_energy_factor()
    std::size_t particles = 0, points = 0;
    std::size_t most_layers = 0;  ///< of a particle
    double outside = 0.0;         ///< share of points below the bed or above the free surface [1]
};

/// Compares, in sums whose error does not grow.
Conservation conservation_of(const FlowParticles& particles, const SolidPoints& points, const ConversionChoice& choice);

/// For people: a table.
std::string conservation_text(const Conservation& conservation);

/// For programs: one JSON object with the members' names as keys.
std::string conservation_json(const Conservation& conservation);

}  // namespace frana
