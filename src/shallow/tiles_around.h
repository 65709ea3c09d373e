#pragma once
// Loops over listed tiles, and over a tile and those around it.
#include <type_traits>
#include <vector>

#include "mpm/tile_grid.h"

namespace frana {

/// Calls body(tile) for those of the domain among a tile and its eight neighbours. They come row by row from the lower
/// left. A body of two arguments gets the place too: m of TileReach, 4 for the tile itself.
template <class Body>
void for_each_around(const TileGrid& grid, Index tile, Body&& body) {
    const Index width = grid.tiles_x(), column = tile % width;
    for (Index m = 0; m < 9; ++m) {
        const Index to = tile + (m / 3 - 1) * width + m % 3 - 1, across = column + m % 3 - 1;
        if (across < 0 || across >= width || to < 0 || to >= grid.tiles()) continue;
        if constexpr (std::is_invocable_v<Body, Index, std::size_t>)
            body(to, static_cast<std::size_t>(m));
        else
            body(to);
    }
}

template <class Body>
void for_each_in_parallel(const std::vector<Index>& tiles, Body&& body) {
    const Index count = static_cast<Index>(tiles.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) body(tiles[static_cast<std::size_t>(n)]);
}

}  // namespace frana
