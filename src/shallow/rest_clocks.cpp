#include "shallow/rest_clocks.h"

#include <algorithm>
#include <utility>

#include "mpm/stored_points.h"

namespace frana {
namespace {

/// In place of a time: of a node whose material has been faster than what counts as rest.
constexpr double kMoves = -1.0;
constexpr double kRoundOff = 1.0 + 1e-9;  ///< of a speed that stays

}  // namespace

RestClocks::RestClocks(const TileGrid& grid) : rested_(grid.size()), longest_(grid.tiles()), known_(grid.tiles()) {
    tiles_.reserve(static_cast<std::size_t>(grid.tiles()));  // steps allocate nothing
}

void RestClocks::tick(const Flow& flow, double dt, double slowest) {
    for (const Index tile : tiles_)
        if (!flow.active.in_work[tile]) stop(flow.grid, tile, std::exchange(known_[tile], 0)), longest_[tile] = 0.0;
    tiles_.assign(flow.active.work.begin(), flow.active.work.end());
    for_each_work_tile(flow.active, [&](Index, Index tile) { tick_tile(flow, tile, dt, slowest); });
}

void RestClocks::tick_tile(const Flow& flow, Index tile, double dt, double slowest) {
    const NodeGroups in_reach = flow.in_reach[tile];
    stop(flow.grid, tile, std::exchange(known_[tile], in_reach) & ~in_reach);
    double longest = 0.0;
    for_each_node_of(flow.grid, tile, in_reach, [&](Index k, Index, Index) {
        const Motion& after = flow.nodes.motions()[k];
        const double speed2 = after.vx * after.vx + after.vy * after.vy;
        const bool still = after.vx == 0.0 && after.vy == 0.0;  // squares of the smallest speeds are 0
        const bool slow = still || speed2 < slowest * slowest;
        const Pair& before = flow.nodes.before[k];
        const bool driven = !still && speed2 > kRoundOff * (before.x * before.x + before.y * before.y);
        const bool has_begun = !driven || rested_[k] != 0.0;
        if (!(flow.nodes.column_mass[k] > 0.0) || (slow && !has_begun))
            rested_[k] = 0.0;
        else
            rested_[k] = slow ? std::max(rested_[k], 0.0) + dt : kMoves;
        longest = std::max(longest, rested_[k]);
    });
    longest_[tile] = longest;
}

void RestClocks::stop(const TileGrid& grid, Index tile, NodeGroups groups) {
    for_each_node_of(grid, tile, groups, [&](Index k, Index, Index) { rested_[k] = 0.0; });
}

void RestClocks::begin(const TileGrid& grid, Index tile, bool anew) {
    for_each_node_of(grid, tile, known_[tile], [&](Index k, Index, Index) {
        if (anew || rested_[k] < 0.0) rested_[k] = 0.0;
    });
}

void RestClocks::stop_all(const TileGrid& grid) {
    for (const Index tile : tiles_) stop(grid, tile, std::exchange(known_[tile], 0)), longest_[tile] = 0.0;
    tiles_.clear();
}

void RestClocks::take_over(const RestClocks& from, const TileGrid& part, const TileGrid& grid, Index east,
                           Index north) {
    for (const Index tile : from.tiles_)
        for_each_node_of(part, tile, from.known_[tile], [&](Index k, Index i, Index j) {
            if (from.rested_[k] == 0.0) return;
            const Index a = i + east, b = j + north, to = grid.tile_of_node(a, b);
            if (known_[to] == 0) tiles_.push_back(to);
            known_[to] |= group_of((a + kTile) % kTile, (b + kTile) % kTile);
            rested_[grid.at(a, b)] = from.rested_[k];
        });
}

void RestClocks::serialize(Archive& archive, const Flow& flow) {
    const Archive::Part part(archive, "rest");
    std::vector<std::uint64_t> groups;
    std::vector<double> rested;
    if (archive.loading()) stop_all(flow.grid);
    for (const Index tile : flow.active.work) {
        if (archive.loading()) break;
        groups.push_back(known_[tile]);
        for_each_node_of(flow.grid, tile, known_[tile], [&](Index k, Index, Index) { rested.push_back(rested_[k]); });
    }
    archive.array("groups", groups);
    archive.array("rested", rested);
    if (!archive.loading()) return;
    std::size_t expected = 0;
    for (const NodeGroups of_tile : groups) expected += 4 * static_cast<std::size_t>(__builtin_popcountll(of_tile));
    if (groups.size() != flow.active.work.size() || rested.size() != expected)
        throw misfit("its nodes are not those at rest");
    const double* from = rested.data();
    for (std::size_t n = 0; n < groups.size(); ++n) {
        const Index tile = flow.active.work[n];
        known_[tile] = groups[n];
        for_each_node_of(flow.grid, tile, groups[n], [&](Index k, Index, Index) { rested_[k] = *from++; });
    }
    tiles_.assign(flow.active.work.begin(), flow.active.work.end());
}

}  // namespace frana
