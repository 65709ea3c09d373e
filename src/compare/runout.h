#pragma once
// How far an extent reaches along a path.
#include <optional>
#include <string>

#include "particles/outline_area.h"
#include "terrain/raster.h"

namespace frana {

/// The way that water would take from a node to the edge of the terrain. It goes to the lowest of the eight neighbours
/// by slope (O'Callaghan & Mark 1984). Out of hollows it goes over their lowest edge (priority flood, Barnes et al.
/// 2014). It is smoothed over eleven nodes. Nodata is an edge. Empty when the start has no elevation.
Polyline steepest_path(const Raster& bed, const Vec2& start);

/// Middle of a release: the released node nearest to the centroid of all of them; nothing when there are none.
/// Released are the nodes whose arrival time is 0.
std::optional<Vec2> release_middle(const Raster& arrival_time);

/// Place along a path of its point nearest to p [m]; the last segment goes on without end.
double place_along(const Polyline& path, const Vec2& p);

/// The path's horizontal length up to the point of it that is nearest to the outline's farthest one [m]. It is the
/// largest, over the outline, of the place along the path of the nearest point on it. A path that ends too early goes
/// on straight. NaN without rings. `step` [m]: how closely the outline's edges are sampled.
double reach_along(const Polyline& path, const Rings& outline, double step);

/// Straight horizontal distance from a point to the farthest one of an outline [m]; NaN without rings.
double farthest_from(const Vec2& start, const Rings& outline);

double length_of(const Polyline& path);

/// What to say of a path of that length where a front lies beyond its end, both along it [m]. "" where none does, or
/// by no more than `allowed`.
std::string remark_on_end(double length, double farthest, double allowed);

}  // namespace frana
