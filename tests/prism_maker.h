#pragma once
// Outlines of barriers and walls for tests.
#include <vector>

#include "terrain/raster.h"

namespace frana {

inline Polygons ring(const std::vector<Vec2>& corners) { return {{Polygon{{corners}}}, "", ""}; }
inline Polygons box(double x0, double y0, double x1, double y1) {
    return ring({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

}  // namespace frana
