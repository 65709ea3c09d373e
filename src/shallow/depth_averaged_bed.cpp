// What of a depth-averaged run becomes bed.
#include "shallow/depth_averaged.h"

namespace frana {

/// Points that have become bed are gone.
void DepthAveraged::settle() {
    if (!erosion_->settle(flow_, status_)) return;
    sorter_.drop(flow_.columns, erosion_->gone(), flow_.active);
    status_.bed = erosion_->status();
}

}  // namespace frana
