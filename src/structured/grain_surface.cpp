// The free surface of grains, by the phases of the depth-averaged flow (shallow/surface.h, shock.h).
#include "shallow/shock.h"
#include "shallow/surface.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

template <class Body>
void for_each_in_reach(StructuredBody& body, Body&& visit) {
    for_each_work_tile(body.active, [&](Index, Index tile) {
        for_each_node_of(body.grid, tile, body.flow.in_reach[tile], [&](Index k, Index, Index) { visit(k); });
    });
}

/// Behind an obstacle's face, where next to nothing is open.
bool blocked(const StructuredBody& body, Index k) { return body.ground[k].open <= kLeastOpen; }

/// Next to obstacles depth is what lies on the open share of a node.
void widen_at_obstacles(StructuredBody& body) {
    for_each_in_reach(body, [&](Index k) { body.flow.nodes.column_mass[k] /= body.ground[k].open; });
}

/// Behind obstacles the surface goes on as high as next to them. A face is no shore and exerts no tension.
void level_behind_obstacles(StructuredBody& body) {
    Nodes& nodes = body.flow.nodes;
    const Index up = body.grid.stride();
    for_each_in_reach(body, [&](Index k) {
        if (!blocked(body, k) || !(nodes.depth[k] > 0.0)) return;
        double sum = 0.0;
        int open = 0;
        for (const Index row : {k - up, k, k + up})
            for (Index n = row - 1; n <= row + 1; ++n)
                if (!blocked(body, n) && nodes.depth[n] > 0.0) sum += nodes.level[n], ++open;
        if (open > 0) nodes.level[k] = nodes.surface[k] = sum / open;
    });
}

/// Next to obstacles the depth of blocked nodes is no depth to smooth with.
void plain_at_obstacles(StructuredBody& body) {
    const Index up = body.grid.stride();
    for_each_in_reach(body, [&](Index k) {
        bool near_obstacle = false;
        for (Index row = k - 2 * up; row <= k + 2 * up; row += up)
            for (Index n = row - 2; n <= row + 2; ++n) near_obstacle = near_obstacle || blocked(body, n);
        if (near_obstacle) body.flow.nodes.law_depth[k] = body.flow.nodes.depth[k];
    });
}

}  // namespace

void raise_surface(StructuredBody& body, double velocity_dt) {
    Flow& flow = body.flow;
    finish_deposit(flow);
    if (!body.obstacles.empty()) widen_at_obstacles(body);
    const NodeSums sums = depth_pass(flow, {0.0, Vec2(0, 0)});
    if (!body.obstacles.empty()) level_behind_obstacles(body);
    mark_margin(flow);
    shock_pass(flow, velocity_dt);
    filter(flow);
    // Next to a face, as to a wall, a lump without a pressure gradient would stay.
    if (body.obstacles.empty()) body.creep_filter.pass(flow, sums.max_depth);
    if (!body.obstacles.empty()) plain_at_obstacles(body);
    shoreline(flow);
}

}  // namespace frana
