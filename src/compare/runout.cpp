#include "compare/runout.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/error.h"
#include "compare/nearest.h"
#include "terrain/connected_nodes.h"
#include "terrain/places.h"

namespace frana {
namespace {

struct Neighbour {
    Index di, dj;
    double distance;  ///< in cells
};
constexpr double diagonal = 1.4142135623730951;
constexpr Neighbour neighbours[] = {{1, 0, 1.0},      {-1, 0, 1.0},      {0, 1, 1.0},       {0, -1, 1.0},
                                    {1, 1, diagonal}, {1, -1, diagonal}, {-1, 1, diagonal}, {-1, -1, diagonal}};

/// Water on a raster: where it runs from each node.
class Drainage {
public:
    explicit Drainage(const Raster& bed) : bed_(bed) {}

    /// Nodes from `start` to where they stay on the edge of the terrain. A way that starts on it leaves it first.
    std::vector<Index> from(Index start) {
        std::vector<Index> nodes{start};
        const std::size_t on_edge = follow(nodes);
        if (on_edge > 1) nodes.resize(nodes.size() - on_edge + 1);
        return nodes;
    }

private:
    /// Lengthens a way of one node until it stays on the edge or cannot go on. Returns how many of its last nodes lie on
    /// the edge. A way that touches it and turns back inside goes on.
    std::size_t follow(std::vector<Index>& nodes) {
        constexpr std::size_t stay = 11;  // as many as a path is smoothed over
        Index node = nodes.front();
        bool inside = !at_outer_edge(node);
        std::size_t on_edge = 0;
        const auto goes_on = [&](Index next) {
            nodes.push_back(next);
            const bool outer = at_outer_edge(next);
            on_edge = inside && outer ? on_edge + 1 : 0;
            inside = inside || !outer;
            return on_edge < stay;
        };
        for (;;) {
            const Index below = steepest(node);
            if (below != edge) {
                if (!goes_on(node = below)) return on_edge;
                continue;
            }
            if (at_edge(node)) return on_edge;
            if (way_out_.empty()) flood();  // takes long on a large terrain, where the way may have no hollow
            const double hollow = height(node);
            do {  // every way out of a hollow ends below it or at the edge
                node = way_out_[static_cast<std::size_t>(node)];
                if (node == edge || !goes_on(node)) return on_edge;
            } while (height(node) >= hollow);
        }
    }

    static constexpr Index unseen = -2, edge = -1;
    enum : char { unknown, within, beyond };  ///< nodata: in a hole of the terrain, or around it

    double height(Index node) const { return bed_.values[static_cast<std::size_t>(node)]; }

    /// The adjacent node, or `edge` where there is none with an elevation.
    Index adjacent(Index node, const Neighbour& n) const {
        const GridGeometry& g = bed_.geometry;
        const Index i = node % g.nx + n.di, j = node / g.nx + n.dj;
        if (i < 0 || j < 0 || i >= g.nx || j >= g.ny || std::isnan(bed_.at(i, j))) return edge;
        return j * g.nx + i;
    }

    Index steepest(Index node) const {
        Index best = edge;
        double most = 0.0;
        for (const Neighbour& n : neighbours) {
            const Index other = adjacent(node, n);
            if (other == edge) continue;
            const double drop = (height(node) - height(other)) / n.distance;
            if (drop > most) most = drop, best = other;
        }
        return best;
    }

    bool at_edge(Index node) const {
        return std::any_of(std::begin(neighbours), std::end(neighbours),
                           [&](const Neighbour& n) { return adjacent(node, n) == edge; });
    }

    /// Beside the grid's edge, or nodata that reaches it. Along a hole of nodata a way may run on.
    bool at_outer_edge(Index node) {
        const GridGeometry& g = bed_.geometry;
        const Index i = node % g.nx, j = node / g.nx;
        if (i == 0 || j == 0 || i == g.nx - 1 || j == g.ny - 1) return true;
        return std::any_of(std::begin(neighbours), std::end(neighbours), [&](const Neighbour& n) {
            const Index other = (j + n.dj) * g.nx + i + n.di;
            return std::isnan(height(other)) && reaches_edge(other);
        });
    }

    /// Of a node of nodata; all those that are connected with it are then known.
    bool reaches_edge(Index first) {
        const GridGeometry& g = bed_.geometry;
        if (nodata_.empty()) nodata_.assign(bed_.values.size(), unknown);
        if (const char known = nodata_[static_cast<std::size_t>(first)]; known != unknown) return known == beyond;
        std::vector<Index> hole{first};
        nodata_[static_cast<std::size_t>(first)] = within;
        bool reaches = false;
        for (std::size_t k = 0; k < hole.size(); ++k)
            for (const Neighbour& n : neighbours) {
                const Index i = hole[k] % g.nx + n.di, j = hole[k] / g.nx + n.dj, other = j * g.nx + i;
                if (i < 0 || j < 0 || i >= g.nx || j >= g.ny) {
                    reaches = true;
                    continue;
                }
                if (!std::isnan(height(other)) || nodata_[static_cast<std::size_t>(other)] != unknown) continue;
                nodata_[static_cast<std::size_t>(other)] = within;
                hole.push_back(other);
            }
        if (reaches)
            for (const Index node : hole) nodata_[static_cast<std::size_t>(node)] = beyond;
        return reaches;
    }

