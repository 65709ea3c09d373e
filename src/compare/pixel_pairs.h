#pragma once
// A run's raster and a survey's, pixel by pixel.
#include <cmath>

#include "base/error.h"
#include "terrain/raster.h"

namespace frana {

/// Calls body(i, j, simulated, surveyed) for every pixel (i, j) of the survey, rows from the south. `surveyed` has the pixels
/// of `simulated`, and may have more around them; there nothing was simulated. Either may be NaN.
template <class Body>
void for_each_pair(const Raster& simulated, const Raster& surveyed, const Body& body) {
    const GridGeometry &inner = simulated.geometry, &outer = surveyed.geometry;
    expect(inner.cell == outer.cell, "two rasters on the same pixels");
    const auto left = static_cast<Index>(std::lround((inner.x0 - outer.x0) / outer.cell));
    const auto low = static_cast<Index>(std::lround((inner.y0 - outer.y0) / outer.cell));
    for (Index j = 0; j < outer.ny; ++j)
        for (Index i = 0; i < outer.nx; ++i) {
            const Index si = i - left, sj = j - low;
            const bool there = si >= 0 && sj >= 0 && si < inner.nx && sj < inner.ny;
            body(i, j, there ? simulated.at(si, sj) : 0.0, surveyed.at(i, j));
        }
}

}  // namespace frana
