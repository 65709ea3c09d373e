#pragma once
// Material whose room a barrier's ramp takes, as the ground of columns, moved to what stands before it.
#include <utility>
#include <vector>

#include "base/types.h"
#include "solid3d/mpm3d.h"
#include "terrain/raster.h"

namespace frana {

/// Cells of the terrain that no barrier raises, with the points that stand in them, and what is moved there. It goes
/// on from cell to cell until none has more than a few percent of its own, and no farther. So a lake keeps its level,
/// and far from the barrier nothing changes. Mass, momentum and energy are conserved to round-off.
class Displaced {
public:
    explicit Displaced(const GridGeometry& grid)
        : grid_(grid), number_(static_cast<std::size_t>(grid.size()), Index{-1}) {}

    /// A point that stays there, with the elevation of the ground below it [m].
    void stay(const DepartedPoint& point, Index node, double ground);
    /// Whether anything stays in a node's cell.
    bool holds(Index node) const { return number_[static_cast<std::size_t>(node)] >= 0; }
    /// Moves a share of a point [1] to a node's cell, which holds something.
    void move(const DepartedPoint& point, double share, Index node);
    /// Lets all that was moved spread.
    void spread();
    /// A point that stays in a node's cell, with its part of what was moved there.
    DepartedPoint joined(DepartedPoint point, Index node) const;

private:
    struct Load {
        double mass = 0.0, energy = 0.0;
        double level = 0.0;  ///< mass times the surface where it was moved to [kg m]
        Vec2 momentum{0, 0};

        void add(const Load& from, double share);
    };
    struct Cell {
        Index node = 0;
        double own = 0.0;                   ///< mass that stays [kg]
        double surface = 0.0, depth = 0.0;  ///< of that; times that mass until spread() [m]
        Load load;
    };
    std::vector<std::pair<Index, Index>> borders() const;
    double share_passing(const Cell& from, const Cell& to) const;

    GridGeometry grid_;
    std::vector<Index> number_;  ///< of each node's cell in `cells_`, or -1
    std::vector<Cell> cells_;
};

}  // namespace frana
