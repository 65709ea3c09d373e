#pragma once
// Where a barrier is seen: between the ground and its top.
#include <optional>

#include "terrain/raster.h"

namespace frana {

/// Where a barrier ends upwards: a level top, or one that follows the bed.
struct BarrierTop {
    std::optional<double> level;  ///< elevation [m]
    double height = 0.0;          ///< above the bed, where there is no level [m]
};

/// Elevation between the nodes [m]; outside of the raster that of its nearest place. NaN near nodata.
double elevation_at(const Raster& bed, const Vec2& p);
/// Elevation of a barrier's top there; `otherwise` where the bed has none.
double top_at(const BarrierTop& top, const Raster& bed, const Vec2& p, double otherwise);

}  // namespace frana
