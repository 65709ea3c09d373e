#include "solid3d/material_points.h"

#include <algorithm>

namespace frana {
namespace {

/// Tiles of one colour do not lie side by side.
Index colour_of(const std::array<Index, 3>& place) { return place[0] % 2 + 2 * (place[1] % 2) + 4 * (place[2] % 2); }

}  // namespace

void Sorter3d::sort(MaterialPoints& points, const Grid3d& grid, const std::vector<std::uint8_t>& gone,
                    ActiveTiles& active) {
    const auto first = [](double x) { return static_cast<Index>(std::floor(x - 0.5)); };
    order_.find_tiles(points.count(), grid.tiles(), [&](Index p) {
        if (!gone.empty() && gone[static_cast<std::size_t>(p)]) return Index{-1};
        return grid.tile_of(first(points.x[0][p]), first(points.x[1][p]), first(points.x[2][p]));
    });
    order_.lay_out(active);
    fields_.clear();
    points.each([&](Array& array) { fields_.push_back(&array); });
    fields_.push_back(&points.id);
    order_.permute(fields_);
    list_tiles(grid, active);
}

void Sorter3d::list_tiles(const Grid3d& grid, ActiveTiles& active) {
    constexpr std::size_t kAdjacentTiles = 26;
    active.turns.begin(active.tile, grid.tiles(), kAdjacentTiles);
    active.in_work.resize(static_cast<std::size_t>(grid.tiles()));
    for (const Index tile : active.work) active.in_work[tile] = 0;
    active.work.clear();
    for (Index n = 0; n < active.count(); ++n) {
        const std::array<Index, 3> place = grid.tile_place(active.tile[n]);
        const Index colour = colour_of(place);
        active.turns.add(colour);
        for (Index dz = -1; dz <= 1; ++dz)
            for (Index dy = -1; dy <= 1; ++dy)
                for (Index dx = -1; dx <= 1; ++dx) {
                    const std::array<Index, 3> next = {place[0] + dx, place[1] + dy, place[2] + dz};
                    bool inside = true;
                    for (int axis = 0; axis < 3; ++axis)
                        inside = inside && next[axis] >= 0 && next[axis] < grid.tiles_along(axis);
                    if (!inside) continue;
                    if (colour_of(next) < colour) active.turns.wait_for(grid.tile_at(next), active.tile);
                    if (active.in_work[grid.tile_at(next)]) continue;
                    active.in_work[grid.tile_at(next)] = 1;
                    active.work.push_back(grid.tile_at(next));
                }
    }
    active.turns.end();
    std::sort(active.work.begin(), active.work.end());
}

}  // namespace frana
