#include "particles/bed_points.h"

#include <algorithm>
#include <cmath>

namespace frana {

namespace {

/// The four nodes around a point on the grid, and their weights.
struct Corners {
    Index i, j;
    double weights[4];
    Corners(const GridGeometry& g, double u, double v)
        : i(std::clamp<Index>(static_cast<Index>(u), 0, std::max<Index>(g.nx - 2, 0))),
          j(std::clamp<Index>(static_cast<Index>(v), 0, std::max<Index>(g.ny - 2, 0))) {
        const double s = std::clamp(u - static_cast<double>(i), 0.0, 1.0);
        const double t = std::clamp(v - static_cast<double>(j), 0.0, 1.0);
        weights[0] = (1 - s) * (1 - t), weights[1] = s * (1 - t), weights[2] = (1 - s) * t, weights[3] = s * t;
    }
};

}  // namespace

double bed_elevation(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const double u = (x - g.x0) / g.cell, v = (y - g.y0) / g.cell;
    // A point on the last line of nodes may come out a rounding error beyond it.
    const double slack = 1e-9;
    if (!(u >= -slack && v >= -slack && u <= static_cast<double>(g.nx - 1) + slack &&
          v <= static_cast<double>(g.ny - 1) + slack))
        return Raster::nodata;
    const Corners at(g, u, v);
    double elevation = 0.0;
    for (Index k = 0; k < 4; ++k)
        if (at.weights[k] > 0.0) elevation += at.weights[k] * bed.at(at.i + k % 2, at.j + k / 2);
    return elevation;
}

double bed_below(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const Corners at(g, (std::clamp(x, g.x0, g.x_max()) - g.x0) / g.cell,
                     (std::clamp(y, g.y0, g.y_max()) - g.y0) / g.cell);
    double elevation = 0.0, known = 0.0;
    bool whole = true;
    for (Index k = 0; k < 4; ++k) {
        if (!(at.weights[k] > 0.0)) continue;
        const double z = bed.at(at.i + k % 2, at.j + k / 2);
        if (std::isfinite(z))
            elevation += at.weights[k] * z, known += at.weights[k];
        else
            whole = false;
    }
    if (whole) return elevation;
    return known > 0.0 ? elevation / known : Raster::nodata;
}

double bed_steepness(const Raster& bed, double x, double y) {
    const GridGeometry& g = bed.geometry;
    const Index i = std::clamp<Index>(std::lround((x - g.x0) / g.cell), 0, g.nx - 1);
    const Index j = std::clamp<Index>(std::lround((y - g.y0) / g.cell), 0, g.ny - 1);
    const auto slope = [&](Index i0, Index j0, Index i1, Index j1) {
        const double steps = static_cast<double>((i1 - i0) + (j1 - j0));
        return steps > 0.0 ? (bed.at(i1, j1) - bed.at(i0, j0)) / (steps * g.cell) : 0.0;
    };
    const double steepness = std::hypot(slope(std::max<Index>(i - 1, 0), j, std::min(i + 1, g.nx - 1), j),
                                        slope(i, std::max<Index>(j - 1, 0), i, std::min(j + 1, g.ny - 1)));
    return std::isfinite(steepness) ? steepness : 0.0;
}

}  // namespace frana
