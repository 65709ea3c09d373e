#pragma once
// A run's raster and a survey's, pixel by pixel.
#include "base/error.h"
#include "terrain/places.h"

namespace frana {

/// Calls body(i, j, simulated, surveyed) for every pixel (i, j) of the survey, rows from the south. `surveyed` has the pixels
/// of `simulated`, and may have more around them; there nothing was simulated. Either may be NaN.
template <class Body>
void for_each_pair(const Raster& simulated, const Raster& surveyed, const Body& body) {
    const GridGeometry &inner = simulated.geometry, &outer = surveyed.geometry;
    expect(inner.cell == outer.cell, "two rasters on the same pixels");
    const NodeAt first = first_node(inner, outer);
    for (Index j = 0; j < outer.ny; ++j)
        for (Index i = 0; i < outer.nx; ++i) {
            const NodeAt node{i - first.i, j - first.j};
            body(i, j, has_node(inner, node) ? simulated.at(node.i, node.j) : 0.0, surveyed.at(i, j));
        }
}

}  // namespace frana
