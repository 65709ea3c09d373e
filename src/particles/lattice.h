#pragma once
// Particles on a square lattice.
#include <string>
#include <vector>

#include "particles/material.h"
#include "particles/seeds.h"

namespace frana {

/// A patch with less than this fraction of its area covered hands its volume to a neighbour [1].
constexpr double kDustFraction = 1e-3;

/// The lattice whose number of particles comes nearest to `wanted`, starting from the spacing that the total
/// area suggests. First it tries lattices that fit the grid (cell / k or k cell, accepted within 2 %). Then it tries
/// any spacing and phase (sought to 0.2 %). Remarks go to `log`.
Lattice lattice_of_count(const std::vector<Material>& materials, double cell, double total_area, Index wanted,
                         std::vector<std::string>& log);

/// Appends position (map), volume, depth and size of one release's particles, south to north, west to east.
/// Material on nodata of the bed is a UserError.
OutlineFaults place_on_lattice(const Material& material, const Lattice& lattice, const Raster& bed, Seeds& seeds);

}  // namespace frana
