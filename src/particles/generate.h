#pragma once
// Particle generation after Fois, de Falco, Formaggia (2025), Algorithm 1, with one change. A particle's volume is the
// integral of the release depth over its own patch instead of an equal share. So the total volume and the local depth
// are both right.
#include <optional>
#include <string>
#include <vector>

#include "particles/material.h"
#include "particles/release.h"
#include "particles/seeds.h"

namespace frana {

/// lattice: square lattice aligned with the grid. r2: quasi-random (Roberts). slope: quasi-random, denser on
/// steep terrain.
enum class Placement { lattice, r2, slope };

struct ParticleOptions {
    double per_cell = 4;         ///< particles per grid cell, > 0
    std::optional<Index> count;  ///< particles of all releases together; replaces per_cell
    Placement placement = Placement::lattice;
    Reach reach = Reach::nodes;  ///< with pixels, those beyond the outer nodes stand on the line of these
};

/// The records of one release.
struct ReleaseReport {
    double volume = 0.0;           ///< of the release within the grid, from outline and raster alone [m^3]
    double area = 0.0;             ///< map area of that material [m^2]
    double particle_volume = 0.0;  ///< sum over its particles [m^3]
    double relative_error = 0.0;   ///< |particle_volume - volume| / volume [1]
    Index count = 0;               ///< particles
    double clipped_volume = 0.0;   ///< left out because it lies beyond the outer nodes [m^3]
    double spacing = 0.0;          ///< lattice spacing, or the root of the mean patch area [m]
};

/// Volume of all releases between the outer nodes of a grid, exactly as make_seeds() takes it, before there are particles
/// [m^3]. Throws UserError on a release whose depth is no number, or without any volume.
double volume_of(const std::vector<Release>& releases, const GridGeometry& grid);

/// Places the particles of all releases on the grid of `bed` (material lives as far as its `reach`). Gives each the
/// volume of its own patch. On the lattice the first point stands half a spacing from node (0, 0). The spacing is cell
/// / sqrt(per_cell), or is sought so that the number comes near to `count`. A lattice that fits the grid is taken when
/// it comes within 2 %. r2 and slope meet `count` exactly. Same input, same bits. Cost: linear in particles plus pixels
/// plus crossings of the outline with the patch grid. `reports` gets one entry per release; remarks are appended to
/// `log`. Throws UserError when a release has no material on the grid, its outline crosses itself, or it lies on
/// nodata.
Seeds make_seeds(const std::vector<Release>& releases, const Raster& bed, const ParticleOptions& options,
                 std::vector<ReleaseReport>& reports, std::vector<std::string>& log);

/// The conservation table of the reports, for people: one line per release and their sum.
std::string conservation_table(const std::vector<ReleaseReport>& reports);

}  // namespace frana
