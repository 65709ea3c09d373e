#pragma once
// Barriers whose faces lie against one another or in one another.
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// Two barriers, by their places in the scene.
struct JoinedBarriers {
    std::size_t one, other;
};

/// Those of which one has a corner, or more, in the other or along its side, by their outlines, and walls along a line by
/// their thickness on cells of the 3D stage [m]. Barriers that meet in corners alone, as walls end to end or back to
/// back of one length do, are not among them. Nor are meshes.
std::vector<JoinedBarriers> joined_barriers(const std::vector<Barrier>& barriers, double cell);

/// What 3D points make of them; nothing without any.
std::vector<std::string> remarks_on_joined(const std::vector<Barrier>& barriers, double cell);

}  // namespace frana
