#pragma once
// How far an extent reaches along a path.
#include <cmath>
#include <optional>
#include <string>

#include "terrain/outline_area.h"
#include "terrain/raster.h"

namespace frana {

/// Cells: from there on a difference of fronts counts. Outlines of pixels are good to one.
inline constexpr double kNoticeable = 5.0;

/// The way that water would take from a node to the edge of the terrain. It goes to the lowest of the eight neighbours
/// by slope (O'Callaghan & Mark 1984). Out of hollows it goes over their lowest edge (priority flood, Barnes et al.
/// 2014). It ends where it meets the edge to stay there, for eleven nodes or to its last. Nodata is an edge; round a
/// hole of it the way goes on as long as it falls. It is smoothed over eleven nodes. Empty when the start has no
/// elevation.
Polyline steepest_path(const Raster& bed, const Vec2& start);

/// Smoothed over eleven nodes of a path, fewer near its ends, which stay: that takes out the eight directions of the grid
/// and leaves the bends of a valley.
Polyline smoothed_path(const Polyline& line);

/// Middles of up to nine releases, those of the largest areas first. A middle is the node nearest to the centroid of
/// its release. Released are the nodes whose arrival time is 0; those that touch are one release.
std::vector<Vec2> release_middles(const Raster& arrival_time);

/// Whether a ridge lies between two places: ground that is higher than both by a twentieth of their distance, where the
/// flow did not get deeper than `limit` [m]. Without elevations there is none.
bool ridge_between(const Raster& bed, const Raster& peak_depth, double limit, const Vec2& a, const Vec2& b);

/// A point's place along a path.
struct PlaceAlong {
    double place = 0.0;          ///< of the path's point nearest to it [m]
    double distance = INFINITY;  ///< to that point [m]
    bool at_end = false;         ///< the path's end is nearest
    bool off_end = false;        ///< farther off the path than from its end, and not in front of it
};

/// The path goes on straight beyond its end, for points that lie in front of it: the end is the nearest point of the
/// path to them. What they lie ahead counts in full up to 45 degrees off its direction. Farther off, less of
/// it counts, by what they lie more aside than ahead; nothing does where they lie twice as far aside.
PlaceAlong place_along(const Polyline& path, const Vec2& p);

/// How far an outline reaches along a path.
struct FrontAlong {
    double place = Raster::nodata;  ///< the largest of PlaceAlong::place; NaN without rings [m]
    double off_path = 0.0;          ///< how far the outline lies from the path, but for points beside its end [m]
    double off_end = 0.0;           ///< how far those lie from it [m]
    bool meets_end = false;         ///< whether any point is nearest to the end
};

/// `step` [m]: how closely the outline's edges are sampled.
FrontAlong front_along(const Polyline& path, const Rings& outline, double step);

/// Of several paths, each by its own rings and the points of them that are nearest to it. Behind a junction paths are one:
/// a point counts where no path for which its ring counts is nearer by more than a `step`.
std::vector<FrontAlong> fronts_along(const std::vector<Polyline>& paths, const std::vector<Rings>& outlines,
                                     double step);

/// The place of that front alone: the path's horizontal length up to there [m].
double reach_along(const Polyline& path, const Rings& outline, double step);

/// Straight horizontal distance from a point to the farthest one of an outline [m]; NaN without rings.
double farthest_from(const Vec2& start, const Rings& outline);

double length_of(const Polyline& path);

/// The point of a path at a distance along it [m]; its end beyond that.
Vec2 point_along(const Polyline& path, double distance);

/// What to say of a path of that length where a front lies beyond its end, both along it [m]. "" where none does, or
/// by no more than `allowed`.
std::string remark_on_end(double length, double farthest, double allowed);

/// Whether a flow that reaches a path's end leaves it sideways there: it lies farther from there than from the rest of
/// the path, by more than `allowed` [m]. Then its runout is not known.
bool turns_off(const FrontAlong& front, double allowed);

/// What to say then, else "".
std::string remark_on_turn(const FrontAlong& front, double allowed);

}  // namespace frana
