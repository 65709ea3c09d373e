#pragma once
// How much of a flow left the terrain, and from which share on that is worth a remark.
#include <algorithm>

#include "observe/budget.h"

namespace frana {

/// Where a larger share of all that flowed left, the flow goes on beyond the terrain. Reach, footprint and deposit are
/// then those of a part of it [1].
inline constexpr double kNoticeablyLeft = 1e-3;

/// All that flowed: what was there at the start, what came in, and what was taken of the bed of the start. What the flow
/// had left behind and took again counts once [kg].
inline double mass_flowed(const Status& first, const Status& last, double taken_of_bed) {
    return first.mass + mass_came_in(first, last) + taken_of_bed;
}

/// Share of `flowed` that is not on the terrain any more. What sank into the ground counts as left, but is there [kg].
inline double left_share(double left, double infiltrated, double flowed) {
    return flowed > 0.0 ? std::max(0.0, left - infiltrated) / flowed : 0.0;
}

}  // namespace frana
