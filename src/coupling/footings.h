#pragma once
// What the ground of a scene becomes where barriers stand.
#include <string>
#include <vector>

#include "coupling/barriers.h"

namespace frana {

/// What barriers stand on.
struct Footings {
    double firm = 0.0;       ///< ground that was loose [m3]
    double cleared = 0.0;    ///< where trees stood [m2]
    double displaced = 0.0;  ///< of a lake, in whose room they stand [m3]
};

/// Puts barriers into a scene whose first node is (i0, j0) of the one that their nodes were found in. The bed rises to their
/// tops, and no tree stands there or a cell around. Ground below a top, under it and a cell around, is firm from then
/// on. A barrier that stands has a footing that holds.
Footings stand_in(Scene& scene, const std::vector<BarrierNode>& nodes, Index i0, Index j0);

/// What a report says of them; nothing without any.
std::vector<std::string> remarks_on(const Footings& footings);

}  // namespace frana
