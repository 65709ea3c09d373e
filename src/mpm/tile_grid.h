#pragma once
// The background grid: nodes stored row-major in tiles of 16 x 16. A ring of spare tiles is around the domain. Only
// tiles near material are ever used; arrays come zeroed from the system and cost nothing until then.
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "base/types.h"
#include "mpm/tile_turns.h"
#include "terrain/raster.h"

namespace frana {

constexpr Index kTile = 16;   ///< nodes along a tile's edge
constexpr Index kGhosts = 3;  ///< layers of nodes beyond the outer ones that material can reach

/// A pair of numbers per node.
struct Pair {
    double x, y;
};

/// A zeroed array whose untouched pages take no memory. `guard` numbers before the first and behind the last may be read:
/// they are zero. Numbers are aligned for their type, which calloc alone does not promise beyond 16 bytes.
template <class T>
class LazyArray {
public:
    LazyArray() = default;
    explicit LazyArray(Index count, Index guard = 0) : count_(count) {
        const std::size_t bytes = static_cast<std::size_t>(count + 2 * guard) * sizeof(T);
        std::size_t room = bytes + alignof(T);
        block_ = zeroed(room);
        void* start = block_.get();
        first_ = static_cast<T*>(std::align(alignof(T), bytes, start, room)) + guard;
    }
    T& operator[](Index k) { return first_[k]; }
    const T& operator[](Index k) const { return first_[k]; }
    T* data() { return first_; }
    const T* data() const { return first_; }
    Index count() const { return count_; }
    explicit operator bool() const { return count_ > 0; }

private:
    struct Free {
        std::size_t mapped = 0;  ///< bytes that the system gave by itself; 0: of the heap
        void operator()(void* p) const { mapped > 0 ? static_cast<void>(::munmap(p, mapped)) : std::free(p); }
    };
    using Block = std::unique_ptr<void, Free>;

    /// A large block is allocated without its pages being set aside. Linux refuses more than the machine has otherwise,
    /// even where next to none of it will be used.
    static Block zeroed(std::size_t bytes) {
        constexpr std::size_t large = std::size_t{1} << 26;
        if (bytes < large) {
            Block block(std::calloc(bytes, 1));
            return block ? std::move(block) : throw std::bad_alloc();
        }
        void* pages =
            ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc();
        return Block(pages, Free{bytes});
    }

    Block block_;
    T* first_ = nullptr;
    Index count_ = 0;
};

/// Maps nodes, cells and tiles to storage. Node (i, j), i in [-kTile, nx + kGhosts), has storage index
/// at(i, j); positions are measured in cells from node (0, 0).
class TileGrid {
public:
    explicit TileGrid(const GridGeometry& geometry)
        : geometry_(geometry),
          tiles_x_((geometry.nx + kGhosts + kTile - 1) / kTile + 2),
          tiles_y_((geometry.ny + kGhosts + kTile - 1) / kTile + 2),
          stride_(tiles_x_ * kTile) {
        if ((stride_ / kTile) % 2 == 0) stride_ += kTile;  // an odd multiple of 16 avoids aliasing in the caches
    }
    const GridGeometry& geometry() const { return geometry_; }
    Index nx() const { return geometry_.nx; }
    Index ny() const { return geometry_.ny; }
    double cell() const { return geometry_.cell; }
    Index stride() const { return stride_; }
    Index size() const { return stride_ * tiles_y_ * kTile; }
    Index at(Index i, Index j) const { return (j + kTile) * stride_ + i + kTile; }

    /// The node whose cell holds (x, y) [cells].
    Index nearest(double x, double y) const {
        return at(static_cast<Index>(std::floor(x + 0.5)), static_cast<Index>(std::floor(y + 0.5)));
    }

