// The nodes' side of the transfers: clearing, sums, walls.
#include <cstring>

#include "solver/transfer.h"

namespace frana {

void PointSums::add(const PointSums& o) {
    mass += o.mass;
    px += o.px;
    py += o.py;
    p_abs += o.p_abs;
    max_speed = std::max(max_speed, o.max_speed);
    max_signal = std::max(max_signal, o.max_signal);
    max_shift = std::max(max_shift, o.max_shift);
    stress_power += o.stress_power;
    left_mass += o.left_mass;
    left_px += o.left_px;
    left_py += o.left_py;
    left_energy += o.left_energy;
    left_count += o.left_count;
    if (bad < 0) bad = o.bad;
}

PointSums total(const std::vector<PointSums>& parts) {
    PointSums sum;
    for (const PointSums& part : parts) sum.add(part);
    return sum;
}

void start_deposit(Flow& flow) {
    Deposit* deposits = flow.nodes.deposits();
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_four_of(flow.grid, tile, flow.touched[tile], [&](Index k, Index, Index) {
            std::memset(deposits + k, 0, 4 * sizeof(Deposit));
            std::memset(&flow.nodes.column_mass[k], 0, 4 * sizeof(double));
            if (flow.nodes.force) std::memset(&flow.nodes.force[k], 0, 4 * sizeof(Pair));
        });
    });
    flow.reach.resize(static_cast<std::size_t>(flow.active.count()));
}

namespace {

/// Whether a tile has nodes that walls mirror, or ghosts: these are always taken to be touched.
bool at_wall(const Flow& flow, Index tile) {
    const auto along = [](Index first, Index nodes) {
        const auto holds = [&](Index wall) { return first <= wall + kGhosts && first + kTile > wall - kGhosts; };
        return holds(0) || holds(nodes - 1);
    };
    return flow.walls && (along(flow.grid.tile_i(tile), flow.grid.nx()) || along(flow.grid.tile_j(tile), flow.grid.ny()));
}

/// The groups of a tile and its eight neighbours, none where a neighbour is not near material.
TileReach touched_around(const Flow& flow, Index tile) {
    TileReach around{};
    const Index width = flow.grid.tiles_x(), column = tile % width;
    for (Index n = 0; n < 9; ++n) {
        const Index neighbour = tile + (n / 3 - 1) * width + n % 3 - 1, to = column + n % 3 - 1;
        if (to < 0 || to >= width || neighbour < 0 || neighbour >= flow.grid.tiles()) continue;
        if (flow.active.in_work[neighbour]) around[static_cast<std::size_t>(n)] = flow.touched[neighbour];
    }
    return around;
}

}  // namespace

void mark_near(Flow& flow) {
    for_each_work_tile(flow.active, [&](Index, Index tile) { flow.near[tile] = grown(touched_around(flow, tile)); });
}

void mark_touched(Flow& flow) {
    for (const Index tile : flow.active.work) flow.touched[tile] = at_wall(flow, tile) ? kAllGroups : 0;
    const Index width = flow.grid.tiles_x();
    for (Index n = 0; n < flow.active.count(); ++n)
        for (Index m = 0; m < 9; ++m) {  // the work list holds all neighbours, or the points have left the grid
            const NodeGroups groups = flow.reach[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)];
            if (groups) flow.touched[flow.active.tile[static_cast<std::size_t>(n)] + (m / 3 - 1) * width + m % 3 - 1] |= groups;
        }
    mark_near(flow);
}

void touch_all(Flow& flow) {
    for (const Index tile : flow.active.work) flow.touched[tile] = kAllGroups;
    mark_near(flow);
}

PointSums node_sums(Flow& flow) {
    std::vector<TileSums>& parts = flow.tile_sums;
    parts.assign(flow.active.work.size(), {});
    const Deposit* deposits = flow.nodes.deposits();
    for_each_work_tile(flow.active, [&](Index n, Index tile) {
        TileSums sums{};
        for_each_node_of(flow.grid, tile, flow.touched[tile], [&](Index k, Index, Index) {
            sums[0] += deposits[k].mass;
            sums[1] += deposits[k].px;
            sums[2] += deposits[k].py;
        });
        parts[n] = sums;
    });
    PointSums all;
    for (const TileSums& part : parts) {
        all.mass += part[0];
        all.px += part[1];
        all.py += part[2];
    }
    return all;
}

void fold_walls(Flow& flow) {
    if (!flow.walls) return;
    Deposit* deposits = flow.nodes.deposits();
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 0, [&](Index ghost, Index mirror) {
            const Deposit image = deposits[ghost];
            Deposit& node = deposits[mirror];
            node.mass += image.mass;
            flow.nodes.column_mass[mirror] += flow.nodes.column_mass[ghost];
            node.px += axis == 0 ? -image.px : image.px;
            node.py += axis == 1 ? -image.py : image.py;
            if (!flow.nodes.force) return;
            const Pair pull = flow.nodes.force[ghost];
            flow.nodes.force[mirror].x += axis == 0 ? -pull.x : pull.x;
            flow.nodes.force[mirror].y += axis == 1 ? -pull.y : pull.y;
        });
}

void mirror_motion(Flow& flow) {
    if (!flow.walls) return;
    Motion* motions = flow.nodes.motions();
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 1, [&](Index ghost, Index mirror) {
            motions[ghost] = motions[mirror];
            (axis == 0 ? motions[ghost].vx : motions[ghost].vy) *= -1.0;
        });
}

}  // namespace frana
