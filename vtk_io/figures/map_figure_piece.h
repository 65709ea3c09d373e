#pragma once
// Which piece of the terrain a perspective view shows.
#include <array>

#include "vtk_io/figures/map_figure_perspective.h"

namespace frana {

using MapBox = std::array<double, 4>;  ///< xmin, ymin, xmax, ymax [m]

/// The block to show: the material and the survey with a broad margin, at least 40 % of the terrain. All of it when the
/// figure has an eye of its own and no focus.
MapBox block_of(const PerspectiveFigure& figure);

/// Nodes over the block, `along` of them on its longer side.
GridGeometry block_grid(const MapBox& box, double along);

/// Mean uphill direction under the material (of the whole block without any), as an azimuth [radians].
double uphill_azimuth(const Raster& bed, const Raster& field, double shown_above);

}  // namespace frana
