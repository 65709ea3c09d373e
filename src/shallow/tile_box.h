#pragma once
// A rectangle of nodes of a tile.
#include <algorithm>

#include "mpm/tile_grid.h"

namespace frana {

/// Nodes [i0, i1) x [j0, j1), counted from the tile's first; none to begin with, all bits zero.
struct TileBox {
    Index i0 = 0, i1 = 0, j0 = 0, j1 = 0;

    static TileBox whole() { return {0, kTile, 0, kTile}; }
    bool empty() const { return i0 >= i1 || j0 >= j1; }
    void add(const TileBox& o) {
        if (o.empty()) return;
        if (empty())
            *this = o;
        else
            *this = {std::min(i0, o.i0), std::max(i1, o.i1), std::min(j0, o.j0), std::max(j1, o.j1)};
    }
    /// What of it, grown by `reach` nodes, lies in the tile that is (di, dj) tiles away. It is counted from that one's
    /// first node.
    TileBox seen_from(Index di, Index dj, Index reach) const {
        if (empty()) return {};
        const auto first = [&](Index n, Index away) { return std::max<Index>(n - reach - away * kTile, 0); };
        const auto past = [&](Index n, Index away) { return std::min<Index>(n + reach - away * kTile, kTile); };
        return {first(i0, di), past(i1, di), first(j0, dj), past(j1, dj)};
    }
};

/// The box of one node, (i, j) of the grid.
inline TileBox one_node(const TileGrid& grid, Index tile, Index i, Index j) {
    const Index a = i - grid.tile_i(tile), b = j - grid.tile_j(tile);
    return {a, a + 1, b, b + 1};
}

}  // namespace frana
