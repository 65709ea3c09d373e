#pragma once
// Where a place of the map lies on a grid: its nearest node, its pixel, the four nodes around it.
#include <algorithm>
#include <cmath>

#include "terrain/raster.h"

namespace frana {

/// Column and row of a node; it may lie beyond the grid.
struct NodeAt {
    Index i = 0, j = 0;
};

/// The node nearest to a place [m]; of two that are equally far the one farther from node (0, 0).
inline NodeAt nearest_node(const GridGeometry& g, double x, double y) {
    return {static_cast<Index>(std::lround((x - g.x0) / g.cell)), static_cast<Index>(std::lround((y - g.y0) / g.cell))};
}
inline NodeAt nearest_node(const GridGeometry& g, const Vec2& place) { return nearest_node(g, place.x(), place.y()); }

/// Where the south-west node of `inner` lies on a grid of the same pixels.
inline NodeAt first_node(const GridGeometry& inner, const GridGeometry& on) {
    return nearest_node(on, inner.x0, inner.y0);
}

inline bool has_node(const GridGeometry& g, const NodeAt& node) {
    return node.i >= 0 && node.j >= 0 && node.i < g.nx && node.j < g.ny;
}

/// Number of the pixel that a place lies in [m], its west and south edges included; -1 beyond the grid.
inline Index pixel_of(const GridGeometry& g, double x, double y) {
    const double i = std::floor((x - g.x0) / g.cell + 0.5), j = std::floor((y - g.y0) / g.cell + 0.5);
    if (!(i >= 0.0 && j >= 0.0 && i < static_cast<double>(g.nx) && j < static_cast<double>(g.ny))) return -1;
    return static_cast<Index>(j) * g.nx + static_cast<Index>(i);
}

/// The four nodes around a place, and where between them it lies. Beyond the outer nodes it is as on them. Of a grid of
/// one row or column those beyond it have no weight.
struct NodeSquare {
    Index i = 0, j = 0;       ///< south-west node
    double s = 0.0, t = 0.0;  ///< way from it to the east and to the north [cells], 0 to 1

    NodeSquare(const GridGeometry& g, double x, double y) {
        const double u = std::clamp((x - g.x0) / g.cell, 0.0, static_cast<double>(g.nx - 1));
        const double v = std::clamp((y - g.y0) / g.cell, 0.0, static_cast<double>(g.ny - 1));
        i = std::min(static_cast<Index>(u), std::max<Index>(g.nx - 2, 0));
        j = std::min(static_cast<Index>(v), std::max<Index>(g.ny - 2, 0));
        s = u - static_cast<double>(i), t = v - static_cast<double>(j);
    }
    NodeSquare(const GridGeometry& g, const Vec2& place) : NodeSquare(g, place.x(), place.y()) {}

    /// Of the four, from the south-west eastwards, then the northern two.
    NodeAt node(Index k) const { return {i + k % 2, j + k / 2}; }
    /// Its share in a bilinear value [1].
    double weight(Index k) const { return (k % 2 ? s : 1.0 - s) * (k / 2 ? t : 1.0 - t); }
    /// The bilinear value, of a grid with two rows and columns at least; NaN where one of the four is.
    double value(const Raster& raster) const {
        return (1 - t) * ((1 - s) * raster.at(i, j) + s * raster.at(i + 1, j)) +
               t * ((1 - s) * raster.at(i, j + 1) + s * raster.at(i + 1, j + 1));
    }
};

/// Whether a place lies within the outer nodes [m].
inline bool between_nodes(const GridGeometry& g, const Vec2& place) {
    const double u = (place.x() - g.x0) / g.cell, v = (place.y() - g.y0) / g.cell;
    return u >= 0.0 && v >= 0.0 && u <= static_cast<double>(g.nx - 1) && v <= static_cast<double>(g.ny - 1);
}

}  // namespace frana
