#include "shallow/rest.h"

#include <cstring>

#include "shallow/flow.h"
#include "shallow/grid_update.h"
#include "shallow/tiles_around.h"

namespace frana {
namespace {

/// Calls body(tile, m) for the work-list tiles among tile (m = 4) and its eight neighbours (TileReach).
template <class Body>
void for_each_around(const Flow& flow, Index tile, Body&& body) {
    for_each_around(flow.grid, tile, [&](Index to, std::size_t m) {
        if (flow.active.in_work[to]) body(to, m);
    });
}

/// Whether a tile has nodes that walls mirror, or ghosts: these always count as in reach.
bool at_wall(const Flow& flow, Index tile) {
    const auto along = [](Index first, Index nodes) {
        const auto holds = [&](Index wall) { return first <= wall + kGhosts && first + kTile > wall - kGhosts; };
        return holds(0) || holds(nodes - 1);
    };
    return flow.walls &&
           (along(flow.grid.tile_i(tile), flow.grid.nx()) || along(flow.grid.tile_j(tile), flow.grid.ny()));
}

/// Folding adds to wall nodes in place, so what deposits on them deposits anew each step.
bool may_sleep(const Flow& flow, Index tile) {
    bool near_wall = false;
    if (flow.walls)
        for_each_around(flow, tile, [&](Index to, std::size_t) { near_wall = near_wall || at_wall(flow, to); });
    return !near_wall;
}

bool awake(const Flow& flow, Index tile) { return flow.active.quiet[tile] < kAsleep; }

void add_reach(Flow& flow, Index tile, LazyArray<NodeGroups>& groups) {
    for_each_around(flow, tile, [&](Index to, std::size_t m) { groups[to] |= flow.reach[tile][m]; });
}

bool reaches(const Flow& flow, Index tile, const LazyArray<NodeGroups>& groups) {
    bool any = false;
    for_each_around(flow, tile, [&](Index to, std::size_t m) { any = any || (flow.reach[tile][m] & groups[to]); });
    return any;
}

void mark_stencils(Flow& flow, Index n, int before, int after) {
    const Index tile = flow.active.tile[n];
    StencilMarks marks = flow.marks_of(tile);
    for (Index p = flow.active.begin[n]; p < flow.active.begin[n + 1]; ++p)
        marks.mark(static_cast<std::int32_t>(std::floor(flow.particles.x[p] + (kTile - 0.5))),
                   static_cast<std::int32_t>(std::floor(flow.particles.y[p] + (kTile - 0.5))));
    flow.reach[tile] = marks.reach(before, after);
}

/// What the deposits of tiles awake will change: what they reached, and what they reach now.
void find_changes(Flow& flow, int before, int after) {
    Rest& rest = flow.rest;
    for (const Index tile : flow.active.work) {
        if (!rest.known[tile]) rest.changed[tile] = flow.in_reach[tile];  // what it held when it was last here
        if (at_wall(flow, tile)) rest.changed[tile] = kAllGroups;
    }
    for_each_tile(flow.active, [&](Index n) {
        if (awake(flow, flow.active.tile[n])) mark_stencils(flow, n, before, after);
    });
    for (const Index tile : flow.active.tile)
        if (awake(flow, tile)) add_reach(flow, tile, rest.changed);
}

void choose_deposits(Flow& flow) {
    Rest& rest = flow.rest;
    for (const Index tile : flow.active.work) rest.frozen[tile] = 0;
    for (Index n = 0; n < flow.active.count(); ++n) {
        const Index tile = flow.active.tile[n];
        rest.deposits[n] = awake(flow, tile) || reaches(flow, tile, rest.changed);
        if (rest.deposits[n] && !awake(flow, tile)) add_reach(flow, tile, rest.frozen);
    }
    for (const Index tile : flow.active.work) rest.frozen[tile] &= ~rest.changed[tile];
}

void put_aside(Flow& flow) {
    flow.rest.saved.clear();
    for (const Index tile : flow.active.work)
        for_each_four_of(flow.grid, tile, flow.rest.frozen[tile], [&](Index k, Index, Index) {
            SavedGroup& group = flow.rest.saved.emplace_back();
            std::memcpy(group.deposit, flow.nodes.deposits() + k, sizeof group.deposit);
            std::memcpy(group.mass, &flow.nodes.mass[k], sizeof group.mass);
            std::memcpy(group.column_mass, &flow.nodes.column_mass[k], sizeof group.column_mass);
        });
}

void put_back(Flow& flow) {
    const SavedGroup* group = flow.rest.saved.data();
    for (const Index tile : flow.active.work)
        for_each_four_of(flow.grid, tile, flow.rest.frozen[tile], [&](Index k, Index, Index) {
            std::memcpy(flow.nodes.deposits() + k, group->deposit, sizeof group->deposit);
            std::memcpy(&flow.nodes.mass[k], group->mass, sizeof group->mass);
            std::memcpy(&flow.nodes.column_mass[k], group->column_mass, sizeof group->column_mass);
            ++group;
        });
}

void clear(Flow& flow, const LazyArray<NodeGroups>& groups) {
    Deposit* deposits = flow.nodes.deposits();
    for_each_work_run(flow.active, [&](const TileRun& run) {
        const auto groups_of = [&](Index tile) { return groups[tile]; };
        for_each_four_of_run(flow.grid, run, groups_of, [&](Index, Index k, Index, Index) {
            std::memset(deposits + k, 0, 4 * sizeof(Deposit));
            std::memset(&flow.nodes.mass[k], 0, 4 * sizeof(double));
            std::memset(&flow.nodes.column_mass[k], 0, 4 * sizeof(double));
        });
    });
}

void mark_near(Flow& flow) {
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        TileReach around{};
        for_each_around(flow, tile, [&](Index to, std::size_t m) { around[m] = flow.in_reach[to]; });
        flow.near[tile] = grown(around);
    });
}

