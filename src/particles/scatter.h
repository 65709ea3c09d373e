#pragma once
// Quasi-random particles with the volume of their nearest surroundings.
#include "particles/material.h"
#include "particles/seeds.h"

namespace frana {

enum class Density { even, steepness };

/// Appends exactly `count` particles of one release: the first points of Roberts' (2018) additive sequences
/// that fall on material. R2 gives an even density. R3 with thinning gives a density that follows |grad Z|. That is the
/// idea of Fois et al. (2025), section 2. The density is between a third and three times its mean over the grid. Every
/// cell of a patch grid, four to the particle's edge, goes to its nearest particle. So the volumes are exact in total
/// and the depth is that of the surroundings. `area` is the material's [m^2].
OutlineFaults place_scattered(const Material& material, Index count, double area, Density density, const Raster& bed,
                              Seeds& seeds);

}  // namespace frana
