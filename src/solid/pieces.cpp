#include "solid/pieces.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace frana {
namespace {

/// Groups that grow together: of each member the way to its group's first.
class Groups {
public:
    explicit Groups(Index count) : head_(static_cast<std::size_t>(count)) {
        std::iota(head_.begin(), head_.end(), Index{0});
    }
    Index of(Index n) {
        while (head_[n] != n) n = head_[n] = head_[head_[n]];
        return n;
    }
    void join(Index a, Index b) {
        const Index first = of(a), second = of(b);
        head_[std::max(first, second)] = std::min(first, second);
    }

private:
    std::vector<Index> head_;
};

/// Points cell by cell. Cells are those of points' first nodes: what is at most two of them apart shares a node.
class PointCells {
public:
    PointCells(const MaterialPoints& points, const SpaceGrid& grid) : points_(points) {
        // Behind each row so many more that neighbours of its ends are not cells of the next.
        for (int axis = 0; axis < 2; ++axis)
            stride_[axis + 1] = stride_[axis] * (grid.geometry().nodes[static_cast<std::size_t>(axis)] + kReach);
        std::vector<std::pair<Index, Index>> order;
        order.reserve(static_cast<std::size_t>(points.count()));
        for (Index p = 0; p < points.count(); ++p) {
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

    Index count() const { return static_cast<Index>(key_.size()); }

    /// Points by their place in the cells' order.
    Pieces linked_points() const {
        Groups groups(static_cast<Index>(point_.size()));
        for (Index cell = 0; cell < count(); ++cell) {
            join_points(cell, cell, groups);
            each_neighbour(cell, 1, [&](Index other) { join_points(cell, other, groups); });
        }
        return weigh(groups, [&](Index n) { return n; });
    }
    /// Points by the nodes they give to.
    Pieces linked_cells() const {
        Groups groups(count());
        for (Index cell = 0; cell < count(); ++cell)
            each_neighbour(cell, kReach, [&](Index other) { groups.join(cell, other); });
        Index cell = 0;
        return weigh(groups, [&](Index n) {
            while (n >= begin_[cell + 1]) ++cell;
            return cell;
        });
    }

private:
    static constexpr Index kReach = 2;

    /// Cells with points before `cell` in the order, at most so many away along each axis.
    template <class Visit>
    void each_neighbour(Index cell, Index reach, Visit&& visit) const {
        for (Index k = -reach; k <= 0; ++k)
            for (Index j = -reach; j <= (k < 0 ? reach : 0); ++j) {
                const Index row = key_[cell] + j * stride_[1] + k * stride_[2];
                const Index last = j < 0 || k < 0 ? row + reach : row - 1;
                auto at = std::lower_bound(key_.begin(), key_.end(), row - reach);
                for (; at != key_.end() && *at <= last; ++at)
                    visit(static_cast<Index>(at - key_.begin()));
            }
    }
    void join_points(Index cell, Index other, Groups& groups) const {
        for (Index a = begin_[cell]; a < begin_[cell + 1]; ++a)
            for (Index b = begin_[other]; b < begin_[other + 1]; ++b) {
                double distance2 = 0.0;
                for (const Column& x : points_.x) {
                    const double apart = x[point_[a]] - x[point_[b]];
                    distance2 += apart * apart;
                }
                if (a != b && distance2 <= Pieces::kLink * Pieces::kLink) groups.join(a, b);
            }
    }
    /// Groups of which place n of the order belongs to that of member(n); n counts up.
    template <class Member>
    Pieces weigh(Groups& groups, Member&& member) const {
        std::vector<double> mass(point_.size(), 0.0);
        double all = 0.0;
        for (Index n = 0; n < static_cast<Index>(point_.size()); ++n) {
            const double m = points_.mass[point_[n]];
            mass[groups.of(member(n))] += m, all += m;
        }
        Pieces pieces;
        const auto largest = std::max_element(mass.begin(), mass.end());
        for (auto m = mass.begin(); m != mass.end(); ++m) {
            if (*m > 0.0) ++pieces.count;
            if (m != largest) pieces.apart += *m / all;
        }
        return pieces;
    }

    const MaterialPoints& points_;
    Index stride_[3] = {1, 1, 1};
    std::vector<Index> key_;    ///< of each cell with points, rising
    std::vector<Index> begin_;  ///< of each cell's points in point_, and the end
    std::vector<Index> point_;
};

}  // namespace

Pieces pieces_of(const MaterialPoints& points, const SpaceGrid& grid) {
    if (points.count() == 0) return {};
    const PointCells cells(points, grid);
    Pieces pieces = cells.linked_points();
    pieces.alone = cells.linked_cells().apart;
    return pieces;
}

}  // namespace frana
