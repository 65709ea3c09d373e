#pragma once
// Two extents on the terrain: where they agree, and where only one of them is.
#include "terrain/raster.h"
#include "vtk_io/figures/pixels.h"

namespace frana {

/// For each node of the grid, row 0 = south: 1 inside an odd number of the rings, else 0.
std::vector<char> nodes_inside(const std::vector<Polyline>& rings, const GridGeometry& grid);

/// One pixel per node of the bed, with relief in grey. Laid over it are colours of both extents, of the simulated one
/// only, of the surveyed one only (colours::hit, beyond, missed).
Pixels painted_overlay(const Raster& bed, const std::vector<Polyline>& simulated,
                       const std::vector<Polyline>& surveyed);

/// All rings of all parts.
std::vector<Polyline> all_rings(const Polygons& polygons);

}  // namespace frana
