#include "water/water_block.h"

#include <algorithm>

namespace frana {
namespace {

/// The lake at its level, over ground as high as that of the last cell: waves that reach it go on.
void lake_beyond(const WaterBody& body, WaterBlock& block, Index inside, Index step, Index room) {
    const double ground = block.surface[inside] - block.depth[inside];
    for (Index n = 1; n <= std::min(kHalo, room); ++n) {
        const Index to = inside - n * step;
        block.depth[to] = body.level - ground, block.surface[to] = body.level;
        block.u[to] = block.v[to] = 0.0, block.normal_gravity[to] = block.normal_gravity[inside];
    }
}

/// What lies beyond a side, from the cells before it: `inside` is the last cell, `step` leads into the grid.
/// A wall is a mirror, and so is an open side that water does not leave by. Where it does, the ground goes on
/// as it falls, or level, with water as deep and as fast. Where a lake goes on, it is at rest there. `room`: cells the
/// block has.
void beyond(const WaterBody& body, WaterBlock& block, Index inside, Index step, WaterSide side, double* normal,
            double outward, Index room) {
    if (side == WaterSide::open && meets_lake(body, block, inside)) return lake_beyond(body, block, inside, step, room);
    const auto ground = [&](Index k) { return block.surface[k] - block.depth[k]; };
    const double fall = std::max(0.0, ground(inside + step) - ground(inside));
    const bool leaves = side == WaterSide::open && outward * normal[inside] > 0.0;
    for (Index n = 1; n <= std::min(kHalo, room); ++n) {
        const Index to = inside - n * step, from = leaves ? inside : inside + (n - 1) * step;
        block.depth[to] = block.depth[from], block.u[to] = block.u[from], block.v[to] = block.v[from];
        block.surface[to] = block.surface[from], block.normal_gravity[to] = block.normal_gravity[from];
        if (leaves)
            block.surface[to] -= static_cast<double>(n) * fall;
        else
            normal[to] = -normal[to];
    }
}

void load_row(const WaterBody& body, const WaterFields& from, const TilePart& part, Index b, WaterBlock& block) {
    const Index a0 = std::max<Index>(0, kHalo - part.i0), a1 = std::min(kRows, kHalo + body.grid.nx() - part.i0);
    const Index first = body.grid.at(part.i0 - kHalo, part.j0 + b - kHalo), row = b * kRow;
    if (a1 < kRows)
        for (double* cells : {block.depth, block.surface, block.u, block.v, block.normal_gravity})
            std::fill_n(cells + row, kRow, 0.0);
    for (Index a = a0; a < a1; ++a) {
        const double h = from.h[first + a];
        const bool moves = h > body.film;
        const double per = moves ? 1.0 / h : 0.0;
        block.depth[row + a] = moves ? h : 0.0;
        block.surface[row + a] = body.bed[first + a] + body.confined[first + a] + h;
        block.u[row + a] = per * from.qx[first + a], block.v[row + a] = per * from.qy[first + a];
        block.normal_gravity[row + a] = body.normal_gravity[first + a];
    }
    if (a0 > 0) beyond(body, block, row + a0, 1, body.sides[0], block.u, -1.0, a0);
    if (a1 < kRows) beyond(body, block, row + a1 - 1, -1, body.sides[1], block.u, 1.0, kRows - a1);
}

}  // namespace

TilePart part_of(const TileGrid& grid, Index tile) {
    const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
    return {i0, j0, kHalo + std::min(kTile, grid.nx() - i0), kHalo + std::min(kTile, grid.ny() - j0)};
}

bool load_block(const WaterBody& body, const WaterFields& from, const TilePart& part, WaterBlock& block) {
    const Index b0 = std::max<Index>(0, kHalo - part.j0), b1 = std::min(kRows, kHalo + body.grid.ny() - part.j0);
    for (Index b = b0; b < b1; ++b) load_row(body, from, part, b, block);
    for (Index a = 0; a < kRows; ++a) {
        if (b0 > 0) beyond(body, block, b0 * kRow + a, kRow, body.sides[2], block.v, -1.0, b0);
        if (b1 < kRows) beyond(body, block, (b1 - 1) * kRow + a, -kRow, body.sides[3], block.v, 1.0, kRows - b1);
    }
    double deepest = 0.0;
    for (Index b = 0; b < std::min(kRows, b1 + kHalo); ++b)
        for (Index a = 0; a < kRows; ++a) deepest = std::max(deepest, block.depth[b * kRow + a]);
    return deepest > 0.0;
}

}  // namespace frana
