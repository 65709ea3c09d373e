#pragma once
// Where 3D points have been drawn apart so far that one of them has to stand for two.
#include <vector>

#include "solid3d/material_points.h"

namespace frana {

/// A point that becomes two, at x - way and x + way.
struct SplitPoint {
    Index point;
    Vec3 way;  ///< [cells]
};

/// Points with a gap of 0.8 to 1.75 cells to the nearest in one of six directions. That one does not come closer. Half of
/// such a point still has 1/64 of a cell's volume without stress. In their order. `gone`: as of Sorter3d::sort.
std::vector<SplitPoint> points_to_split(const MaterialPoints& points, const Grid3d& grid,
                                        const std::vector<std::uint8_t>& gone);

}  // namespace frana
