#include "solid3d/point_cells.h"

#include <utility>

namespace frana {

PointCells::PointCells(const MaterialPoints& points, const Grid3d& grid, const std::vector<std::uint8_t>& gone) {
    // Behind each row so many more that neighbours of its ends are not cells of the next.
    for (int axis = 0; axis < 2; ++axis)
        stride_[axis + 1] = stride_[axis] * (grid.geometry().nodes[static_cast<std::size_t>(axis)] + kReach);
    std::vector<std::pair<Index, Index>> order;
    order.reserve(static_cast<std::size_t>(points.count()));
    for (Index p = 0; p < points.count(); ++p) {
        if (!gone.empty() && gone[static_cast<std::size_t>(p)]) continue;
        Index key = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            key += stride_[axis] * static_cast<Index>(std::floor(points.x[axis][p] - 0.5));
        order.emplace_back(key, p);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [key, p] : order) {
        if (key_.empty() || key_.back() != key) {
            key_.push_back(key);
            begin_.push_back(static_cast<Index>(point_.size()));
        }
        point_.push_back(p);
    }
    begin_.push_back(static_cast<Index>(point_.size()));
}

}  // namespace frana
