#include "vtk_io/barrier_top.h"

#include <cmath>

#include "terrain/places.h"

namespace frana {

double elevation_at(const Raster& bed, const Vec2& p) { return NodeSquare(bed.geometry, p).value(bed); }

double top_at(const BarrierTop& top, const Raster& bed, const Vec2& p, double otherwise) {
    const double z = top.level ? *top.level : elevation_at(bed, p) + top.height;
    return std::isnan(z) ? otherwise : z;
}

}  // namespace frana
