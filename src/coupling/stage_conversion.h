#pragma once
// Particles that become 3D points, and points that become particles.
#include <array>
#include <functional>

#include "convert/solid_points.h"
#include "mpm/domain.h"
#include "scene/scene.h"
#include "shallow/particles.h"
#include "solid3d/mpm3d.h"

namespace frana {

/// The particles of a frame of the depth-averaged model that stand in marked nodes' cells. `domains` are those of all
/// of its particles, or none.
FlowParticles particles_of(const Frame& frame, const std::vector<Mat2>& domains, const Raster& bed,
                           const std::vector<std::uint8_t>& marks);

/// The edges of the domains of particles, on cells of `cell` [m]. None in the paper preset, whose domains do not follow
/// the flow.
std::vector<Mat2> domains_of(const Particles& particles, double cell, const Scheme& scheme);
Mat2 domain_of(const Edges& edges, double cell);

/// The seeds of a release as particles, at rest or not. They are those in marked nodes' cells, or without `marks` all,
/// in their order.
FlowParticles particles_of(const Seeds& seeds, const Scene& scene, const std::vector<std::uint8_t>& marks);

/// Each particle as m x n of them on its domain, so many that they are about `spacing` apart. There are fewer where the
/// parts would have less than an eighth of a full point's mass. Particles without a domain stand on the square of their
/// volume / depth. Edges longer than `widest` count as that. Beds and slopes are those of `bed` below each part. Parts
/// stay within `extent`. Mass, volume and momentum are those of the particle.
FlowParticles in_parts(const FlowParticles& particles, double spacing, double widest, const Raster& bed,
                       const std::array<double, 4>& extent);

/// Where the bed ahead of a particle within `reach` [m] is less steep downhill, or steeper uphill, the slope along its way
/// becomes that one. So what comes down to a break of slope does not move into the ground behind it. Ground that is not known
/// counts for nothing.
void look_ahead(FlowParticles& particles, const Raster& bed, double reach);

constexpr double kAhead = 2.0;  ///< cells of the 3D stage

/// How many parts in_parts() makes, and how many 3D points they become. It is computed before either takes memory.
struct PartsForecast {
    double particles = 0.0, points = 0.0;
};
PartsForecast forecast_parts(const FlowParticles& particles, double spacing, double widest);

/// When points become particles, and what is there. Places are on the map [m].
struct ParticlesAt {
    double time;                                                   ///< [s]
    std::function<Vec2(const DepartedPoint&, const Vec2&)> place;  ///< of a particle of a point that has come there
    std::function<double(const Vec2&)> depth;                      ///< of what is there already [m]
};

/// Particles that were points, with the gradients of their velocities, dv_k/dx_l at (k, l) [1/s].
struct MovingParticles {
    Seeds seeds;
    std::vector<Mat2> gradient;
};

/// Points that left as particles: one for all of them in each quarter of a cell of the terrain. It is at their centre
/// of mass, with their mass and momentum. Until then they went on at the speed that they had. So their velocities are
/// half a step behind their places, as those of particles are. They are as deep as what is there, and at least as all
/// that is new on their quarter.
MovingParticles particles_of(const std::vector<DepartedPoint>& points, const Scene& scene, const ParticlesAt& at);

/// The points of particles (convert/solid_points.h) for the solver.
SolidSeeds seeds_of(const FlowParticles& particles, const SolidStage& stage);

/// Of which of the particles each of them is.
std::vector<std::size_t> parts_of_seeds(const FlowParticles& particles, const SolidStage& stage);

}  // namespace frana
