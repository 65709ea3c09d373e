// What of a depth-averaged run becomes bed.
#include "shallow/depth_averaged.h"

namespace frana {

/// Points that have become bed are gone. All others deposit anew: what sleeps keeps what it had, not beside what goes.
void DepthAveraged::settle() {
    if (!erosion_->settle(flow_, status_)) return;
    sorter_.drop(flow_.columns, erosion_->gone(), flow_.active);
    for (const Index tile : flow_.active.tile) flow_.active.quiet[tile] = 0;
    status_.bed = erosion_->status();
}

}  // namespace frana
