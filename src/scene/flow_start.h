#pragma once
// Where the flow begins: there the path starts that runouts are measured along.
#include <optional>

#include "scene/scene.h"

namespace frana {

/// The particle nearest to the middle of all. Where a scene has none, the middle of a lake of water alone, or of the
/// first inflow. Of an area, its patch nearest to its middle. Nothing where nothing flows.
std::optional<Vec2> flow_start(const Scene& scene);

/// The same where nothing lies on the terrain at the start, nothing otherwise: then a run's rasters tell.
std::optional<Vec2> start_of_what_comes_in(const Scene& scene);

}  // namespace frana
