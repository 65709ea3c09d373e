#pragma once
// Inflows of a case as sources of free water on the cells around the nodes.
#include <vector>

#include "scene/scene.h"
#include "water/water_flow.h"

namespace frana {

/// One of each inflow. A line shares its discharge over the cells that it crosses, by its length in each, and flows across
/// itself. An area shares it over the cells that its patches lie in, at rest.
std::vector<WaterSource> water_sources(const Scene& scene);

}  // namespace frana
