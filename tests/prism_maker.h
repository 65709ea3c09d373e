#pragma once
// The outline of a barrier by its corners; a rectangle is in fake_gis.h.
#include <vector>

#include "terrain/raster.h"

namespace frana {

inline Polygons ring(const std::vector<Vec2>& corners) { return {{Polygon{{corners}}}, "", ""}; }

}  // namespace frana
