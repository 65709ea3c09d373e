#include "solid3d/pieces.h"

#include <algorithm>
#include <numeric>

#include "solid3d/point_cells.h"

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

/// Joins points no farther apart than kLink, by their places.
void link_points(const MaterialPoints& points, const PointCells& cells, Index cell, Index other, Groups& groups) {
    for (Index a = cells.begin(cell); a < cells.end(cell); ++a)
        for (Index b = cells.begin(other); b < cells.end(other); ++b) {
            double distance2 = 0.0;
            for (const Array& x : points.x) {
                const double apart = x[cells.point(a)] - x[cells.point(b)];
                distance2 += apart * apart;
            }
            if (a != b && distance2 <= Pieces::kLink * Pieces::kLink) groups.join(a, b);
        }
}

/// Groups of which the point at a place belongs to that of member(place, its cell).
template <class Member>
Pieces measure(const MaterialPoints& points, const PointCells& cells, Groups& groups, Member&& member) {
    std::vector<double> mass(static_cast<std::size_t>(cells.points()), 0.0);
    double all = 0.0;
    for (Index cell = 0; cell < cells.count(); ++cell)
        for (Index n = cells.begin(cell); n < cells.end(cell); ++n) {
            const double m = points.mass[cells.point(n)];
            mass[groups.of(member(n, cell))] += m, all += m;
        }
    Pieces pieces;
    const auto largest = std::max_element(mass.begin(), mass.end());
    for (auto m = mass.begin(); m != mass.end(); ++m) {
        if (*m > 0.0) ++pieces.count;
        if (m != largest) pieces.apart += *m / all;
    }
    return pieces;
}

}  // namespace

Pieces pieces_of(const MaterialPoints& points, const Grid3d& grid) {
    if (points.count() == 0) return {};
    const PointCells cells(points, grid);
    Groups linked(cells.points()), feeling(cells.count());
    for (Index cell = 0; cell < cells.count(); ++cell) {
        cells.each_near(cell, 1, [&](Index other) {
            if (other <= cell) link_points(points, cells, cell, other, linked);
        });
        cells.each_near(cell, PointCells::kReach, [&](Index other) { feeling.join(cell, other); });
    }
    Pieces pieces = measure(points, cells, linked, [](Index place, Index) { return place; });
    pieces.alone = measure(points, cells, feeling, [](Index, Index cell) { return cell; }).apart;
    return pieces;
}

}  // namespace frana
