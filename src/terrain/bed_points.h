#pragma once
#include "terrain/raster.h"

namespace frana {

/// Bed elevation at a map point, bilinear between the nodes [m]. NaN outside the outer nodes or where a node that takes
/// part has no data.
double bed_elevation(const Raster& bed, double x, double y);

/// Value between the nodes of any raster, bilinear, as far as its pixels reach; beyond the outer nodes as on them. NaN
/// beyond the pixels or where a node that takes part is NaN.
double bilinear(const Raster& raster, const Vec2& point);

/// The same wherever a point is [m]. Beyond the outer nodes it is that of the nearest place on them. Where some nodes
/// that take part have no data it is the mean of the others, by their weights. NaN where none has data.
double bed_below(const Raster& bed, double x, double y);

/// Steepness |grad Z| of the bed at the node nearest to a map point [1]; 0 where it is not known.
double bed_steepness(const Raster& bed, double x, double y);

}  // namespace frana
