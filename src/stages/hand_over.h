#pragma once
// Columns that become points in space.
#include <array>

#include "convert/solid_points.h"
#include "scene/scene.h"
#include "solid/solid_flow.h"

namespace frana {

/// The columns of a frame of the depth-averaged model that stand in marked nodes' cells.
FlowColumns columns_of(const Frame& frame, const Raster& bed, const std::vector<std::uint8_t>& marks);

/// The seeds of a release as columns, at rest or not; those in marked nodes' cells, or without `marks` all, in their order.
FlowColumns columns_of(const Seeds& seeds, const Scene& scene, const std::vector<std::uint8_t>& marks);

/// Each column as n x n of them side by side on the square of its volume / depth, n such that they are about
/// `spacing` apart; fewer where the parts would weigh less than an eighth of a full point. Beds and slopes
/// are those of `bed` below each part. Parts stay within `extent`. Mass, volume and momentum are those of the
/// column.
FlowColumns in_parts(const FlowColumns& columns, double spacing, double widest, const Raster& bed,
                     const std::array<double, 4>& extent);

/// The points of columns (convert/solid_points.h) for the solver.
SolidSeeds seeds_of(const FlowColumns& columns, const SolidStage& stage);

}  // namespace frana
