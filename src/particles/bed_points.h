#pragma once
#include "terrain/raster.h"

namespace frana {

/// Bed elevation at a map point, bilinear between the nodes [m]; NaN outside the outer nodes or where a node
/// that takes part has no data.
double bed_elevation(const Raster& bed, double x, double y);

/// Steepness |grad Z| of the bed at the node nearest to a map point [1]; 0 where it is not known.
double bed_steepness(const Raster& bed, double x, double y);

}  // namespace frana
