#pragma once
// Extents as closed outlines in map coordinates, and how far two outlines lie apart.
#include "terrain/outline_area.h"
#include "terrain/raster.h"

namespace frana {

/// The rings of polygons that do not overlap, in the sense that Rings needs (outer counter-clockwise, holes clockwise).
Rings rings_of(const Polygons& polygons);

/// Area within the rings [m2].
double area_of(const Rings& rings);

/// Outline of all pixels whose value exceeds `limit`, along their edges. Pixels that touch at a corner only have
/// rings of their own; NaN is not above any limit.
Rings pixel_outline(const Raster& field, double limit);

/// Distances between two outlines, each of all its rings.
struct OutlineDistance {
    double mean = 0.0;  ///< over the length of both outlines, from each point to the nearest of the other [m]
    double p95 = 0.0;   ///< 95 % of both lengths lie nearer than this to the other [m]
    double rms = 0.0;   ///< root of the mean square over the same length [m]
    double max = 0.0;   ///< Hausdorff distance of the outlines [m]
};

/// Both outlines are divided into steps of at most `step` [m]. From the middle of each step the distance to the other
/// outline is exact. All NaN when one of them has no rings.
OutlineDistance distance_between(const Rings& a, const Rings& b, double step);

}  // namespace frana
