#pragma once
// A height field between its nodes.
#include "terrain/places.h"

namespace frana {

/// Elevation and gradient of the bilinear field; beyond its outer nodes as on them.
struct BedHeight {
    double z, slope_x, slope_y;
};

inline BedHeight bed_height(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const NodeSquare around(g, x, y);
    const Index i = around.i, j = around.j;
    const double fu = around.s, fv = around.t;
    const double a = bed.at(i, j), b = bed.at(i + 1, j), c = bed.at(i, j + 1), d = bed.at(i + 1, j + 1);
    return {around.value(bed), ((1 - fv) * (b - a) + fv * (d - c)) / g.cell,
            ((1 - fu) * (c - a) + fu * (d - b)) / g.cell};
}

}  // namespace frana
