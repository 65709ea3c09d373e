#pragma once
// The nodes that the points of one tile reach, in a block of their own. Rows of three nodes are one stretch of memory
// there, at distances fixed at compile time.
#include "base/simd.h"
#include "solid3d/grid3d.h"

namespace frana {

/// Nodes first to first + count - 1 along each axis.
struct Box3d {
    std::array<Index, 3> first{}, count{};
};

/// Cells that a point may stray from its tile, before it is sorted again.
constexpr Index kStray = 2;

/// On the stack of the thread that works on the tile: 207 KiB. A full tile uses a third to two thirds of it, and of
/// `flip_sums` nothing where velocities are not retained.
class NodeBlock {
public:
    static constexpr Index kSide = kTile3d + 2 + 2 * kStray;
    static constexpr Index kRow = kSide + 1;       ///< odd: rows and planes share no set of the caches
    static constexpr Index kPlane = kSide * kRow;  ///< storage between nodes (i, j, k) and (i, j, k + 1)

    Double4 node[kSide * kPlane];
    Double4 flip_sums[kSide * kPlane];  ///< of transfers that retain velocities (mpm3d.h)
    double mass_j[kSide * kPlane + 1];  ///< rows of three are read as four

    static bool holds(const Box3d& box) {
        return box.count[0] <= kSide && box.count[1] <= kSide && box.count[2] <= kSide;
    }
    template <bool averages, bool flip>
    void clear(const Box3d& box) {
        each_row(box, [&](Index, Index, Index at) {
            std::fill_n(node + at, box.count[0], Double4{});
            if constexpr (flip) std::fill_n(flip_sums + at, box.count[0], Double4{});
            // One more: the fourth of the last row's.
            if constexpr (averages && !flip) std::fill_n(mass_j + at, box.count[0] + 1, 0.0);
        });
    }
    /// Adds the block to the grid's nodes, four numbers each.
    template <bool averages, bool flip, class Node>
    void add_to(const Grid3d& grid, const Box3d& box, Node* nodes, Node* flip_nodes, double* mass_of_j) const {
        static_assert(sizeof(Node) == sizeof(Double4), "a node is four numbers");
        each_row(box, [&](Index j, Index k, Index at) {
            const Index row = *grid.place(1, j) + *grid.place(2, k);
            const Index* const along = grid.place(0, box.first[0]);
            for (Index i = 0; i < box.count[0]; ++i) {
                Node* const to = nodes + row + along[i];
                store(to, load(to) + node[at + i]);
                if constexpr (flip) {
                    Node* const also = flip_nodes + row + along[i];
                    store(also, load(also) + flip_sums[at + i]);
                } else if constexpr (averages) {
                    mass_of_j[row + along[i]] += mass_j[at + i];
                }
            }
        });
    }
    /// Takes the grid's nodes.
    template <bool flip, class Node>
    void take(const Grid3d& grid, const Box3d& box, const Node* nodes, const Node* flip_nodes) {
        static_assert(sizeof(Node) == sizeof(Double4), "a node is four numbers");
        each_row(box, [&](Index j, Index k, Index at) {
            const Index row = *grid.place(1, j) + *grid.place(2, k);
            const Index* const along = grid.place(0, box.first[0]);
            for (Index i = 0; i < box.count[0]; ++i) {
                node[at + i] = load(nodes + row + along[i]);
                if constexpr (flip) flip_sums[at + i] = load(flip_nodes + row + along[i]);
            }
        });
    }

private:
    /// visit(j, k, storage index of the row's first node)
    template <class Visit>
    static void each_row(const Box3d& box, Visit&& visit) {
        for (Index k = 0; k < box.count[2]; ++k)
            for (Index j = 0; j < box.count[1]; ++j) visit(box.first[1] + j, box.first[2] + k, k * kPlane + j * kRow);
    }
};

}  // namespace frana
