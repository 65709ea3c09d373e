#pragma once
// The material points of the 3D model: one array per quantity, sorted by tile.
#include <array>

#include "mpm/point_order.h"
#include "mpm/point_set.h"
#include "solid3d/grid3d.h"

namespace frana {

/// Arrays of 3D points. Positions are in cells from node (0, 0, 0); all else is SI. A law has up to six numbers
/// of its own for each point (law/solid/laws.h). Arrays that no law needs are empty.
struct MaterialArrays {
    std::array<Array, 3> x;         ///< position [cells]
    std::array<Array, 3> v;         ///< velocity [m/s]
    std::array<Array, 9> gradient;  ///< of the velocity, dv_k/dx_l at 3 l + k [1/s]
    Array mass;                     ///< [kg]
    Array rest_volume;              ///< without stress [m^3]
    Array j;                        ///< volume over rest_volume [1]
    std::array<Array, 7> state;     ///< of the law
    int states = 0;                 ///< of them in use

    template <class Self, class Visit>
    static void visit_arrays(Self& s, Visit&& visit) {
        for (auto& array : s.x) visit(array);
        for (auto& array : s.v) visit(array);
        for (auto& array : s.gradient) visit(array);
        visit(s.mass), visit(s.rest_volume), visit(s.j);
        for (int n = 0; n < s.states; ++n) visit(s.state[static_cast<std::size_t>(n)]);
    }
};

using MaterialPoints = PointSet<MaterialArrays>;

/// Sorts points by the tile of their first node.
class Sorter3d {
public:
    /// Sorts `points`, without those marked in `gone` (one byte a point, may be empty), and rebuilds
    /// `active`. That has tiles with points in eight colours, and on the work list those and their 26 neighbours.
    void sort(MaterialPoints& points, const Grid3d& grid, const std::vector<std::uint8_t>& gone, ActiveTiles& active);
    /// Makes `active` whole from its tiles and their ranges.
    static void list_tiles(const Grid3d& grid, ActiveTiles& active);
    Index bytes() const { return order_.bytes(); }

private:
    PointOrder order_;
};

}  // namespace frana
