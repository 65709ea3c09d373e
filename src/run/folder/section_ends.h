#pragma once
// Sections that are shorter than the flow is wide.
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// A remark for each end of a section's line that the flow passed beyond. There, and a cell further along the line, the
/// peak depth is more than `limit` [m]. What passes beyond an end is in no discharge or volume of the section. An end
/// at the edge of the terrain has nothing beyond it.
std::vector<std::string> remarks_on_ends(const std::vector<Section>& sections, const Raster& peak_depth, double limit);

}  // namespace frana
