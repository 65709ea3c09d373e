// What of a depth-averaged run becomes bed.
#include "shallow/depth_averaged.h"

namespace frana {

/// What trees take goes with the velocity that it has: its momentum and its energy are the bed's.
void DepthAveraged::detrain(double dt) {
    const ExchangeSums sums = erosion_->detrain(flow_, dt);
    if (!(sums.taken < 0.0)) return;
    status_.dissipated += sums.lost;
    status_.impulse[0] += sums.px;
    status_.impulse[1] += sums.py;
    if (erosion_->any_gone()) sorter_.drop(flow_.columns, erosion_->gone(), flow_.active);
    status_.bed = erosion_->status();
}

/// Points that have become bed are gone.
void DepthAveraged::settle() {
    if (!erosion_->settle(flow_, status_)) return;
    sorter_.drop(flow_.columns, erosion_->gone(), flow_.active);
    status_.bed = erosion_->status();
}

}  // namespace frana
