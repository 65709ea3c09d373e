#pragma once
// Which nodes of a tile matter. A tile of near-empty ground costs next to nothing when loops visit marked nodes only.
#include <array>
#include <cstdint>

#include "base/simd.h"
#include "mpm/tile_grid.h"

namespace frana {

/// Groups of four nodes in a row of a tile: bit 4 * row + column / 4.
using NodeGroups = std::uint64_t;
constexpr NodeGroups kAllGroups = ~NodeGroups{0};
static_assert(kTile == 16, "a tile has 64 groups");

inline NodeGroups group_of(Index column, Index row) { return NodeGroups{1} << (4 * row + column / 4); }

/// What a tile's points reach. It is groups of the tile itself (4) and its eight neighbours, row by row from the lower left.
using TileReach = std::array<NodeGroups, 9>;

/// The nodes at which stencils of a tile's points begin, up to half a tile outside of it.
class StencilMarks {
public:
    /// The tile's first node is (i, j), counted from the storage's first, as the marks are.
    StencilMarks(Index i, Index j) : i_(static_cast<unsigned>(i - kSpare)), j_(static_cast<unsigned>(j - kSpare)) {}
    void mark(std::int32_t i, std::int32_t j) {
        row_[(static_cast<unsigned>(j) - j_) & 31u] |= 1u << ((static_cast<unsigned>(i) - i_) & 31u);
    }
    /// The first `lanes` of four.
    void mark(Int4 i, Int4 j, int lanes) {
        const Int4 row = (j - static_cast<std::int32_t>(j_)) & 31;
        const Int4 bit = Int4{1, 1, 1, 1} << ((i - static_cast<std::int32_t>(i_)) & 31);
        for (int n = 0; n < lanes; ++n) row_[row[n]] |= static_cast<std::uint32_t>(bit[n]);
    }
    /// All groups with a node from `before` nodes before a mark to `after` nodes behind it. In x and in y, both < 8.
    TileReach reach(int before, int after) const {
        TileReach reach{};
        constexpr int kEdge = kTile;
        for (int row = -kEdge; row < 2 * kEdge; ++row) {
            std::uint64_t marks = 0;
            for (int j = row - after; j <= row + before; ++j)
                if (j >= -kSpare && j < 32 - kSpare) marks |= row_[j + kSpare];
            if (marks == 0) continue;
            std::uint64_t nodes = 0;  // bit 0 is the first node of the tile to the left
            for (int shift = -before; shift <= after; ++shift) nodes |= marks << (kEdge - kSpare + shift);
            const int across = (row + kEdge) / kEdge * 3, line = 4 * ((row + kEdge) % kEdge);
            NodeGroups* const three = &reach[static_cast<std::size_t>(across)];
            for (int tile = 0; tile < 3; ++tile) three[tile] |= in_fours(nodes >> (tile * kEdge)) << line;
        }
        return reach;
    }

private:
    static constexpr int kSpare = 8;
    /// Four bits that tell whether any of four, from the first sixteen.
    static NodeGroups in_fours(std::uint64_t nodes) {
        nodes |= nodes >> 1;
        nodes = (nodes | nodes >> 2) & 0x1111u;
        return (nodes | nodes >> 3 | nodes >> 6 | nodes >> 9) & 0xfu;
    }
    unsigned i_, j_;
    std::uint32_t row_[32] = {};
};

/// Groups of a tile grown by three rows and one group (four nodes) each way. `around` has the tile (4) and its eight
/// neighbours.
inline NodeGroups grown(const TileReach& around) {
    const auto sideways = [&](std::size_t middle) {
        constexpr NodeGroups kFirst = 0x1111111111111111u, kLast = 0x8888888888888888u;
        const NodeGroups here = around[middle];
        return here | (here & ~kLast) << 1 | (here & ~kFirst) >> 1 | (around[middle - 1] & kLast) >> 3 |
               (around[middle + 1] & kFirst) << 3;
    };
    const NodeGroups below = sideways(1), here = sideways(4), above = sideways(7);
    return here | here << 4 | here << 8 | here << 12 | here >> 4 | here >> 8 | here >> 12 |  //
           below >> 60 | below >> 56 | below >> 52 | above << 60 | above << 56 | above << 52;
}

/// Calls body(storage index, i, j) for the first node of each of the groups of a tile.
template <class Body>
void for_each_four_of(const TileGrid& grid, Index tile, NodeGroups groups, Body&& body) {
    const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile), k0 = grid.at(i0, j0);
    for (; groups != 0; groups &= groups - 1) {
        const Index n = __builtin_ctzll(groups), column = 4 * (n % 4), row = n / 4;
        body(k0 + row * grid.stride() + column, i0 + column, j0 + row);
    }
}

/// Calls body(place in the run, storage index, i, j) for the first node of each group of groups_of(tile), row by row.
/// The groups of one tile come in the order of for_each_four_of.
template <class GroupsOf, class Body>
void for_each_four_of_run(const TileGrid& grid, const TileRun& run, GroupsOf&& groups_of, Body&& body) {
    std::array<NodeGroups, kRunTiles> groups;
    NodeGroups rows = 0;
    for (Index n = 0; n < run.count; ++n) rows |= groups[static_cast<std::size_t>(n)] = groups_of(run.tile[n]);
    if (rows == 0) return;
    const Index i0 = grid.tile_i(run.tile[0]), j0 = grid.tile_j(run.tile[0]), k0 = grid.at(i0, j0);
    for (Index row = 0; row < kTile; ++row)
        for (Index n = 0; n < run.count; ++n)
            for (unsigned of_row = groups[static_cast<std::size_t>(n)] >> (4 * row) & 0xf; of_row != 0;
                 of_row &= of_row - 1) {
                const Index along = n * kTile + Index{4} * __builtin_ctz(of_row);
                body(n, k0 + row * grid.stride() + along, i0 + along, j0 + row);
            }
}

/// The same for each node of the groups.
template <class Body>
void for_each_node_of(const TileGrid& grid, Index tile, NodeGroups groups, Body&& body) {
    for_each_four_of(grid, tile, groups, [&](Index k, Index i, Index j) {
        for (Index n = 0; n < 4; ++n) body(k + n, i + n, j);
    });
}

}  // namespace frana
