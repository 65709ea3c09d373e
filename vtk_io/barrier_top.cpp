#include "vtk_io/barrier_top.h"

#include <algorithm>
#include <cmath>

namespace frana {

double elevation_at(const Raster& bed, const Vec2& p) {
    const GridGeometry& g = bed.geometry;
    const double u = std::clamp((p.x() - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1)),
                 v = std::clamp((p.y() - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
    const Index i = std::min(static_cast<Index>(u), g.nx - 2), j = std::min(static_cast<Index>(v), g.ny - 2);
    const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
    return (1 - t) * ((1 - s) * bed.at(i, j) + s * bed.at(i + 1, j)) +
           t * ((1 - s) * bed.at(i, j + 1) + s * bed.at(i + 1, j + 1));
}

double top_at(const BarrierTop& top, const Raster& bed, const Vec2& p, double otherwise) {
    const double z = top.level ? *top.level : elevation_at(bed, p) + top.height;
    return std::isnan(z) ? otherwise : z;
}

}  // namespace frana
