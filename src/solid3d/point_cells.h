#pragma once
// 3D points cell by cell, to find their neighbours between steps.
#include <algorithm>
#include <vector>

#include "solid3d/material_points.h"

namespace frana {

/// The cells that have points, in rising order of their keys, and the points of each. Cells are those of points' first
/// nodes: points in cells at most two apart along each axis share a node. Places are in the cells' order.
class PointCells {
public:
    static constexpr Index kReach = 2;  ///< the farthest search for neighbours

    /// Of all points but those marked in `gone` (one byte a point, may be empty).
    PointCells(const MaterialPoints& points, const Grid3d& grid, const std::vector<std::uint8_t>& gone = {});

    Index count() const { return static_cast<Index>(key_.size()); }
    Index points() const { return static_cast<Index>(point_.size()); }
    Index point(Index place) const { return point_[place]; }
    Index begin(Index cell) const { return begin_[cell]; }
    Index end(Index cell) const { return begin_[cell + 1]; }

    /// Calls enough(cell) for those at most `reach` away along each axis, itself too, in their order, until it is true.
    template <class Enough>
    bool any_near(Index cell, Index reach, Enough&& enough) const {
        for (Index k = -reach; k <= reach; ++k)
            for (Index j = -reach; j <= reach; ++j) {
                const Index row = key_[cell] + j * stride_[1] + k * stride_[2];
                auto at = std::lower_bound(key_.begin(), key_.end(), row - reach);
                for (; at != key_.end() && *at <= row + reach; ++at)
                    if (enough(static_cast<Index>(at - key_.begin()))) return true;
            }
        return false;
    }
    /// Calls visit(cell) for all of them.
    template <class Visit>
    void each_near(Index cell, Index reach, Visit&& visit) const {
        any_near(cell, reach, [&](Index near) {
            visit(near);
            return false;
        });
    }

private:
    Index stride_[3] = {1, 1, 1};
    std::vector<Index> key_, begin_, point_;
};

}  // namespace frana
