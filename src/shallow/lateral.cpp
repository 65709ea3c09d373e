#include "shallow/lateral.h"

#include <cmath>

namespace frana {
namespace {

constexpr std::uint8_t kKnown = kWet | kMoving;

bool known(const Nodes& nodes, Index k) { return (nodes.flags[k] & kKnown) == kKnown; }

/// What the neighbour n gives the node k.
Pair given(const Flow& flow, Index k, Index n, double dt) {
    const Nodes& nodes = flow.nodes;
    if (!known(nodes, n)) return {0.0, 0.0};
    const double dx = nodes.before[n].x - nodes.before[k].x, dy = nodes.before[n].y - nodes.before[k].y;
    const double f = 0.5 * flow.scheme.lateral_drag * std::sqrt(dx * dx + dy * dy) * dt / flow.cell;
    // Harmonic mean of both masses over the node's own: what one side loses the other gains to round-off.
    const double share = 2.0 * nodes.mass[n] / (nodes.mass[k] + nodes.mass[n]);
    const double rate = share * f / (1.0 + 8.0 * f) / dt;
    return {rate * dx, rate * dy};
}

}  // namespace

void lateral_pass(Flow& flow, double dt) {
    if (!has_lateral_drag(flow.scheme) || !(dt > 0.0)) return;
    const Index up = flow.grid.stride();
    for_each_work_run(flow.active, [&](const TileRun& run) {
        for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index, Index first, Index, Index) {
            for (Index k = first; k < first + 4; ++k) {
                Pair sum{0.0, 0.0};
                if (known(flow.nodes, k))
                    for (const Index n : {k - 1, k + 1, k - up, k + up}) {
                        const Pair part = given(flow, k, n, dt);
                        sum.x += part.x, sum.y += part.y;
                    }
                flow.nodes.lateral[k] = sum;
            }
        });
    });
}

}  // namespace frana
