#include "shallow/particles.h"

#include <omp.h>

#include <algorithm>

namespace frana {

void TileSorter::plan(const Particles& particles, const TileGrid& grid, const std::vector<std::uint8_t>& gone,
                      ActiveTiles& active) {
    order_.find_tiles(particles.count(), grid.tiles(), [&](Index p) {
        if (!gone.empty() && gone[static_cast<std::size_t>(p)]) return Index{-1};
        return grid.tile_of(particles.x[p], particles.y[p]);
    });
    wake(particles.count(), active);
    order_.lay_out(active);
    list_tiles(grid, active);
}

void TileSorter::carry_out(Particles& particles) { order_.permute_points(particles); }

/// Tiles that points leave or enter do not sleep.
void TileSorter::wake(Index count, ActiveTiles& active) {
    if (active.quiet.empty()) return;
    const std::vector<std::int32_t>& key = order_.key();
    const auto wake_tile = [&](Index tile) {
        if (tile < 0) return;
#pragma omp atomic write
        active.quiet[tile] = 0;
    };
    for_each_tile(active, [&](Index n) {
        for (Index p = active.begin[n]; p < active.begin[n + 1]; ++p)
            if (key[p] != active.tile[n]) wake_tile(active.tile[n]), wake_tile(key[p]);
    });
    for (Index p = active.count() > 0 ? active.begin[active.count()] : 0; p < count; ++p) wake_tile(key[p]);
}

void TileSorter::drop(Particles& particles, const std::vector<std::uint8_t>& gone, ActiveTiles& active) {
    order_.retain_places(particles.count(), gone, active);
    order_.close_gaps(particles);
}

void TileSorter::list_tiles(const TileGrid& grid, ActiveTiles& active) {
    constexpr std::size_t kAdjacentTiles = 8;
    const Index width = grid.tiles_x();
    const auto colour_of = [&](Index tile) { return tile / width % 2 * 2 + tile % width % 2; };
    const auto each_around = [&](Index tile, auto&& visit) {
        for (Index dr = -1; dr <= 1; ++dr)
            for (Index dc = -1; dc <= 1; ++dc) {
                const Index column = tile % width + dc, next = tile + dr * width + dc;
                if (column >= 0 && column < width && next >= 0 && next < grid.tiles()) visit(next);
            }
    };
    list_work(active, grid.tiles(), kAdjacentTiles, colour_of, each_around);
    active.quiet.resize(static_cast<std::size_t>(grid.tiles()));
    list_runs(width, active);
}

/// Tiles of a run lie in one row of tiles. With many threads runs are shorter: each thread has two or more.
void TileSorter::list_runs(Index width, ActiveTiles& active) {
    active.run.clear();
    active.run.reserve(active.work.capacity() + 1);
    const Index count = static_cast<Index>(active.work.size()), threads = omp_get_max_threads();
    const Index longest = threads == 1 ? kRunTiles : std::clamp<Index>(count / (2 * threads), 1, kRunTiles);
    for (Index n = 0; n < count; ++n) {
        const Index tile = active.work[n];
        const bool goes_on = n > 0 && tile == active.work[n - 1] + 1 && tile % width != 0;
        if (!goes_on || n - active.run.back() == longest) active.run.push_back(n);
    }
    active.run.push_back(count);
}

}  // namespace frana