    Index tiles_x() const { return tiles_x_; }
    Index tiles() const { return tiles_x_ * tiles_y_; }
    /// Tile that a particle at (x, y) [cells] belongs to: the one of its stencil's first node.
    Index tile_of(double x, double y) const {
        const Index i = static_cast<Index>(std::floor(x - 0.5)) + kTile;
        const Index j = static_cast<Index>(std::floor(y - 0.5)) + kTile;
        return (j / kTile) * tiles_x_ + i / kTile;
    }
    /// Tile that node (i, j) is of.
    Index tile_of_node(Index i, Index j) const { return (j + kTile) / kTile * tiles_x_ + (i + kTile) / kTile; }
    Index tile_i(Index tile) const { return (tile % tiles_x_ - 1) * kTile; }  ///< first node of the tile
    Index tile_j(Index tile) const { return (tile / tiles_x_ - 1) * kTile; }

private:
    GridGeometry geometry_;
    Index tiles_x_, tiles_y_, stride_;
};

/// Gathers at rest before a tile sleeps: two rounds of splitting and merging that found nothing to do.
constexpr std::uint8_t kAsleep = 6;

/// Tiles that hold particles (with their ranges), and those tiles grown by one (the work list of node loops). Also
/// whose turn it is to scatter.
struct ActiveTiles {
    std::vector<Index> tile;            ///< ids of tiles with particles, ascending
    std::vector<Index> begin;           ///< first particle of each, and the count at the end
    TileTurns turns;                    ///< of positions in `tile`
    std::vector<Index> work;            ///< ids of tiles with particles and their neighbours, ascending
    std::vector<Index> run;             ///< positions in `work` where runs begin, and the count at the end
    std::vector<std::uint8_t> in_work;  ///< per tile of the domain: 1 when it is on the work list
    std::vector<std::uint8_t> quiet;    ///< per tile of the domain: gathers in a row that left its points at rest

    Index count() const { return static_cast<Index>(tile.size()); }
};

/// Makes `active` whole from its tiles and their ranges: turns, and the work list. colour_of(tile) is the same for no two
/// tiles side by side. each_around(tile, visit) visits a tile and those around it, at most `most_around` besides it.
template <class ColourOf, class EachAround>
void list_work(ActiveTiles& active, Index tiles, std::size_t most_around, ColourOf&& colour_of,
               EachAround&& each_around) {
    active.turns.begin(active.tile, tiles, most_around);
    active.in_work.resize(static_cast<std::size_t>(tiles));
    for (const Index tile : active.work) active.in_work[tile] = 0;
    active.work.clear();
    for (const Index tile : active.tile) {
        const Index colour = colour_of(tile);
        active.turns.add(colour);
        each_around(tile, [&](Index next) {
            if (colour_of(next) < colour) active.turns.wait_for(next, active.tile);
            if (active.in_work[next]) return;
            active.in_work[next] = 1;
            active.work.push_back(next);
        });
    }
    active.turns.end();
    std::sort(active.work.begin(), active.work.end());
}

/// Fewer tiles than this are not worth waking other threads for.
constexpr Index kTilesForThreads = 8;

/// Runs body(position) for the positions of each list, in parallel, list after list.
template <class Lists, class Body>
void for_each_listed(const Lists& lists, bool in_parallel, Body&& body) {
#pragma omp parallel if (in_parallel)
    for (const auto& positions : lists) {
        const Index count = static_cast<Index>(positions.size());
        if (count == 0) continue;
#pragma omp for schedule(dynamic, 1)
        for (Index n = 0; n < count; ++n) body(positions[static_cast<std::size_t>(n)]);
    }
}

/// Runs body(position) for all particle tiles, in parallel; tiles that share nodes have turns in a fixed order.
template <class Body>
void for_each_tile_in_turn(const ActiveTiles& active, Body&& body) {
    active.turns.run(active.count() >= kTilesForThreads, body);
}

/// Runs body(position) for all particle tiles, in parallel; the body writes to its own particles only.
template <class Body>
void for_each_tile(const ActiveTiles& active, Body&& body) {
    const Index count = active.count();
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) body(n);
}

/// Tiles of the work list side by side, at most so many. Loops that go through a run row by row read memory in long
/// stretches. Where arrays do not fit into the caches that is twice as fast as tile by tile.
constexpr Index kRunTiles = 8;
struct TileRun {
    const Index* tile;  ///< their ids
    Index count;
};

/// Runs body(run) for all runs of the work list, in parallel; the body writes to its own nodes only.
template <class Body>
void for_each_work_run(const ActiveTiles& active, Body&& body) {
    const Index count = static_cast<Index>(active.run.size()) - 1;
#pragma omp parallel for schedule(dynamic, 1) if (static_cast <Index>(active.work.size()) >= kTilesForThreads)
    for (Index n = 0; n < count; ++n)
        body(TileRun{active.work.data() + active.run[n], active.run[n + 1] - active.run[n]});
}

/// Runs body(position, tile id) for all tiles of the work list, in parallel; the body writes to its own nodes only.
template <class Body>
void for_each_work_tile(const ActiveTiles& active, Body&& body) {
    const Index count = static_cast<Index>(active.work.size());
#pragma omp parallel for schedule(dynamic, 1) if (count >= kTilesForThreads)
    for (Index n = 0; n < count; ++n) body(n, active.work[static_cast<std::size_t>(n)]);
}

}  // namespace frana
