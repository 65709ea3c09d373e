#include "checks/bench/calibrate.h"

#include <unistd.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "base/error.h"
#include "base/simd.h"
#include "checks/bench/team_clock.h"
#include "mpm/tile_grid.h"

namespace frana::bench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

Index default_array_bytes() {
    constexpr Index kLeastCache = Index{32} << 20, kMost = Index{512} << 20;  // some machines do not tell theirs, some
                                                                              // tell that of all processors together
    const Index cache = std::max<Index>(sysconf(_SC_LEVEL3_CACHE_SIZE), kLeastCache);
    const Index free = sysconf(_SC_AVPHYS_PAGES) * sysconf(_SC_PAGESIZE);
    return std::min({4 * cache, free / 12, kMost});
}

/// Least time of `rounds` runs of a body that every thread of the team enters.
template <class Body>
Lap least(int threads, int rounds, Body&& body) {
    Lap best{kNever, kNever};
    TeamClock clock(threads);
    for (int round = 0; round < rounds; ++round) {
        clock.start();
        body();
        const Lap lap = clock.stop();
        best = {std::min(best.wall, lap.wall), std::min(best.cpu, lap.cpu)};
    }
    return best;
}

struct Triad {
    double cpu_GBps, wall_GBps;
};

Triad triad(int threads, Index bytes, int rounds) {
    const Index count = std::max<Index>(bytes / static_cast<Index>(sizeof(double)), 1);
    // Not initialised here, so that each thread's part of the memory is its own from the first touch on.
    const std::unique_ptr<double[]> store_a(new double[count]), store_b(new double[count]), store_c(new double[count]);
    double *a = store_a.get(), *b = store_b.get(), *c = store_c.get();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (Index n = 0; n < count; ++n) a[n] = 0.0, b[n] = 1.0, c[n] = 2.0;
    const Lap lap = least(threads, rounds, [&] {
#pragma omp parallel for simd schedule(static) num_threads(threads)
        for (Index n = 0; n < count; ++n) a[n] = b[n] + 3.0 * c[n];
    });
    expect(a[0] == 7.0 && a[count - 1] == 7.0, "the triad computed something else");
    const double gigabytes = 24e-9 * static_cast<double>(count);
    return {gigabytes / lap.cpu, gigabytes / lap.wall};
}

/// First nodes of the stencils of `count` particles, four a cell, tile after tile on a square of tiles.
std::vector<Index> touched_nodes(Index count, const TileGrid& grid) {
    constexpr Index kPerTile = 4 * kTile * kTile;
    const Index across = grid.tiles_x() - 2;
    std::vector<Index> first(static_cast<std::size_t>(count));
    for (Index p = 0; p < count; ++p) {
        const Index tile = p / kPerTile, in_tile = p % kPerTile;
        // A particle's neighbour in memory is seldom its neighbour in the tile once material has moved. 37 is odd, so
        // that every cell is met.
        const Index cell = (in_tile * 37) % (kTile * kTile);
        first[p] = grid.at(tile % across * kTile + cell % kTile, tile / across * kTile + cell / kTile);
    }
    return first;
}

Lap node_touch(Index count, int rounds) {
    const Index edge = static_cast<Index>(std::ceil(std::sqrt(static_cast<double>(count) / 4.0)));
    const TileGrid grid(GridGeometry{edge + kTile, edge + kTile, 0.0, 0.0, 1.0});
    const std::vector<Index> first = touched_nodes(count, grid);
    std::vector<Double4> into(static_cast<std::size_t>(grid.size())), from(into.size(), Double4{1.0, 1.0, 1.0, 1.0});
    std::vector<double> seen(static_cast<std::size_t>(count));
    const Index up = grid.stride();
    const Lap lap = least(1, rounds, [&] {
        for (Index p = 0; p < count; ++p)
            for (Index j = 0; j < 3; ++j)
                for (Index i = 0; i < 3; ++i) into[first[p] + j * up + i] += Double4{1.0, 2.0, 3.0, 4.0};
        for (Index p = 0; p < count; ++p) {
            Double4 sum = {};
            for (Index j = 0; j < 3; ++j)
                for (Index i = 0; i < 3; ++i) sum += from[first[p] + j * up + i];
            seen[p] = sum[0] + sum[3];
        }
    });
    expect(seen.front() == 18.0 && seen.back() == 18.0, "the node-touch measurement read something else");
    return lap;
}

}  // namespace

Calibration calibrate(const CalibrationPlan& plan) {
    Calibration result;
    result.array_bytes = plan.array_bytes > 0 ? plan.array_bytes : default_array_bytes();
    for (const int threads : plan.threads) {
        const Triad speed = triad(threads, result.array_bytes, plan.rounds);
        result.triad_GBps[threads] = speed.cpu_GBps;
        result.triad_wall_GBps[threads] = speed.wall_GBps;
    }
    const Lap touch = node_touch(plan.particles, plan.rounds);
    const double per_particle = 1e9 / static_cast<double>(plan.particles);
    result.node_touch_ns = touch.cpu * per_particle;
    result.node_touch_wall_ns = touch.wall * per_particle;
    return result;
}

}  // namespace frana::bench
