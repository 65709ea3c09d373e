#pragma once
// Barriers whose faces lie against one another, in one another, or nearer than points resolve.
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// Two barriers, by their places in the scene.
struct JoinedBarriers {
    std::size_t one, other;
    double apart;  ///< 0: they touch or overlap [m]
};

/// Those that overlap, touch, or stand less than a cell of the 3D stage apart in plan. They are judged by their outlines,
/// walls along a line by their thickness on such cells [m], and meshes by what is below their tops.
std::vector<JoinedBarriers> joined_barriers(const std::vector<Barrier>& barriers, double cell);

/// What 3D points make of them; nothing without any.
std::vector<std::string> remarks_on_joined(const std::vector<Barrier>& barriers, double cell);

}  // namespace frana
