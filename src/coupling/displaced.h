#pragma once
// Material whose room a barrier's ramp takes, as the ground of particles, moved to what stands before it.
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "base/types.h"
#include "solid3d/mpm3d.h"
#include "terrain/raster.h"

namespace frana {

/// Cells of the terrain that no barrier raises, with the points that stand in them, and what is moved there. It goes
/// on from cell to cell until none has more than a few percent of its own, and no farther. So a lake keeps its level,
/// and far from the barrier nothing changes. On a slope it lies level, as water would. What was moved to dry ground
/// goes on until it lies no higher than it was. Mass, momentum and energy are conserved to round-off.
class Displaced {
public:
    using GroundOf = std::function<double(Index node)>;

    /// Density [kg/m^3], and the ground of each node's cell [m], NaN where nothing may stand.
    Displaced(const GridGeometry& grid, double density, GroundOf ground)
        : grid_(grid),
          density_(density),
          ground_(std::move(ground)),
          number_(static_cast<std::size_t>(grid.size()), Index{-1}) {}

    /// A point that stays there, with the elevation of the ground below it [m].
    void stay(const DepartedPoint& point, Index node, double ground);
    /// Whether anything stays in a node's cell.
    bool holds(Index node) const;
    /// Moves a share of a point [1] to a node's cell. All that stays must be there by then.
    void move(const DepartedPoint& point, double share, Index node);
    /// Lets all that was moved spread. Returns in how many steps.
    int spread();
    /// A point that stays in a node's cell, with its part of what was moved there.
    DepartedPoint joined(DepartedPoint point, Index node) const;
    /// What was moved to cells that hold less than that: four points in each, at a time [s].
    std::vector<DepartedPoint> laid(double time) const;

private:
    struct Load {
        double mass = 0.0, energy = 0.0;
        double level = 0.0;  ///< mass times the surface where it was moved to [kg m]
        double lift = 0.0;   ///< mass times how far above that it was, where the cell was dry or nearly [kg m]
        Vec2 momentum{0, 0};

        void add(const Load& from, double share);
    };
    struct Cell {
        Index node = 0;
        double own = 0.0;                   ///< mass that stays [kg]
        double surface = 0.0, depth = 0.0;  ///< of that [m]
        double per_height = 0.0;            ///< mass of a layer [kg/m]
        Load load;
        Load change;                      ///< in a step
        double rise = 0.0;                ///< of the load [m]
        bool is_listed = false;           ///< among those that spread, also when all of it went on
        std::array<Index, 4> adjacent{};  ///< nodes, or -1

        bool is_high() const;
        bool is_laid() const { return load.mass > own; }
    };
    Index cell_of(Index node, double ground);
    Index open_adjacent(std::size_t cell, Index node);
    std::array<Index, 4> adjacent_to(Index node) const;
    double pass(std::size_t from, double least, std::vector<Index>& loaded);
    static double rise_passing(const Cell& from, const Cell& to);

    GridGeometry grid_;
    double density_;
    GroundOf ground_;
    std::vector<Index> number_;  ///< of each node's cell in `cells_`, or -1
    std::vector<Cell> cells_;
};

}  // namespace frana
