#pragma once
// The material points of the 3D model: one array per quantity, sorted by tile.
#include <array>

#include "mpm/point_order.h"
#include "solid3d/grid3d.h"

namespace frana {

/// 3D points. Positions are in cells from node (0, 0, 0); all else is SI. A law has up to six numbers
/// of its own for each point (law/solid/laws.h). Arrays that no law needs are empty.
struct MaterialPoints {
    std::array<Array, 3> x;         ///< position [cells]
    std::array<Array, 3> v;         ///< velocity [m/s]
    std::array<Array, 9> gradient;  ///< of the velocity, dv_k/dx_l at 3 l + k [1/s]
    Array mass;                     ///< [kg]
    Array rest_volume;              ///< without stress [m^3]
    Array j;                        ///< volume over rest_volume [1]
    std::array<Array, 7> state;     ///< of the law
    int states = 0;                 ///< of them in use
    std::vector<std::int64_t> id;   ///< constant through sorting

    Index count() const { return static_cast<Index>(mass.size()); }

    /// The one list of floating-point arrays in use, for sorting, growing and serializing.
    template <class Visit>
    void each(Visit&& visit) {
        for (Array& array : x) visit(array);
        for (Array& array : v) visit(array);
        for (Array& array : gradient) visit(array);
        visit(mass), visit(rest_volume), visit(j);
        for (int n = 0; n < states; ++n) visit(state[static_cast<std::size_t>(n)]);
    }
    /// Memory of all of them.
    Index bytes() const {
        Index sum = allocated(mass) + allocated(rest_volume) + allocated(j) + allocated(id);
        const auto add = [&](const auto& arrays) {
            for (const Array& array : arrays) sum += allocated(array);
        };
        add(x), add(v), add(gradient), add(state);
        return sum;
    }
    void resize(Index count) {
        each([&](Array& array) { resize_sparingly(array, static_cast<std::size_t>(count)); });
        resize_sparingly(id, static_cast<std::size_t>(count));
    }
};

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
    std::vector<PointField> fields_;
};

}  // namespace frana
