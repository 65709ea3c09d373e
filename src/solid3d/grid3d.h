#pragma once
// The background 3D grid: nodes in tiles of 8 x 8 x 8. A ring of spare tiles is around the domain. Each tile is one
// stretch of memory. As in the plane (mpm/tile_grid.h), only tiles near material are ever used.
#include <array>
#include <cmath>
#include <vector>

#include "mpm/tile_grid.h"

namespace frana {

constexpr Index kTile3d = 8;                               ///< nodes along a tile's edge
constexpr Index kTileNodes = kTile3d * kTile3d * kTile3d;  ///< nodes of a tile

/// A box of nodes, node (0, 0, 0) at `origin`.
struct GridGeometry3d {
    Vec3 origin{0, 0, 0};          ///< [m]
    double cell = 1.0;             ///< [m]
    std::array<Index, 3> nodes{};  ///< in x, y and z
};

/// Maps nodes and tiles to storage. The storage index of node (i, j, k) is place(0, i) + place(1, j) +
/// place(2, k). It is a sum of three numbers, so a point finds its 27 nodes by 9 look-ups. Positions are measured in
/// cells from node (0, 0, 0).
class Grid3d {
public:
    explicit Grid3d(const GridGeometry3d& geometry) : geometry_(geometry) {
        Index stride = 1;
        for (int axis = 0; axis < 3; ++axis) {
            tiles_[axis] = (geometry.nodes[axis] + kTile3d - 1) / kTile3d + 2;
            tile_stride_[axis] = stride;
            stride *= tiles_[axis];
        }
        Index within = 1;
        for (int axis = 0; axis < 3; ++axis, within *= kTile3d) {
            places_[axis].resize(static_cast<std::size_t>(tiles_[axis] * kTile3d));
            for (Index n = 0; n < tiles_[axis] * kTile3d; ++n)
                places_[axis][n] = n / kTile3d * tile_stride_[axis] * kTileNodes + n % kTile3d * within;
        }
    }
    const GridGeometry3d& geometry() const { return geometry_; }
    double cell() const { return geometry_.cell; }
    Index tiles() const { return tile_stride_[2] * tiles_[2]; }
    Index tiles_along(int axis) const { return tiles_[axis]; }
    Index size() const { return tiles() * kTileNodes; }

    /// Share of the storage index of nodes n, n + 1, ... along an axis; n from -kTile3d on.
    const Index* place(int axis, Index n) const { return places_[axis].data() + n + kTile3d; }
    Index at(Index i, Index j, Index k) const { return *place(0, i) + *place(1, j) + *place(2, k); }

    /// Tile of a point's first node.
    Index tile_of(Index i, Index j, Index k) const {
        return (i + kTile3d) / kTile3d + (j + kTile3d) / kTile3d * tile_stride_[1] +
               (k + kTile3d) / kTile3d * tile_stride_[2];
    }
    /// Place of a tile in the box of tiles.
    std::array<Index, 3> tile_place(Index tile) const {
        return {tile % tiles_[0], tile / tile_stride_[1] % tiles_[1], tile / tile_stride_[2]};
    }
    Index tile_at(const std::array<Index, 3>& place) const {
        return place[0] + place[1] * tile_stride_[1] + place[2] * tile_stride_[2];
    }
    /// First node of a tile along an axis.
    Index first_node(Index place) const { return (place - 1) * kTile3d; }
    /// Whether all nodes n to n + 2 along each axis have storage.
    bool holds(const std::array<Index, 3>& first) const {
        for (int axis = 0; axis < 3; ++axis)
            if (first[axis] < -kTile3d || first[axis] + 3 > (tiles_[axis] - 1) * kTile3d) return false;
        return true;
    }

private:
    GridGeometry3d geometry_;
    std::array<Index, 3> tiles_{}, tile_stride_{};
    std::array<std::vector<Index>, 3> places_;
};

}  // namespace frana
