#pragma once
// From 3D points back to depth-averaged particles and rasters, so that a run can go on depth-averaged behind an
// obstacle.
#include <vector>

#include "convert/solid_points.h"

namespace frana {

/// What stands over the pixels of a grid.
struct GatheredFlow {
    /// One particle per pixel that holds points, row after row from the south-west. It stands at the points' centre of
    /// mass, with their mass, volume and mean horizontal velocity (momentum over mass). depth = volume / pixel area, so
    /// that air between the points is squeezed out. The bed pressure is twice the points' mean over their volume, as
    /// where it is hydrostatic. Bed, and slopes, of the raster at that place; id is the pixel's number. No stress.
    FlowParticles particles;
    std::vector<Index> pixel;     ///< of each particle
    std::vector<double> top;      ///< elevation of its highest point [m]
    std::vector<double> kinetic;  ///< energy in motion relative to the mean and up and down, which is given up [J]
    std::size_t outside = 0;      ///< points beyond the pixels or over unknown bed, left out
    double mass_outside = 0.0;    ///< their mass [kg]
};

/// Bins the points by the pixels of `bed`, half a cell around its nodes. A point on an edge belongs to the pixel
/// north-east of it. Sums are compensated: mass, volume and momentum of a pixel are those of its points to round-off.
GatheredFlow points_to_particles(const SolidPoints& points, const Raster& bed);

/// Depth [m] and velocity [m/s] of all pixels, 0 where there are no points, nodata where the bed is unknown.
struct FlowRasters {
    Raster depth, velocity_x, velocity_y;
};
FlowRasters rasters_of(const GatheredFlow& flow, const Raster& bed);

}  // namespace frana
