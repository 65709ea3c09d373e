// Releases that stand in the bed until they go are cut out of it then (THEORY.md, section 17).
#include <utility>

#include "base/error.h"
#include "shallow/erosion.h"

namespace frana {

void Erosion::prepare_scars(const Scene& scene, const Flow& flow) {
    if (!scene.cuts_later()) return;
    expect(evolves_, "releases are cut out of a bed that follows");
    cut_ = LazyArray<double>(flow.grid.size());
    ledger_tiles_.reserve(static_cast<std::size_t>(flow.grid.tiles()));
    if (!takes_) return;
    buried_ = LazyArray<double>(flow.grid.size());
    for (const LateRelease& release : scene.late)
        for (const NodeFall& fall : falls_of(release.scar, flow.grid, flow.bed, flow.walls))
            if (fall.ground > 0.0) buried_[fall.k] += 1.0;
}

void Erosion::cut(Flow& flow, const std::vector<ScarNode>& scar) {
    const TileGrid& grid = flow.grid;
    std::vector<Index> tiles;
    for (const NodeFall& fall : falls_of(scar, grid, flow.bed, flow.walls)) {
        flow.bed.z[fall.k] -= fall.z;
        flow.bed.ground[fall.k] -= fall.ground;
        cut_[fall.k] += fall.ground;
        if (bent_path_) pending_[fall.k] -= fall.path;
        if (buried_ && fall.ground > 0.0) buried_[fall.k] -= 1.0;
        const Index tile = grid.tile_of_node(fall.i, fall.j);
        moved_[tile].add(one_node(grid, tile, fall.i, fall.j));
        if (std::exchange(marked_[static_cast<std::size_t>(tile)], std::uint8_t{1}) == 0) tiles.push_back(tile);
    }
    if (tiles.empty()) return;
    for (const Index tile : tiles) {
        list_ledger(tile);
        if (bent_path_) tile_pending_[tile] = most_pending(flow, tile);
    }
    refresh_moved(flow, tiles);
    for (const Index tile : next_) changed_[tile] = 1;
    if (bent_path_) smooth_into_path(flow);
}

}  // namespace frana
