// What of a depth-averaged run becomes bed.
#include <algorithm>

#include "shallow/depth_averaged.h"

namespace frana {

/// What trees take goes with the velocity that it has: its momentum and its energy are the bed's.
void DepthAveraged::detrain(double dt) {
    const ExchangeSums sums = erosion_->detrain(flow_, dt);
    if (!(sums.taken < 0.0)) return;
    account(of_bed(sums));
    if (erosion_->any_gone()) sorter_.drop(flow_.particles, erosion_->gone(), flow_.active);
    status_.bed = erosion_->status();
}

/// Points that have become bed are gone. The bed stops what they crept with.
void DepthAveraged::settle() {
    const std::optional<ExchangeSums> sums = erosion_->settle(flow_, status_);
    if (!sums) return;
    account(of_bed(*sums));
    sorter_.drop(flow_.particles, erosion_->gone(), flow_.active);
    status_.bed = erosion_->status();
}

/// Depth above the ground of before is that of the flow and of the deposit below it. So thin flows may bury ground.
void DepthAveraged::note_buried() {
    if (!erosion_->deposits()) return;
    const auto note = [&](Index k, double depth) {
        const double deposited = erosion_->deposited_depth(k);
        if (!(deposited > 0.0)) return;
        const double all = depth + deposited;
        const bool known = peaks_.depth[k] > footprint_depth_ || peaks_.arrival[k] > 0.0;
        if (!known && all > footprint_depth_) peaks_.arrival[k] = status_.time;
        peaks_.depth[k] = std::max(peaks_.depth[k], all);
    };
    for_each_work_tile(flow_.active, [&](Index, Index tile) {
        if (!erosion_->has_changed(tile)) return;
        for_each_node_of(flow_.grid, tile, flow_.in_reach[tile], [&](Index k, Index, Index) { note(k, own_depth(k)); });
    });
    for (const Index tile : erosion_->raised_tiles())  // where all of the flow may have gone
        for_each_node_of(flow_.grid, tile, [&](Index k, Index i, Index j) {
            if (!flow_.is_in_reach(i, j)) note(k, 0.0);
        });
}

}  // namespace frana
