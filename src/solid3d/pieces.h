#pragma once
// What 3D material has come apart into.
#include "solid3d/material_points.h"

namespace frana {

/// Lumps of points. Points no farther apart than kLink hang together. Thin material is drawn out further than its
/// points follow (numerical fracture). Spray and what slides off part as well: no sum tells them from each other.
struct Pieces {
    static constexpr double kLink = 1.0;  ///< [cells]; points start half a cell apart where stages choose it
    Index count = 0;                      ///< of lumps
    double apart = 0.0;                   ///< share of the mass outside the largest of them [1]
    /// Share of the mass outside the largest part that shares nodes, by way of others too [1]. It feels nothing of that
    /// part.
    double alone = 0.0;
};

/// Of all points of a grid. Sums run in the order of cells and points: the same bits for any number of threads.
/// Allocates memory, so it is for output times.
Pieces pieces_of(const MaterialPoints& points, const Grid3d& grid);

}  // namespace frana
