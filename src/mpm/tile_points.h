#pragma once
// The points of a tile four at a time, and the nodes that they reach.
#include "mpm/tile_grid.h"

namespace frana {

constexpr int kReachBefore = 1,
              kReachAfter = 3;  ///< nodes that quadratic sub-points touch around the first of a stencil

/// Calls body(first, 4) for fours of points, and body(first, count) for those that are left.
template <class Body>
[[gnu::always_inline]] inline void for_each_four(Index p, Index end, Body&& body) {
    for (; p + 4 <= end; p += 4) body(p, 4);
    if (p < end) body(p, static_cast<int>(end - p));
}

/// Whether sub-points of a tile's points may lie beyond the grid's sides.
inline bool near_side(const TileGrid& grid, Index tile) {
    const Index i = grid.tile_i(tile), j = grid.tile_j(tile);
    return i <= 0 || j <= 0 || i + 2 * kTile > grid.nx() || j + 2 * kTile > grid.ny();
}

/// Calls body(storage index, count) for the rows of nodes that the points of a full tile reach when they have not
/// drifted. No point of another tile of its colour reaches these.
template <class Body>
void for_each_row_of_full(const TileGrid& grid, const ActiveTiles& active, Index n, Body&& body) {
    constexpr Index kFull = 256;  // a tile with fewer points may not need all its nodes
    const Index tile = active.tile[n];
    if (active.begin[n + 1] - active.begin[n] < kFull || near_side(grid, tile)) return;
    const Index i = grid.tile_i(tile) - kReachBefore, j = grid.tile_j(tile) - kReachBefore;
    constexpr Index kReached = kTile + kReachBefore + kReachAfter;
    for (Index row = 0; row < kReached; ++row) body(grid.at(i, j + row), kReached);
}

}  // namespace frana
