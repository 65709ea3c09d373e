#pragma once
// Room between the ground and the foot of a barrier of any shape.
#include "terrain/distance_field.h"
#include "terrain/raster.h"

namespace frana {

struct Gap {
    double height = 0.0;  ///< of the highest such room [m]
    double share = 0.0;   ///< of the map that the solid covers, over which there is one [1]
};

/// Rooms between `least` and `most` high [m], by samples of the map at every spacing of the field. Higher ones are bridges.
Gap gap_below(const DistanceField& solid, const Raster& bed, double least, double most);

}  // namespace frana
