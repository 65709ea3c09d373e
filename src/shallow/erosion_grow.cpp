// An erodible bed on a larger part of the terrain: its ledger, and the bed where it is no more as the elevation model has it.
#include "shallow/erosion.h"

namespace frana {

/// A node of another grid, as it is there.
struct Erosion::Moved {
    Index from, to, tile, i, j;  ///< storage indices; tile and place of `to`
};

/// The smoothed bed follows from all that it has followed so far, in one pass.
void Erosion::take_over(const Erosion& from, const Flow& old, Flow& flow, Index east, Index north) {
    const std::vector<Moved> nodes = from.moved_nodes(old, flow.grid, east, north);
    std::vector<Index> tiles;
    for (const Moved& node : nodes) {
        take_node(from, old, flow, node);
        if (!changed_[node.tile]) tiles.push_back(node.tile);
        changed_[node.tile] = 1;
    }
    for (const Index tile : tiles) {
        if (deposits_) list_ledger(tile);
        count_tile(flow, tile);
    }
    eroded_ = from.eroded_, deposited_ = from.deposited_, energy_ = from.energy_;
    status_changed();
    if (rest_time_) clocks_.take_over(from.clocks_, old.grid, flow.grid, east, north);
    if (evolves_) bend_taken_over(from, flow, nodes, tiles);
}

/// Nodes of the ground of this bed that have changed.
std::vector<Erosion::Moved> Erosion::moved_nodes(const Flow& flow, const TileGrid& to, Index east, Index north) const {
    std::vector<Moved> nodes;
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

void Erosion::take_node(const Erosion& from, const Flow& old, Flow& flow, const Moved& node) {
    left_[node.to] =
        from.left_[node.from];  // what it had at the start is as it was read for this part: a state keeps none
    if (deposits_) fresh_[node.to] = from.fresh_[node.from];
    if (!evolves_) return;
    double& z = flow.bed.z[node.to];
    const double sunk = old.bed.z[node.from] - z;
    z = old.bed.z[node.from], flow.bed.ground[node.to] = old.bed.ground[node.from];
    if (bent_path_) pending_[node.to] = sunk - from.pending_[node.from];
    moved_[node.tile].add(one_node(flow.grid, node.tile, node.i, node.j));
}

/// Slopes, and the smoothed bed with its curvature. What that has not followed yet waits on.
void Erosion::bend_taken_over(const Erosion& from, Flow& flow, const std::vector<Moved>& nodes,
                              const std::vector<Index>& tiles) {
    for (const Index tile : tiles) marked_[static_cast<std::size_t>(tile)] = 1;
    refresh_moved(flow, tiles);
    if (!bent_path_) return;
    for (const Index tile : tiles) tile_pending_[tile] = most_pending(flow, tile);
    smooth_into_path(flow);
    for (const Moved& node : nodes) pending_[node.to] = from.pending_[node.from];
    for (const Index tile : tiles) tile_pending_[tile] = most_pending(flow, tile);
}

}  // namespace frana