    /// From the edge inwards, always on from the node with the lowest way to the edge.
    void flood() {
        way_out_.assign(bed_.values.size(), unseen);
        using Level = std::pair<double, Index>;
        std::priority_queue<Level, std::vector<Level>, std::greater<>> front;
        for (Index node = 0; node < bed_.geometry.size(); ++node)
            if (!std::isnan(height(node)) && at_edge(node)) {
                way_out_[static_cast<std::size_t>(node)] = edge;
                front.emplace(height(node), node);
            }
        while (!front.empty()) {
            const auto [level, node] = front.top();
            front.pop();
            for (const Neighbour& n : neighbours) {
                const Index other = adjacent(node, n);
                if (other == edge || way_out_[static_cast<std::size_t>(other)] != unseen) continue;
                way_out_[static_cast<std::size_t>(other)] = node;
                front.emplace(std::max(level, height(other)), other);
            }
        }
    }

    const Raster& bed_;
    std::vector<Index> way_out_;
    std::vector<char> nodata_;
};

/// The node nearest to the centroid of them all.
Vec2 middle_of(const std::vector<Index>& nodes, const GridGeometry& g) {
    const auto place = [&](Index node) { return Vec2(g.x(node % g.nx), g.y(node / g.nx)); };
    Vec2 sum(0, 0);
    for (const Index node : nodes) sum += place(node);
    const Vec2 centroid = sum / static_cast<double>(nodes.size());
    return place(*std::min_element(nodes.begin(), nodes.end(), [&](Index a, Index b) {
        return (place(a) - centroid).squaredNorm() < (place(b) - centroid).squaredNorm();
    }));
}

/// Calls f(point) along the edges of a ring, a step apart at most.
template <class F>
void for_each_point(const std::vector<Vec2>& ring, double step, F&& f) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
        const Vec2 edge = ring[(k + 1) % ring.size()] - ring[k];
        const int parts = std::max(1, static_cast<int>(std::ceil(edge.norm() / step)));
        for (int part = 0; part < parts; ++part) f(ring[k] + static_cast<double>(part) / parts * edge);
    }
}

void add_to(FrontAlong& front, const PlaceAlong& at) {
    if (!(at.place <= front.place)) front.place = at.place;
    front.meets_end = front.meets_end || at.at_end;
    double& farthest = at.off_end ? front.off_end : front.off_path;
    farthest = std::max(farthest, at.distance);
}

}  // namespace

Polyline steepest_path(const Raster& bed, const Vec2& start) {
    const GridGeometry& g = bed.geometry;
    const NodeAt first = nearest_node(g, start);
    if (!has_node(g, first) || std::isnan(bed.at(first.i, first.j))) return {};
    Polyline line;
    for (const Index node : Drainage(bed).from(first.j * g.nx + first.i))
        line.emplace_back(g.x(node % g.nx), g.y(node / g.nx));
    return smoothed_path(line);
}

Polyline smoothed_path(const Polyline& line) {
    constexpr Index reach = 5;
    Polyline result;
    const auto last = static_cast<Index>(line.size()) - 1;
    for (Index k = 0; k <= last; ++k) {
        const Index r = std::min({reach, k, last - k});
        Vec2 sum(0, 0);
        for (Index m = k - r; m <= k + r; ++m) sum += line[static_cast<std::size_t>(m)];
        result.push_back(sum / static_cast<double>(2 * r + 1));
    }
    return result;
}

std::vector<Vec2> release_middles(const Raster& arrival_time) {
    constexpr std::size_t most = 9;
    const GridGeometry& g = arrival_time.geometry;
    std::vector<char> open(arrival_time.values.size());
    for (std::size_t k = 0; k < open.size(); ++k) open[k] = arrival_time.values[k] == 0.0;
    std::vector<std::vector<Index>> releases;
    for (Index first = 0; first < g.size(); ++first) {
        if (!open[static_cast<std::size_t>(first)]) continue;
        releases.push_back(take_connected(g, open, first));
    }
    std::stable_sort(releases.begin(), releases.end(),
                     [](const auto& a, const auto& b) { return a.size() > b.size(); });
    std::vector<Vec2> middles;
    for (std::size_t k = 0; k < std::min(most, releases.size()); ++k) middles.push_back(middle_of(releases[k], g));
    return middles;
}

