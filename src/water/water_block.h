#pragma once
// A tile of free water copied with three cells around it; sides of the grid become cells.
#include "water/water_flow.h"

namespace frana {

constexpr Index kHalo = 3, kRow = 24, kRows = kTile + 2 * kHalo, kCells = kRow * kRows;
constexpr Index kGroups = 5;  ///< of four that a row is computed in: 16 cells and one or two on either side

using BlockCells = double[kCells];

/// The part of a tile inside of the grid: from place (kHalo, kHalo) of a block on.
struct TilePart {
    Index i0, j0;         ///< node of the tile's first cell
    Index columns, rows;  ///< places behind its last cell
};

/// A tile with its surroundings; place a + kRow b.
struct WaterBlock {
    alignas(32) BlockCells depth;  ///< that moves: 0 for films [m]
    alignas(32) BlockCells surface, u, v, normal_gravity;
};

/// Changes over a cell; of velocities, half of it over the depth.
struct WaterSlopes {
    alignas(32) BlockCells depth, surface, along, across;
};

struct WaterFaces {
    alignas(32) BlockCells mass, along, across, low, high;
};

TilePart part_of(const TileGrid& grid, Index tile);

/// Whether a lake goes on beyond a cell at a side (0 to 3) that is no wall. It stands higher than the ground there,
/// with what is confined on it.
inline bool meets_lake(const WaterBody& body, const WaterBlock& block, Index k, std::size_t side) {
    return body.sides[side] != WaterSide::wall && block.surface[k] - block.depth[k] < body.lakes[side];
}

/// Fills the block; false when no water in it moves.
bool load_block(const WaterBody& body, const WaterFields& from, const TilePart& part, WaterBlock& block);

}  // namespace frana
