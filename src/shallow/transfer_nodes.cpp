// The nodes' side of the transfers: sums, walls.
#include "shallow/transfer.h"

#include "base/simd.h"

namespace frana {

void PointSums::add(const PointSums& o) {
    mass += o.mass;
    px += o.px;
    py += o.py;
    p_abs += o.p_abs;
    max_speed = std::max(max_speed, o.max_speed);
    max_signal = std::max(max_signal, o.max_signal);
    max_shift = std::max(max_shift, o.max_shift);
    max_motion = std::max(max_motion, o.max_motion);
    stress_power += o.stress_power;
    left_mass += o.left_mass;
    left_px += o.left_px;
    left_py += o.left_py;
    left_energy += o.left_energy;
    lost_in_holes += o.lost_in_holes;
    wall_impulse_x += o.wall_impulse_x;
    wall_impulse_y += o.wall_impulse_y;
    left_count += o.left_count;
    if (bad < 0) bad = o.bad;
}

/// Of a wave from node to node plain points keep nothing. So stress may take all of it in a step, not twice that, or it
/// grows. With points in the middle of each cell that is at 0.25. Linear shapes give a node force without mass. Nodes then
/// have the inertia of the deepest around them. The worst of random points grow at 0.25 by half in a step, and not at 0.2.
/// (With half of that inertia not at 0.12.)
double most_viscosity(const Flow& flow, double velocity_dt) {
    constexpr double kPlain = 0.25, kLinear = 0.2;
    const Scheme& scheme = flow.scheme;
    const bool affine = scheme.transfer == Transfer::tpic || scheme.transfer == Transfer::apic;
    const double most = scheme.shape == Shape::linear ? kLinear : affine ? scheme.stress_cap : kPlain;
    const double nu = std::min(most, scheme.stress_cap);
    return nu * flow.density * flow.area / velocity_dt;
}

PointSums total(const ActiveTiles& active, const LazyArray<PointSums>& parts) {
    PointSums sum;
    for (const Index tile : active.tile) sum.add(parts[tile]);
    return sum;
}

PointSums node_sums(Flow& flow) {
    const Deposit* deposits = flow.nodes.deposits();
    for_each_work_run(flow.active, [&](const TileRun& run) {
        Double4 sums[kRunTiles] = {}, masses[kRunTiles] = {};
        for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index n, Index k, Index, Index) {
            for (Index m = k; m < k + 4; ++m) sums[n] += load(deposits + m);
            masses[n] += load(&flow.nodes.mass[k]);
        });
        for (Index n = 0; n < run.count; ++n)
            if (flow.rest.active[run.tile[n]])
                flow.deposit_sums[run.tile[n]] = {sum(masses[n]), sums[n][0], sums[n][1], 0.0};
    });
    PointSums all;
    for (const Index tile : flow.active.work) {
        const TileSums& part = flow.deposit_sums[tile];
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
            flow.nodes.mass[mirror] += flow.nodes.mass[ghost];
            flow.nodes.column_mass[mirror] += flow.nodes.column_mass[ghost];
            node.px += axis == 0 ? -image.px : image.px;
            node.py += axis == 1 ? -image.py : image.py;
            node.fx += axis == 0 ? -image.fx : image.fx;
            node.fy += axis == 1 ? -image.fy : image.fy;
        });
}

void mirror_motion(Flow& flow) {
    if (!flow.walls) return;
    Motion* motions = flow.nodes.motions();
    for (int axis = 0; axis < 2; ++axis)
        for_each_wall_pair(flow, axis, 1, [&](Index ghost, Index mirror) {
            motions[ghost] = motions[mirror];
            (axis == 0 ? motions[ghost].vx : motions[ghost].vy) *= -1.0;
            if (flow.keeps_shares()) flow.nodes.velocity_share[ghost] = flow.nodes.velocity_share[mirror];
        });
}

}  // namespace frana
