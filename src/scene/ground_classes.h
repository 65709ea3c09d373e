#pragma once
// Classes of ground in tables of snow's friction: flat or convex, open slope, channelled, gully.
#include <array>
#include <cstdint>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// What divides the classes. The table has no published borders: all of these are choices of our own.
struct GroundBorders {
    double length = 50.0;          ///< side of the square that the terrain is averaged over before [m]
    double flat_below_deg = 10.0;  ///< slopes gentler than this are flat
    /// Plan curvatures [1/m] from which on ground is an open slope, channelled, a gully; below the first it is convex.
    std::array<double, 3> curvature{-0.002, 0.002, 0.01};
};

/// Whether squares of that side reach beyond the cell around a node, so that a mean over them is another number [m].
bool averages(double length, double cell);

/// Mean of a raster over squares of that side, row by row and column by column. Of cells that the square cuts a part
/// counts. A node counts only together with its mirror node. So a plane stays what it is up to its edges and to nodata.
Raster smoothed(const Raster& raster, double length);

/// Curvature of the contour at a node, positive where it is hollow towards the valley. For radius R it is 1/R [1/m]. 0
/// where the ground is level or a neighbour has no elevation.
double plan_curvature(const Raster& bed, Index i, Index j);

/// The class of each node, as numbers of salm::ground_names. Nodes of the outer row have the class of the next one inside.
std::vector<std::uint8_t> ground_classes(const Raster& bed, const GroundBorders& borders);

}  // namespace frana
