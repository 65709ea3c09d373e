#pragma once
// A height field between its nodes.
#include "terrain/places.h"

namespace frana {

/// Elevation and gradient of the bilinear field. Beyond its outer nodes it goes on with the slope that it has there, so
/// that what slides out neither gains nor loses energy on the way.
struct BedHeight {
    double z, slope_x, slope_y;
};

inline BedHeight bed_height(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const NodeSquare around(g, x, y);
    const Index i = around.i, j = around.j;
    const double fu = around.s, fv = around.t;
    const double a = bed.at(i, j), b = bed.at(i + 1, j), c = bed.at(i, j + 1), d = bed.at(i + 1, j + 1);
    const double slope_x = ((1 - fv) * (b - a) + fv * (d - c)) / g.cell;
    const double slope_y = ((1 - fu) * (c - a) + fu * (d - b)) / g.cell;
    const double out_x = x - std::clamp(x, g.x0, g.x_max()), out_y = y - std::clamp(y, g.y0, g.y_max());
    return {around.value(bed) + slope_x * out_x + slope_y * out_y, slope_x, slope_y};
}

}  // namespace frana
