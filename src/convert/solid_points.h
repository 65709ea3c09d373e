#pragma once
// From depth-averaged particles to 3D points (Fois, de Falco, Formaggia 2025, Algorithm 2).
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "convert/flow_particles.h"
#include "convert/profile.h"

namespace frana {

/// What is done with the velocity across the bed. zero: none, as the paper has it (eq. 3). along_bed: w = v . grad Z in
/// every layer, so that nothing is driven into the ground or off it. Otherwise a flow of 20 m/s on 30 degrees would hit
/// the bed with 11.5 m/s. A quarter of the kinetic energy along the bed would be lost.
enum class Vertical { zero, along_bed };

struct ConversionChoice {
    double spacing = 1.0;  ///< vertical, between points [m]
    Layers layers = Layers::centres;
    Vertical vertical = Vertical::along_bed;
    VelocityProfile profile = VelocityProfile::plug;
};

/// 3D points, particle after particle and each from below. Arrays of vectors hold a point's components together.
struct SolidPoints {
    std::vector<double> position;    ///< x, y, z [m]
    std::vector<double> velocity;    ///< [m/s]
    std::vector<double> mass;        ///< [kg]
    std::vector<double> volume;      ///< [m^3]
    std::vector<double> pressure;    ///< [Pa], see particles_to_points()
    std::vector<double> stress;      ///< xx, yy, zz, xy, yz, xz; tension positive [Pa]
    std::vector<double> particle;    ///< the run's number of the particle (FlowParticles::id) [1]
    std::vector<double> height;      ///< of the slice that the point stands for [m]
    std::vector<std::size_t> first;  ///< of each particle its first point, then the number of points

    std::size_t count() const { return mass.size(); }
};

/// Throws UserError for a spacing that is not a positive number.
void require_spacing(double spacing);

/// Particles within [xmin, ymin, xmax, ymax].
FlowParticles particles_within(const FlowParticles& particles, const std::array<double, 4>& window);

/// Number of points that particles_to_points() would make; as a real number, since it may be beyond any memory.
double forecast_points(const FlowParticles& particles, double spacing);

/// Memory that a point of SolidPoints takes [bytes].
constexpr double kBytesPerPoint = 8.0 * (3 + 3 + 1 + 1 + 1 + 6 + 1 + 1);

/// The points. Each particle gives layer_count() points of equal mass and volume above one another. They share its
/// horizontal velocity by the profile, whose mean over the layers is one. The pressure is hydrostatic, from the
/// particle's bed pressure at the bed to zero at the free surface. The stress is minus that pressure, plus the mean
/// stress of the rheology. That is without change of volume, zz = -xx - yy; its vertical shear is not in a
/// depth-averaged state. Deterministic for any number of threads. Throws UserError for a spacing that is not positive;
/// InternalError when the particles' arrays differ in length.
SolidPoints particles_to_points(const FlowParticles& particles, const ConversionChoice& choice);

}  // namespace frana
