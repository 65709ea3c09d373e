#pragma once
// Which way flows went, by the nodes that they covered.
#include <optional>
#include <string>
#include <vector>

#include "compare/runout.h"
#include "terrain/raster.h"

namespace frana {

/// Connected parts of what flows covered, and the ways from their releases within them.
class FlowTracks {
public:
    /// Nodes deeper than `limit` [m] are covered; those that touch, also at a corner, are one part. `starts` [m]: middles
    /// of releases.
    FlowTracks(const Raster& depth, double limit, const std::vector<Vec2>& starts);

    /// The number of the part that covers a place or a node within a cell and a half of it; nothing where none does.
    std::optional<Index> part_at(const Vec2& place) const;
    /// From a start, the shortest way within its part to the farthest of the nodes that are not nearer to another start.
    /// Smoothed as a steepest path is. Empty where the start is dry, or all is nearer to others.
    Polyline track_from(std::size_t start) const;

private:
    void find_ways(const std::vector<Vec2>& starts);
    std::optional<Index> covered_near(const Vec2& place) const;
    Vec2 place(Index node) const { return {grid_.x(node % grid_.nx), grid_.y(node / grid_.nx)}; }

    GridGeometry grid_;
    std::vector<Index> part_;      ///< of each node; -1: dry
    std::vector<Index> from_;      ///< the node before it on the way from its start; itself at a start; -1: no way
    std::vector<double> way_;      ///< length of that [cells]
    std::vector<Index> farthest_;  ///< node of each start; -1: none
};

/// The way that a runout is measured along from a start: the steepest path, or that of the flow where it left the
/// steepest path within the first half of its way. Then it goes on along the steepest path from the flow's front.
struct RunoutPath {
    Polyline line;          ///< empty: none is known
    bool of_flow = false;   ///< the flow left the steepest path
    std::size_t start = 0;  ///< its number
    Vec2 front{0, 0};       ///< the farthest place of the flow, or the start
};
RunoutPath runout_path(const Raster& bed, const FlowTracks& tracks, std::size_t start, const Vec2& from);

/// That of the first start. Then those of others whose flow does not touch any before it and went somewhere, or whose
/// front lies beyond a ridge from their paths. `starts`: as the tracks have them.
std::vector<RunoutPath> runout_paths(const Raster& bed, const Raster& depth, double limit, const FlowTracks& tracks,
                                     const std::vector<Vec2>& starts);

/// What to say of a path that is the track of the flow.
std::string remark_on_track(const RunoutPath& path);

/// What to say where runouts are those of one start among several.
std::string remark_on_others(const Vec2& start);

/// The rings of an outline that count for each path. A part that paths start in counts for those, other parts for all.
std::vector<Rings> rings_of_parts(const std::vector<Polyline>& paths, const FlowTracks& tracks, const Rings& outline);

/// The same of what lies deeper than `limit` [m]. Of one path it is all.
std::vector<Rings> rings_of_parts(const std::vector<Polyline>& paths, const Raster& depth, double limit,
                                  const Rings& outline);

/// The same of surveyed polygons. One in which paths start, or within `step` [m] of its rim, counts for those, and for
/// paths that start in none.
std::vector<Rings> rings_of_polygons(const std::vector<Polyline>& paths, const Polygons& polygons, double step);

/// How far the one part in which a path starts reaches along it; NaN where the path starts on dry ground.
FrontAlong front_of_own_part(const Polyline& path, const FlowTracks& tracks, const Rings& outline, double step);

}  // namespace frana
