// An erodible bed on a larger part of the terrain. It has its ledger, and the bed where it is no more as the elevation
// model has it.
#include "shallow/erosion.h"

namespace frana {

/// A node that both grids have.
struct Erosion::SharedNode {
    Index from, to, tile, i, j;  ///< storage indices; tile and place of `to`
};

/// The bed is smoothed once for all changes that it was smoothed for before.
void Erosion::take_over(const Erosion& from, const Flow& old, Flow& flow, Index east, Index north) {
    const std::vector<SharedNode> nodes = from.changed_nodes(old, flow.grid, east, north);
    std::vector<Index> tiles;
    for (const SharedNode& node : nodes) {
        take_node(from, old, flow, node);
        if (!changed_[node.tile]) tiles.push_back(node.tile);
        changed_[node.tile] = 1;
    }
    for (const Index tile : tiles) {
        if (deposits_) list_ledger(tile);
        count_tile(flow, tile);
    }
    eroded_ = from.eroded_, deposited_ = from.deposited_, energy_ = from.energy_;
    peak_mean_speed_ = from.peak_mean_speed_;
    waited_ = from.waited_, ahead_ = from.ahead_, share_rate_ = from.share_rate_;
    status_changed();
    if (rest_time_) clocks_.take_over(from.clocks_, old.grid, flow.grid, east, north);
    if (evolves_) bend_taken_over(from, flow, nodes, tiles);
}

/// Nodes of the ground of this bed that have changed.
std::vector<Erosion::SharedNode> Erosion::changed_nodes(const Flow& flow, const TileGrid& to, Index east,
                                                        Index north) const {
    std::vector<SharedNode> nodes;
    for (Index tile = 0; tile < flow.grid.tiles(); ++tile) {
        if (!changed_[tile]) continue;
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            const bool inside = i >= 0 && j >= 0 && i < flow.grid.nx() && j < flow.grid.ny();
            if (!inside || (left_[k] == initial_[k] && !(fresh(k) > 0.0) && !(bent_path_ && pending_[k] != 0.0)))
                return;
            nodes.push_back({k, to.at(i + east, j + north), to.tile_of_node(i + east, j + north), i + east, j + north});
        });
    }
    return nodes;
}

void Erosion::take_node(const Erosion& from, const Flow& old, Flow& flow, const SharedNode& node) {
    // Not what it had at the start: a resumed run has that only as it was read for this part.
    left_[node.to] = from.left_[node.from];
    if (deposits_) fresh_[node.to] = from.fresh_[node.from];
    if (!evolves_) return;
    double& z = flow.bed.z[node.to];
    const double sunk = old.bed.z[node.from] - z;
    z = old.bed.z[node.from], flow.bed.ground[node.to] = old.bed.ground[node.from];
    if (bent_path_) pending_[node.to] = sunk - from.pending_[node.from];
    moved_[node.tile].add(one_node(flow.grid, node.tile, node.i, node.j));
}

/// Slopes follow the changed bed, and so does the smoothed bed with its curvature. Changes that wait for it wait on.
void Erosion::bend_taken_over(const Erosion& from, Flow& flow, const std::vector<SharedNode>& nodes,
                              const std::vector<Index>& tiles) {
    for (const Index tile : tiles) marked_[static_cast<std::size_t>(tile)] = 1;
    refresh_moved(flow, tiles);
    if (!bent_path_) return;
    for (const Index tile : tiles) tile_pending_[tile] = most_pending(flow, tile);
    smooth_into_path(flow);
    for (const SharedNode& node : nodes) pending_[node.to] = from.pending_[node.from];
    for (const Index tile : tiles) tile_pending_[tile] = most_pending(flow, tile);
}

}  // namespace frana
