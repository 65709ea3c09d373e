#include "solid3d/material_points.h"

#include <cmath>

namespace frana {

void Sorter3d::sort(MaterialPoints& points, const Grid3d& grid, const std::vector<std::uint8_t>& gone,
                    ActiveTiles& active) {
    const auto first = [](double x) { return static_cast<Index>(std::floor(x - 0.5)); };
    order_.find_tiles(points.count(), grid.tiles(), [&](Index p) {
        if (!gone.empty() && gone[static_cast<std::size_t>(p)]) return Index{-1};
        return grid.tile_of(first(points.x[0][p]), first(points.x[1][p]), first(points.x[2][p]));
    });
    order_.lay_out(active);
    order_.permute_points(points);
    list_tiles(grid, active);
}

void Sorter3d::list_tiles(const Grid3d& grid, ActiveTiles& active) {
    constexpr std::size_t kAdjacentTiles = 26;
    const auto colour_of = [&](Index tile) {
        const std::array<Index, 3> place = grid.tile_place(tile);
        return place[0] % 2 + 2 * (place[1] % 2) + 4 * (place[2] % 2);
    };
    const auto each_around = [&](Index tile, auto&& visit) {
        const std::array<Index, 3> place = grid.tile_place(tile);
        for (Index dz = -1; dz <= 1; ++dz)
            for (Index dy = -1; dy <= 1; ++dy)
                for (Index dx = -1; dx <= 1; ++dx) {
                    const std::array<Index, 3> next = {place[0] + dx, place[1] + dy, place[2] + dz};
                    bool inside = true;
                    for (int axis = 0; axis < 3; ++axis)
                        inside = inside && next[axis] >= 0 && next[axis] < grid.tiles_along(axis);
                    if (inside) visit(grid.tile_at(next));
                }
    };
    list_work(active, grid.tiles(), kAdjacentTiles, colour_of, each_around);
}

}  // namespace frana