/// Work lists change between deposits.
void remember_work(Flow& flow) {
    Rest& rest = flow.rest;
    for (const Index tile : rest.work_before) rest.known[tile] = 0;
    for (const Index tile : flow.active.work) rest.known[tile] = 1;
    rest.work_before.assign(flow.active.work.begin(), flow.active.work.end());
}

}  // namespace

bool some_asleep(const Flow& flow) {
    for (const Index tile : flow.active.tile)
        if (!awake(flow, tile)) return true;
    return false;
}

void note_rest(Flow& flow, Index n, bool at_rest) {
    const Index tile = flow.active.tile[n];
    std::uint8_t& quiet = flow.active.quiet[tile];
    if (!at_rest || !flow.scheme.sleep)
        quiet = 0;
    else if (quiet + 1 < kAsleep || (flow.rest.settled && may_sleep(flow, tile)))
        quiet = std::min<std::uint8_t>(quiet + 1, kAsleep);
}

void choose_gathers(Flow& flow) {
    Rest& rest = flow.rest;
    rest.gathers.assign(static_cast<std::size_t>(flow.active.count()), 1);
    if (!rest.some_asleep) return;
    for (Index n = 0; n < flow.active.count(); ++n) {
        const Index tile = flow.active.tile[n];
        rest.gathers[n] = awake(flow, tile) || reaches(flow, tile, rest.moving) || reaches(flow, tile, rest.changed);
    }
}

void note_changed(Flow& flow) {
    if (!some_asleep(flow)) return;
    for (const Index tile : flow.active.work) flow.rest.changed[tile] = 0;
    for (const Index tile : flow.active.tile)
        if (awake(flow, tile)) add_reach(flow, tile, flow.rest.changed);
}

void wake(Flow& flow, Index tile) {
    if (awake(flow, tile)) return;
    add_reach(flow, tile, flow.rest.changed);
    flow.active.quiet[tile] = 0;
}

void start_deposit(Flow& flow, int before, int after) {
    Rest& rest = flow.rest;
    rest.some_asleep = some_asleep(flow);
    rest.deposits.assign(static_cast<std::size_t>(flow.active.count()), 1);
    if (!rest.some_asleep) return clear(flow, flow.in_reach);
    find_changes(flow, before, after);
    choose_deposits(flow);
    put_aside(flow);
    clear(flow, rest.changed);
}

void finish_deposit(Flow& flow) {
    if (flow.rest.some_asleep) put_back(flow);
    for (const Index tile : flow.active.work) flow.in_reach[tile] = at_wall(flow, tile) ? kAllGroups : 0;
    for (const Index tile : flow.active.tile) add_reach(flow, tile, flow.in_reach);
    mark_near(flow);
    remember_work(flow);
}

void choose_active(Flow& flow, const GridUpdateKernel& grid_update) {
    Rest& rest = flow.rest;
    for (const Index tile : flow.active.work) {
        const bool was_active = rest.active[tile];
        rest.active[tile] = !rest.some_asleep || rest.moving[tile] != 0;
        if (!rest.some_asleep) continue;
        for_each_around(flow, tile, [&](Index to, std::size_t) { rest.active[tile] |= rest.changed[to] != 0; });
        if (was_active && !rest.active[tile]) rest.active[tile] = !grid_update.holds(flow, tile);
    }
}

void activate_all(Flow& flow) {
    for (const Index tile : flow.active.work) flow.rest.active[tile] = 1;
    mark_near(flow);
}

void reach_all(Flow& flow) {
    for (const Index tile : flow.active.work) flow.in_reach[tile] = kAllGroups;
    activate_all(flow);
}

}  // namespace frana
