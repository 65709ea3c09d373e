#pragma once
// Loops over tiles whose bed changes.
#include <vector>

#include "mpm/tile_grid.h"

namespace frana {

/// Calls body(tile) for those among a tile and its eight neighbours that are of the domain.
template <class Body>
void for_each_around(const TileGrid& grid, Index tile, Body&& body) {
    const Index width = grid.tiles_x(), column = tile % width;
    for (Index dj = -1; dj <= 1; ++dj)
        for (Index di = -1; di <= 1; ++di) {
            const Index to = tile + dj * width + di;
            if (column + di >= 0 && column + di < width && to >= 0 && to < grid.tiles()) body(to);
        }
}

template <class Body>
void for_each_in_parallel(const std::vector<Index>& tiles, Body&& body) {
    const Index count = static_cast<Index>(tiles.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) body(tiles[static_cast<std::size_t>(n)]);
}

}  // namespace frana
