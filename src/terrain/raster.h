#pragma once
// A grid of nodes and a scalar field on it. The nodes are the centres of square pixels. So a raster with the same
// pixels as the elevation model and the solver's grid are the same thing.
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/types.h"

namespace frana {

/// nx * ny nodes, `cell` apart; node (i, j) stands at (x0 + i cell, y0 + j cell), j grows to the NORTH.
/// Values are row-major, index j * nx + i: row 0 is the southernmost (GeoTIFF rows run the other way).
struct GridGeometry {
    Index nx = 0;       ///< nodes in x
    Index ny = 0;       ///< nodes in y
    double x0 = 0.0;    ///< map x of node (0, 0), centre of the south-west pixel [m]
    double y0 = 0.0;    ///< map y of node (0, 0) [m]
    double cell = 1.0;  ///< node distance, pixel size [m]

    Index size() const { return nx * ny; }
    double x(Index i) const { return x0 + static_cast<double>(i) * cell; }
    double y(Index j) const { return y0 + static_cast<double>(j) * cell; }
    double x_max() const { return x(nx - 1); }
    double y_max() const { return y(ny - 1); }
    /// [xmin, ymin, xmax, ymax] of the outer pixel edges (half a cell beyond the outer nodes) [m]
    std::array<double, 4> pixel_extent() const {
        return {x0 - 0.5 * cell, y0 - 0.5 * cell, x_max() + 0.5 * cell, y_max() + 0.5 * cell};
    }
    bool operator==(const GridGeometry& o) const {
        return nx == o.nx && ny == o.ny && x0 == o.x0 && y0 == o.y0 && cell == o.cell;
    }
};

/// A rectangle of nodes of a grid.
struct NodeBox {
    Index i0 = 0, j0 = 0;  ///< its south-west node
    Index nx = 0, ny = 0;

    static NodeBox all(const GridGeometry& g) { return {0, 0, g.nx, g.ny}; }
    /// The grid of these nodes alone.
    GridGeometry of(const GridGeometry& g) const { return {nx, ny, g.x(i0), g.y(j0), g.cell}; }
    bool operator==(const NodeBox& o) const { return i0 == o.i0 && j0 == o.j0 && nx == o.nx && ny == o.ny; }
};

/// A scalar field on the nodes; NaN marks nodata.
struct Raster {
    GridGeometry geometry;
    std::vector<double> values;  ///< geometry.size() values, row 0 = south
    std::string crs_wkt;         ///< WKT2 of the projected CRS, empty when unknown
    std::string source;          ///< file it came from, for messages

    static constexpr double nodata = std::numeric_limits<double>::quiet_NaN();
    double& at(Index i, Index j) { return values[static_cast<std::size_t>(j * geometry.nx + i)]; }
    double at(Index i, Index j) const { return values[static_cast<std::size_t>(j * geometry.nx + i)]; }
    static Raster filled(const GridGeometry& geometry, double value) {
        Raster raster;
        raster.geometry = geometry;
        raster.values.assign(static_cast<std::size_t>(geometry.size()), value);
        return raster;
    }
};

/// One polygon: ring 0 is the outer boundary, further rings are holes. Rings are not closed
/// (the last vertex is not the first one again).
struct Polygon {
    std::vector<std::vector<Vec2>> rings;
};

/// Polygons in map coordinates (multipolygons are flattened to several parts).
struct Polygons {
    std::vector<Polygon> parts;
    std::string crs_wkt;
    std::string source;
};

/// A polyline in map coordinates.
using Polyline = std::vector<Vec2>;

}  // namespace frana
