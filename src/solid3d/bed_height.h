#pragma once
// A height field between its nodes.
#include <algorithm>

#include "terrain/raster.h"

namespace frana {

/// Elevation and gradient of the bilinear field; beyond its outer nodes as on them.
struct BedHeight {
    double z, slope_x, slope_y;
};

inline BedHeight bed_height(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const double u = std::clamp((x - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
    const double v = std::clamp((y - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    const Index i = std::min(static_cast<Index>(u), g.nx - 2), j = std::min(static_cast<Index>(v), g.ny - 2);
    const double fu = u - static_cast<double>(i), fv = v - static_cast<double>(j);
    const double a = bed.at(i, j), b = bed.at(i + 1, j), c = bed.at(i, j + 1), d = bed.at(i + 1, j + 1);
    return {(1 - fv) * ((1 - fu) * a + fu * b) + fv * ((1 - fu) * c + fu * d),
            ((1 - fv) * (b - a) + fv * (d - c)) / g.cell, ((1 - fu) * (c - a) + fu * (d - b)) / g.cell};
}

}  // namespace frana
