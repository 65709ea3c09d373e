#include "water/water_block.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "water/held_side.h"

namespace frana {
namespace {

/// A side of the grid, seen from the cells before it.
struct Side {
    std::size_t number;  ///< 0 to 3
    double* normal;      ///< velocities of the block across it [m/s]
    double outward;      ///< 1 or -1
};

/// Speed of the last cell's water out of the grid [m/s].
double outwards(const Side& side, Index inside) { return side.outward * side.normal[inside]; }

/// Even water beyond a side, over ground as high as that of the last cell. What comes in goes straight.
void fill_beyond(WaterBlock& block, const Side& side, const AtSide& has, Index inside, Index step, Index room) {
    double* const along = side.normal == block.u ? block.v : block.u;
    const double surface = (block.surface[inside] - block.depth[inside]) + has.depth;
    for (Index n = 1; n <= std::min(kHalo, room); ++n) {
        const Index to = inside - n * step;
        block.depth[to] = has.depth, block.surface[to] = surface;
        side.normal[to] = side.outward * has.out, along[to] = has.out > 0.0 ? along[inside] : 0.0;
        block.normal_gravity[to] = block.normal_gravity[inside];
    }
}

/// A lake at its level. One that goes on is at rest: waves that reach it go on. One that is held takes what flows out of the
/// grid, and what flows in has its energy.
void lake_beyond(const WaterBody& body, WaterBlock& block, const Side& side, Index inside, Index step, Index room) {
    const double depth = body.lakes[side.number] - (block.surface[inside] - block.depth[inside]);
    const bool held = body.sides[side.number] == WaterSide::level;
    fill_beyond(block, side,
                held ? at_side(block.depth[inside], outwards(side, inside), depth, block.normal_gravity[inside])
                     : AtSide{depth, 0.0},
                inside, step, room);
}

/// Water that leaves by a free side has the depth and the speed of the cell before the last one. In steady flow nothing
/// then changes towards the side. Where both cells differ by more than kEven, as at a bore or on rough ground, by that
/// much.
void even_out(WaterBlock& block, const Side& side, Index inside, Index step, Index room) {
    constexpr double kEven = 0.1;
    const auto nearer = [&](double last, double before) {
        const double most = kEven * std::abs(last);
        return last + std::clamp(before - last, -most, most);
    };
    const double depth = nearer(block.depth[inside], block.depth[inside + step]),
                 speed = nearer(side.normal[inside], side.normal[inside + step]);
    for (Index n = 1; n <= std::min(kHalo, room); ++n) {
        const Index to = inside - n * step;
        block.surface[to] += depth - block.depth[to], block.depth[to] = depth, side.normal[to] = speed;
    }
}

/// Water at a side where the ground ends, or with lower water beyond. Slower than waves it falls there, from its critical
/// depth. Nothing where that is less than its fall over ground that goes on: then it leaves as it flows. With a bed law
/// friction holds what stands, and only what moves leaves. `fall`: of the ground over the last cell [m].
std::optional<AtSide> over_the_edge(const WaterBody& body, const WaterBlock& block, const Side& side, Index inside,
                                    double fall) {
    const WaterSide is = body.sides[side.number];
    if (body.bed_laws || (is != WaterSide::open && is != WaterSide::level)) return {};
    const double h = block.depth[inside], out = outwards(side, inside);
    const AtSide edge = at_side(h, out, 0.0, block.normal_gravity[inside]);
    if (out > 0.0 && h - edge.depth <= fall) return {};
    return edge;
}

/// What lies beyond a side, from the cells before it: `inside` is the last cell, `step` leads into the grid.
/// A wall is a mirror, and so is a side that water does not leave by. Where it does, the ground goes on
/// as it falls, or level, with water as deep and as fast, or the water falls. `room`: cells the block has.
void beyond(const WaterBody& body, WaterBlock& block, const Side& side, Index inside, Index step, Index room) {
    if (meets_lake(body, block, inside, side.number)) return lake_beyond(body, block, side, inside, step, room);
    const auto ground = [&](Index k) { return block.surface[k] - block.depth[k]; };
    const double fall = std::max(0.0, ground(inside + step) - ground(inside));
    if (const auto edge = over_the_edge(body, block, side, inside, fall))
        return fill_beyond(block, side, *edge, inside, step, room);
    const double out = outwards(side, inside);
    const bool free = body.sides[side.number] == WaterSide::free,
               leaves = body.sides[side.number] != WaterSide::wall && (out > 0.0 || (free && out == 0.0 && fall > 0.0));
    for (Index n = 1; n <= std::min(kHalo, room); ++n) {
        const Index to = inside - n * step, from = leaves ? inside : inside + (n - 1) * step;
        block.depth[to] = block.depth[from], block.u[to] = block.u[from], block.v[to] = block.v[from];
        block.surface[to] = block.surface[from], block.normal_gravity[to] = block.normal_gravity[from];
        if (leaves)
            block.surface[to] -= static_cast<double>(n) * fall;
        else
            side.normal[to] = -side.normal[to];
    }
    if (leaves && free) even_out(block, side, inside, step, room);
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
    if (a0 > 0) beyond(body, block, {0, block.u, -1.0}, row + a0, 1, a0);
    if (a1 < kRows) beyond(body, block, {1, block.u, 1.0}, row + a1 - 1, -1, kRows - a1);
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
        if (b0 > 0) beyond(body, block, {2, block.v, -1.0}, b0 * kRow + a, kRow, b0);
        if (b1 < kRows) beyond(body, block, {3, block.v, 1.0}, (b1 - 1) * kRow + a, -kRow, kRows - b1);
    }
    double deepest = 0.0;
    for (Index b = 0; b < std::min(kRows, b1 + kHalo); ++b)
        for (Index a = 0; a < kRows; ++a) deepest = std::max(deepest, block.depth[b * kRow + a]);
    return deepest > 0.0;
}

}  // namespace frana
