#include "compare/runout.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "base/error.h"
#include "compare/nearest.h"
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

    /// Nodes from `start` to the edge of the terrain.
    std::vector<Index> from(Index start) {
        std::vector<Index> nodes{start};
        for (Index node = start;;) {
            const Index below = steepest(node);
            if (below != edge) {
                nodes.push_back(node = below);
                continue;
            }
            if (at_edge(node)) return nodes;
            if (way_out_.empty()) flood();  // takes long on a large terrain, where the way may have no hollow
            const double hollow = height(node);
            do {  // every way out of a hollow ends below it or at the edge
                node = way_out_[static_cast<std::size_t>(node)];
                if (node == edge) return nodes;
                nodes.push_back(node);
            } while (height(node) >= hollow);
        }
    }

private:
    static constexpr Index unseen = -2, edge = -1;

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
};

/// Mean over `reach` nodes on either side, fewer near the ends, which stay.
Polyline smoothed(const Polyline& line, Index reach) {
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

}  // namespace

Polyline steepest_path(const Raster& bed, const Vec2& start) {
    const GridGeometry& g = bed.geometry;
    const NodeAt first = nearest_node(g, start);
    if (!has_node(g, first) || std::isnan(bed.at(first.i, first.j))) return {};
    Polyline line;
    for (const Index node : Drainage(bed).from(first.j * g.nx + first.i))
        line.emplace_back(g.x(node % g.nx), g.y(node / g.nx));
    constexpr Index reach = 5;  // takes out the eight directions of the grid, leaves the bends of a valley
    return smoothed(line, reach);
}

std::optional<Vec2> release_middle(const Raster& arrival_time) {
    const GridGeometry& g = arrival_time.geometry;
    std::vector<Vec2> released;
    Vec2 sum(0, 0);
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (arrival_time.at(i, j) == 0.0) {
                released.emplace_back(g.x(i), g.y(j));
                sum += released.back();
            }
    if (released.empty()) return std::nullopt;
    const Vec2 centroid = sum / static_cast<double>(released.size());
    return *std::min_element(released.begin(), released.end(), [&](const Vec2& a, const Vec2& b) {
        return (a - centroid).squaredNorm() < (b - centroid).squaredNorm();
    });
}

double place_along(const Polyline& path, const Vec2& p) {
    double best = INFINITY, place = 0.0, before = 0.0;
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const Vec2 along = path[k + 1] - path[k];
        const double length = along.norm();
        if (!(length > 0.0)) continue;
        double t = nearest_fraction(path[k], path[k + 1], p);
        if (k + 2 == path.size()) t = std::max(t, (p - path[k]).dot(along) / (length * length));
        const double distance = (p - path[k] - t * along).norm();
        if (distance < best) {
            best = distance;
            place = before + t * length;
        }
        before += length;
    }
    return place;
}

double reach_along(const Polyline& path, const Rings& outline, double step) {
    expect(path.size() >= 2 && length_of(path) > 0.0, "a path has a length");
    double reach = Raster::nodata;
    for (const auto& ring : outline)
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2 edge = ring[(k + 1) % ring.size()] - ring[k];
            const int parts = std::max(1, static_cast<int>(std::ceil(edge.norm() / step)));
            for (int part = 0; part < parts; ++part) {
                const double place = place_along(path, ring[k] + static_cast<double>(part) / parts * edge);
                if (std::isnan(reach) || place > reach) reach = place;
            }
        }
    return reach;
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

std::string remark_on_end(double length, double farthest, double allowed) {
    if (!std::isgreater(farthest, length + allowed)) return "";  // there may be none
    return fmt::format("the path ends {:.4g} m before the farther front and goes on straight there", farthest - length);
}

}  // namespace frana
