#pragma once
// Whether a line that was drawn as the path has to do with the flow that it is the path of.
#include <string>
#include <vector>

#include "terrain/outline_area.h"
#include "terrain/raster.h"

namespace frana {

/// Whether any place along a path is deeper than `limit` [m], or within a cell of such a node.
bool comes_to_flow(const Polyline& path, const Raster& depth, double limit);

/// Whether any place along a path lies in the polygons, or within `reach` of them [m].
bool comes_to_polygons(const Polyline& path, const Polygons& polygons, double reach);

/// Whether any place along a path changed by more than `noise` [m], or is within a cell of such a node.
bool comes_to_changes(const Polyline& path, const Raster& change, double noise);

/// From a place to the nearest where material was released or came in [m]. That is where it arrived at time 0, one of
/// `starts`, or where it arrived when it did at a start. NaN where nothing of that is known.
double distance_to_start(const Vec2& place, const Raster& arrival_time, const std::vector<Vec2>& starts);

/// Why a path that comes to nothing is no path.
std::string words_on_stray(const std::string& source);

}  // namespace frana
