#pragma once
// Where the flow begins: there the path starts that runouts are measured along.
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace frana {

/// The particle nearest to the middle of those at the start. Where there are none, the middle of a lake of water alone.
/// Else it is that of the inflow or the late release that comes first. Of an area it is the patch nearest to its middle.
/// Nothing where nothing flows.
std::optional<Vec2> flow_start(const Scene& scene);

/// Where material comes in that a run's rasters do not show at the start: the lake of water alone, then inflows and later
/// releases by the time at which they begin. What enters when the flow reaches it begins no flow.
std::vector<Vec2> starts_of_what_comes_in(const Scene& scene);

/// Where the front is measured from (Status::front), for people: "the release's centre", "the middle of inflow torrent".
/// Where material comes in elsewhere too, that is said.
std::string front_origin(const Scene& scene);

}  // namespace frana