bool ridge_between(const Raster& bed, const Raster& peak_depth, double limit, const Vec2& a, const Vec2& b) {
    constexpr double steepness = 0.05;
    const auto value = [](const Raster& raster, const Vec2& p) {
        const NodeAt node = nearest_node(raster.geometry, p);
        return has_node(raster.geometry, node) ? raster.at(node.i, node.j) : Raster::nodata;
    };
    const double distance = (b - a).norm(), parts = std::ceil(2.0 * distance / bed.geometry.cell);
    const double ridge = std::max(value(bed, a), value(bed, b)) + steepness * distance;
    for (double part = 1.0; part < parts; ++part) {
        const Vec2 p = a + part / parts * (b - a);
        if (value(bed, p) > ridge && !(value(peak_depth, p) > limit)) return true;
    }
    return false;
}

PlaceAlong place_along(const Polyline& path, const Vec2& p) {
    PlaceAlong nearest;
    double before = 0.0, ahead = 0.0, aside = 0.0;  // of the last segment's end, along it and across
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const Vec2 along = path[k + 1] - path[k];
        const double length = along.norm();
        if (!(length > 0.0)) continue;
        const double t = nearest_fraction(path[k], path[k + 1], p);
        const double distance = (p - path[k] - t * along).norm();
        if (distance < nearest.distance) nearest = {before + t * length, distance};
        before += length;
        const Vec2 from_end = p - path[k + 1], direction = along / length;
        ahead = from_end.dot(direction);
        aside = std::abs(direction.x() * from_end.y() - direction.y() * from_end.x());
    }
    nearest.at_end = nearest.place >= before;
    nearest.off_end = nearest.at_end ? aside > ahead : nearest.place + nearest.distance > before;
    if (!nearest.at_end) return nearest;
    const double counted = std::clamp(2.0 * ahead - aside, 0.0, ahead);
    nearest.place += counted;
    nearest.distance = std::hypot(ahead - counted, aside);
    return nearest;
}

std::vector<FrontAlong> fronts_along(const std::vector<Polyline>& paths, const std::vector<Rings>& outlines,
                                     double step) {
    expect(paths.size() == outlines.size(), "each path has its rings");
    for (const Polyline& path : paths) expect(path.size() >= 2 && length_of(path) > 0.0, "a path has a length");
    const auto has = [&](std::size_t n, const std::vector<Vec2>& ring) {
        return std::find(outlines[n].begin(), outlines[n].end(), ring) != outlines[n].end();
    };
    std::vector<FrontAlong> fronts(paths.size());
    for (std::size_t n = 0; n < paths.size(); ++n)
        for (const auto& ring : outlines[n]) {
            std::vector<std::size_t> rivals;
            for (std::size_t m = 0; m < paths.size(); ++m)
                if (m != n && has(m, ring)) rivals.push_back(m);
            for_each_point(ring, step, [&](const Vec2& p) {
                const PlaceAlong at = place_along(paths[n], p);
                const auto is_nearer = [&](std::size_t m) {
                    return place_along(paths[m], p).distance + step < at.distance;
                };
                if (std::none_of(rivals.begin(), rivals.end(), is_nearer)) add_to(fronts[n], at);
            });
        }
    return fronts;
}

FrontAlong front_along(const Polyline& path, const Rings& outline, double step) {
    return fronts_along({path}, {outline}, step).front();
}

double reach_along(const Polyline& path, const Rings& outline, double step) {
    return front_along(path, outline, step).place;
}

double farthest_from(const Vec2& start, const Rings& outline) {
    double farthest = Raster::nodata;
    for (const auto& ring : outline)
        for (const Vec2& v : ring)
            if (std::isnan(farthest) || (v - start).norm() > farthest) farthest = (v - start).norm();
    return farthest;
}

double length_of(const Polyline& path) {
    double length = 0.0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) length += (path[k + 1] - path[k]).norm();
    return length;
}

Vec2 point_along(const Polyline& path, double distance) {
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const double length = (path[k + 1] - path[k]).norm();
        if (length > 0.0 && distance <= length) return path[k] + distance / length * (path[k + 1] - path[k]);
        distance -= length;
    }
    return path.back();
}

std::string remark_on_end(double length, double farthest, double allowed) {
    if (!std::isgreater(farthest, length + allowed)) return "";  // there may be none
    return fmt::format("the path ends {:.4g} m before the farther front and goes on straight there", farthest - length);
}

bool turns_off(const FrontAlong& front, double allowed) {
    return front.meets_end && front.off_end > front.off_path + allowed;
}

std::string remark_on_turn(const FrontAlong& front, double allowed) {
    if (!turns_off(front, allowed)) return "";
    return fmt::format("the path ends before the flow does, whose outline lies up to {:.4g} m aside of that end",
                       front.off_end);
}

}  // namespace frana
