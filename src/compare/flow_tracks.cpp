#include "compare/flow_tracks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "compare/nearest.h"
#include "compare/outline.h"
#include "terrain/connected_nodes.h"
#include "terrain/places.h"

namespace frana {
namespace {

constexpr Index kNone = -1;

/// Calls f(node, distance in cells) for nodes up to two columns or rows away, sixteen directions in all: with eight, ways
/// are up to 8 % too long, with these 3 %. A way between two nodes needs one of those that it passes between.
template <class IsCovered, class F>
void for_each_step(const GridGeometry& g, Index node, const IsCovered& is_covered, F&& f) {
    const Index i = node % g.nx, j = node / g.nx;
    const auto number = [&](Index di, Index dj) { return (j + dj) * g.nx + i + di; };
    for (Index dj = -2; dj <= 2; ++dj)
        for (Index di = -2; di <= 2; ++di) {
            if (std::gcd(di, dj) != 1 || !has_node(g, {i + di, j + dj})) continue;
            const Index near_i = di / 2, near_j = dj / 2;
            const bool far = std::abs(di) + std::abs(dj) > 2;
            if (far && !is_covered(number(near_i, near_j)) && !is_covered(number(di - near_i, dj - near_j))) continue;
            f(number(di, dj), std::hypot(static_cast<double>(di), static_cast<double>(dj)));
        }
}

/// The farthest place along a path that the part covers [m].
double covered_length(const Polyline& path, const FlowTracks& tracks, Index part) {
    double before = 0.0, covered = 0.0;
    for (std::size_t k = 0; k < path.size(); ++k) {
        if (k > 0) before += (path[k] - path[k - 1]).norm();
        if (tracks.part_at(path[k]) == part) covered = before;
    }
    return covered;
}

}  // namespace

FlowTracks::FlowTracks(const Raster& depth, double limit, const std::vector<Vec2>& starts)
    : grid_(depth.geometry),
      part_(depth.values.size(), kNone),
      from_(depth.values.size(), kNone),
      way_(depth.values.size(), std::numeric_limits<double>::infinity()),
      farthest_(starts.size(), kNone) {
    std::vector<char> covered(depth.values.size());
    for (std::size_t k = 0; k < covered.size(); ++k) covered[k] = depth.values[k] > limit;
    Index parts = 0;
    for (Index first = 0; first < grid_.size(); ++first) {
        if (covered[static_cast<std::size_t>(first)] == 0) continue;
        for (const Index node : take_connected(grid_, covered, first)) part_[static_cast<std::size_t>(node)] = parts;
        ++parts;
    }
    find_ways(starts);
}

/// From all starts at once, always on from the node with the shortest way (Dijkstra 1959).
void FlowTracks::find_ways(const std::vector<Vec2>& starts) {
    using Way = std::pair<double, Index>;
    std::priority_queue<Way, std::vector<Way>, std::greater<>> next;
    std::vector<Index> owner(part_.size(), kNone);
    for (std::size_t n = 0; n < starts.size(); ++n) {
        const std::optional<Index> node = covered_near(starts[n]);
        if (!node || owner[static_cast<std::size_t>(*node)] != kNone) continue;
        const auto k = static_cast<std::size_t>(*node);
        owner[k] = static_cast<Index>(n), from_[k] = *node, way_[k] = 0.0;
        next.emplace(0.0, *node);
    }
    while (!next.empty()) {
        const Way top = next.top();
        const double length = top.first;
        const Index node = top.second;
        next.pop();
        const auto k = static_cast<std::size_t>(node);
        if (length > way_[k]) continue;
        farthest_[static_cast<std::size_t>(owner[k])] = node;  // ways come in order of their lengths
        const auto is_covered = [&](Index n) { return part_[static_cast<std::size_t>(n)] != kNone; };
        for_each_step(grid_, node, is_covered, [&](Index other, double distance) {
            const auto o = static_cast<std::size_t>(other);
            if (!is_covered(other) || !(length + distance < way_[o])) return;
            way_[o] = length + distance, from_[o] = node, owner[o] = owner[k];
            next.emplace(way_[o], other);
        });
    }
}

/// The nearest of the covered nodes within a cell and a half.
std::optional<Index> FlowTracks::covered_near(const Vec2& at) const {
    const NodeAt middle = nearest_node(grid_, at);
    std::optional<Index> best;
    double least = 1.5 * grid_.cell;
    for (Index j = middle.j - 1; j <= middle.j + 1; ++j)
        for (Index i = middle.i - 1; i <= middle.i + 1; ++i) {
            if (!has_node(grid_, {i, j}) || part_[static_cast<std::size_t>(j * grid_.nx + i)] == kNone) continue;
            const double distance = (place(j * grid_.nx + i) - at).norm();
            if (distance <= least) least = distance, best = j * grid_.nx + i;
        }
    return best;
}

std::optional<Index> FlowTracks::part_at(const Vec2& at) const {
    const std::optional<Index> node = covered_near(at);
    return node ? std::optional<Index>(part_[static_cast<std::size_t>(*node)]) : std::nullopt;
}

Polyline FlowTracks::track_from(std::size_t start) const {
    Index node = farthest_[start];
    if (node == kNone) return {};
    Polyline line{place(node)};
    for (Index before = from_[static_cast<std::size_t>(node)]; before != node;
         before = from_[static_cast<std::size_t>(node)]) {
        node = before;
        line.push_back(place(node));
    }
    std::reverse(line.begin(), line.end());
    return smoothed_path(line);
}

RunoutPath runout_path(const Raster& bed, const FlowTracks& tracks, std::size_t start, const Vec2& from) {
    RunoutPath path;
    path.line = steepest_path(bed, from);
    path.start = start, path.front = from;
    const Polyline track = tracks.track_from(start);
    const std::optional<Index> part = tracks.part_at(from);
    if (track.empty() || !part) return path;
    path.front = track.back();
    constexpr double kHalf = 0.5;
    const double length = length_of(track);
    if (!(length > kNoticeable * bed.geometry.cell) || covered_length(path.line, tracks, *part) >= kHalf * length)
        return path;
    path.line = track, path.of_flow = true;
    const Polyline on = steepest_path(bed, path.front);
    if (on.size() > 1) path.line.insert(path.line.end(), on.begin() + 1, on.end());
    return path;
}

std::vector<RunoutPath> runout_paths(const Raster& bed, const Raster& depth, double limit, const FlowTracks& tracks,
                                     const std::vector<Vec2>& starts) {
    std::vector<RunoutPath> paths;
    const auto is_apart = [&](const RunoutPath& path, const RunoutPath& larger) {
        const bool touches = tracks.part_at(path.line.front()) == tracks.part_at(larger.line.front());
        const double went = place_along(path.line, path.front).place;
        if (!touches && went > kNoticeable * bed.geometry.cell) return true;
        const Vec2 nearby = point_along(larger.line, place_along(larger.line, path.front).place);
        return ridge_between(bed, depth, limit, path.front, nearby);
    };
    for (std::size_t n = 0; n < starts.size(); ++n) {
        RunoutPath path = runout_path(bed, tracks, n, starts[n]);
        if (length_of(path.line) > 0.0 &&
            std::all_of(paths.begin(), paths.end(), [&](const RunoutPath& larger) { return is_apart(path, larger); }))
            paths.push_back(std::move(path));
    }
    return paths;
}

std::string remark_on_track(const RunoutPath& path) {
    return fmt::format(
        "the flow from {:.10g}, {:.10g} left the steepest path before half of its way; its runout is along its own "
        "track, "
        "and from its front at {:.10g}, {:.10g} on along the steepest path",
        path.line.front().x(), path.line.front().y(), path.front.x(), path.front.y());
}

std::string remark_on_others(const Vec2& start) {
    return fmt::format(
        "flows from several places do not meet, or went down different valleys; the runout is that from {:.10g}, "
        "{:.10g}",
        start.x(), start.y());
}

std::vector<Rings> rings_of_parts(const std::vector<Polyline>& paths, const FlowTracks& tracks, const Rings& outline) {
    std::vector<std::optional<Index>> parts(paths.size());
    for (std::size_t n = 0; n < paths.size(); ++n) parts[n] = tracks.part_at(paths[n].front());
    std::vector<Rings> rings(paths.size());
    for (const auto& ring : outline) {
        const std::optional<Index> part = tracks.part_at(ring.front());
        const bool is_of_none = std::find(parts.begin(), parts.end(), part) == parts.end();
        for (std::size_t n = 0; n < paths.size(); ++n)
            if (is_of_none || part == parts[n]) rings[n].push_back(ring);
    }
    return rings;
}

std::vector<Rings> rings_of_parts(const std::vector<Polyline>& paths, const Raster& depth, double limit,
                                  const Rings& outline) {
    if (paths.size() == 1) return {outline};
    return rings_of_parts(paths, FlowTracks(depth, limit, {}), outline);
}

std::vector<Rings> rings_of_polygons(const std::vector<Polyline>& paths, const Polygons& polygons, double step) {
    const auto starts_in = [&](const Polygon& polygon, std::size_t n) {
        return distance_to(polygon, paths[n].front()) <= step;
    };
    std::vector<char> starts_in_any(paths.size());
    for (std::size_t n = 0; n < paths.size(); ++n)
        starts_in_any[n] = std::any_of(polygons.parts.begin(), polygons.parts.end(),
                                       [&](const Polygon& polygon) { return starts_in(polygon, n); });
    std::vector<Rings> rings(paths.size());
    for (const Polygon& polygon : polygons.parts) {
        std::vector<char> starts(paths.size());
        for (std::size_t n = 0; n < paths.size(); ++n) starts[n] = starts_in(polygon, n);
        const bool is_of_none = std::find(starts.begin(), starts.end(), char{1}) == starts.end();
        const Rings of_it = rings_of(Polygons{{polygon}, "", ""});
        for (std::size_t n = 0; n < paths.size(); ++n)
            if (is_of_none || starts[n] != 0 || starts_in_any[n] == 0)
                rings[n].insert(rings[n].end(), of_it.begin(), of_it.end());
    }
    return rings;
}

FrontAlong front_of_own_part(const Polyline& path, const FlowTracks& tracks, const Rings& outline, double step) {
    const std::optional<Index> part = tracks.part_at(path.front());
    Rings own;
    if (part)
        for (const auto& ring : outline)
            if (tracks.part_at(ring.front()) == part) own.push_back(ring);
    return front_along(path, own, step);
}

}  // namespace frana
