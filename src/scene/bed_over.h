#pragma once
// Elevations of more of a terrain than a scene holds of it.
#include "scene/scene.h"

namespace frana {

/// The bed that a scene holds, with that of the nodes of `shown` where it is a part of a wider terrain. `wider` is null
/// where the bed is all of it. Throws UserError when the terrain cannot be read.
Raster bed_over(const Raster& bed, const WiderTerrain* wider, const GridGeometry& shown);

}  // namespace frana
