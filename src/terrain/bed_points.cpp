#include "terrain/bed_points.h"

#include <algorithm>
#include <cmath>

#include "terrain/places.h"

namespace frana {

namespace {

/// Bilinear, up to `beyond` cells beyond the outer nodes. A NaN without weight does not count.
double bilinear_within(const Raster& raster, double x, double y, double beyond) {
    const GridGeometry& g = raster.geometry;
    const double u = (x - g.x0) / g.cell, v = (y - g.y0) / g.cell;
    if (!(u >= -beyond && v >= -beyond && u <= static_cast<double>(g.nx - 1) + beyond &&
          v <= static_cast<double>(g.ny - 1) + beyond))
        return Raster::nodata;
    const NodeSquare around(g, x, y);
    double value = 0.0;
    for (Index k = 0; k < 4; ++k)
        if (const double weight = around.weight(k); weight > 0.0)
            value += weight * raster.at(around.node(k).i, around.node(k).j);
    return value;
}

}  // namespace

double bed_elevation(const Raster& bed, double x, double y) {
    constexpr double kSlack = 1e-9;  // a point on the last line of nodes may come out a rounding error beyond it
    return bilinear_within(bed, x, y, kSlack);
}

double bilinear(const Raster& raster, const Vec2& point) {
    constexpr double kRim = 0.5 + 1e-6;  // pixels reach half a cell beyond the nodes; coordinates round
    return bilinear_within(raster, point.x(), point.y(), kRim);
}

double bed_below(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const NodeSquare around(g, std::clamp(x, g.x0, g.x_max()), std::clamp(y, g.y0, g.y_max()));
    double elevation = 0.0, known = 0.0;
    bool whole = true;
    for (Index k = 0; k < 4; ++k) {
        const double weight = around.weight(k);
        if (!(weight > 0.0)) continue;
        const double z = bed.at(around.node(k).i, around.node(k).j);
        if (std::isfinite(z))
            elevation += weight * z, known += weight;
        else
            whole = false;
    }
    if (whole) return elevation;
    return known > 0.0 ? elevation / known : Raster::nodata;
}

double bed_steepness(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const NodeAt nearest = nearest_node(g, x, y);
    const Index i = std::clamp<Index>(nearest.i, 0, g.nx - 1), j = std::clamp<Index>(nearest.j, 0, g.ny - 1);
    const auto slope = [&](Index i0, Index j0, Index i1, Index j1) {
        const double steps = static_cast<double>((i1 - i0) + (j1 - j0));
        return steps > 0.0 ? (bed.at(i1, j1) - bed.at(i0, j0)) / (steps * g.cell) : 0.0;
    };
    const double steepness = std::hypot(slope(std::max<Index>(i - 1, 0), j, std::min(i + 1, g.nx - 1), j),
                                        slope(i, std::max<Index>(j - 1, 0), i, std::min(j + 1, g.ny - 1)));
    return std::isfinite(steepness) ? steepness : 0.0;
}

}  // namespace frana
