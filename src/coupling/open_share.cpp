#include "coupling/open_share.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "coupling/barriers.h"
#include "coupling/solid_scene.h"
#include "terrain/bed_points.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

/// West, south, east and north of what points can fill: walls of the terrain, and closed sides of the window [m].
std::array<double, 4> limits_of(const Scene& scene) {
    std::array<double, 4> limits = {-INFINITY, -INFINITY, INFINITY, INFINITY};
    const GridGeometry& g = scene.bed.geometry;
    if (are_closed(scene.sides)) limits = {g.x0, g.y0, g.x_max(), g.y_max()};
    if (!scene.solid) return limits;
    const std::array<double, 4> window = window_of(scene);
    for (std::size_t side = 0; side < 4; ++side)
        if (scene.solid->closed[side]) limits[side] = window[side];
    return limits;
}

constexpr int kParts = 16;  ///< of two cells, each way
constexpr int kAllParts = kParts * kParts;
using Taken = std::bitset<kAllParts>;

/// From a node to one of its parts [cells].
Vec2 to_part(int part) {
    const int column = part % kParts, row = part / kParts;
    return {2.0 * (column + 0.5) / kParts - 1.0, 2.0 * (row + 0.5) / kParts - 1.0};
}

/// Of a part in what its node stands for.
double weight_of(int part) {
    const Vec2 away = to_part(part);
    return (1.0 - std::abs(away.x())) * (1.0 - std::abs(away.y()));
}

/// A box of a grid's nodes.
struct BoxOfNodes {
    GridGeometry grid;
    NodeBox box;

    /// body(number in the box, place) of those around these corners.
    template <class Body>
    void each_around(const std::vector<Vec2>& corners, Body&& body) const {
        const NodeBox near = common(widened(cells_of(corners, grid), 1), box);
        for (Index j = near.j0; j < near.j0 + near.ny; ++j)
            for (Index i = near.i0; i < near.i0 + near.nx; ++i)
                body((j - box.j0) * box.nx + i - box.i0, Vec2(grid.x(i), grid.y(j)));
    }
};

/// What is taken of each node that anything may take room from.
class TakenRoom {
public:
    explicit TakenRoom(const BoxOfNodes& nodes) : nodes_(nodes) {}

    /// Marks the parts of nodes around these corners at which `takes(place)` holds.
    template <class Takes>
    void mark(const std::vector<Vec2>& corners, Takes&& takes) {
        nodes_.each_around(corners, [&](Index node, const Vec2& at) {
            Taken& taken = taken_[node];
            for (int part = 0; part < kAllParts; ++part)
                if (takes(Vec2(at + nodes_.grid.cell * to_part(part)))) taken.set(part);
        });
    }
    const std::map<Index, Taken>& by_node() const { return taken_; }

private:
    BoxOfNodes nodes_;
    std::map<Index, Taken> taken_;
};

void mark_sides(const Scene& scene, TakenRoom& room) {
    const GridGeometry& g = scene.bed.geometry;
    const std::array<double, 4> limits = limits_of(scene);
    for (std::size_t side = 0; side < 4; ++side) {
        const double at = limits[side];
        if (std::isinf(at)) continue;
        const int axis = side % 2 == 0 ? 0 : 1;
        const std::vector<Vec2> line =
            axis == 0 ? std::vector<Vec2>{{at, g.y0}, {at, g.y_max()}} : std::vector<Vec2>{{g.x0, at}, {g.x_max(), at}};
        room.mark(line, [&](const Vec2& place) { return side < 2 ? place[axis] < at : place[axis] > at; });
    }
}

/// A barrier that takes room where it stands out of the ground.
struct Solid {
    Surface surface;
    std::vector<Vec2> corners;  ///< of the box around it

    Solid(const Barrier& barrier, const Scene& scene) : surface(surface_around(barrier, scene)) {
        const auto [low, high] = box_around(surface);
        corners = {low.head<2>(), high.head<2>()};
    }
    /// Minus infinity where it takes none [m].
    double top_at(const Vec2& place, const Raster& bed) const {
        const double top = top_of(surface, place);
        return top > bed_elevation(bed, place.x(), place.y()) ? top : -INFINITY;
    }
};

/// 0 where it is next to nothing: points there are on top.
double open_share(const Taken& taken) {
    constexpr double kNothing = 0.05;
    double all = 0.0, open = 0.0;
    for (int part = 0; part < kAllParts; ++part) {
        all += weight_of(part);
        if (!taken[part]) open += weight_of(part);
    }
    return open < kNothing * all ? 0.0 : open / all;
}

/// Up to where barriers take a node's parts [m].
using Tops = std::array<double, kAllParts>;

/// Of nodes that have some room on the bed, and not all. On the others nothing stands below a top.
std::map<Index, Tops> tops_of(const std::vector<Solid>& solids, const Raster& bed, const BoxOfNodes& nodes,
                              const std::vector<double>& at_bed) {
    Tops none;
    none.fill(-INFINITY);
    std::map<Index, Tops> tops;
    for (const Solid& solid : solids)
        nodes.each_around(solid.corners, [&](Index node, const Vec2& at) {
            if (!(at_bed[static_cast<std::size_t>(node)] < 1.0)) return;
            int part = 0;
            for (double& top : tops.try_emplace(node, none).first->second)
                top = std::max(top, solid.top_at(at + nodes.grid.cell * to_part(part++), bed));
        });
    return tops;
}

/// The share that is open above each top, with the top before it: upwards. Sides take theirs at any height.
std::map<double, double> shares_above(const Tops& tops, const Taken& by_sides) {
    std::map<double, double> above;
    double open = 0.0, all = 0.0;
    for (int part = 0; part < kAllParts; ++part) {
        all += weight_of(part);
        if (!by_sides[part]) above[tops[static_cast<std::size_t>(part)]] += weight_of(part);
    }
    for (auto& [top, share] : above) share = (open += share) / all;
    above.erase(-INFINITY);  // what is open on the bed
    return above;
}

}  // namespace

OpenShares::OpenShares(const Scene& scene, const NodeBox& box)
    : at_bed_(static_cast<std::size_t>(box.nx * box.ny), 1.0) {
    const BoxOfNodes nodes{scene.bed.geometry, box};
    TakenRoom room(nodes);
    mark_sides(scene, room);
    const std::map<Index, Taken> by_sides = room.by_node();
    std::vector<Solid> solids;
    if (scene.solid)
        for (const Barrier& barrier : scene.barriers) solids.emplace_back(barrier, scene);
    for (const Solid& solid : solids)
        room.mark(solid.corners, [&](const Vec2& place) { return std::isfinite(solid.top_at(place, scene.bed)); });
    std::set<Index> filled;
    for (const auto& [node, taken] : room.by_node()) {
        const double open = open_share(taken);
        at_bed_[static_cast<std::size_t>(node)] = open > 0.0 ? open : 1.0;
        if (!(open > 0.0)) filled.insert(node);
    }
    for (const Solid& solid : solids)
        nodes.each_around(solid.corners, [&](Index node, const Vec2& at) {
            const double top = filled.count(node) ? solid.top_at(at, scene.bed) : -INFINITY;
            if (std::isfinite(top)) top_below_[node] = std::fmax(this->top_below(node), top);
        });
    const std::map<Index, Tops> tops = tops_of(solids, scene.bed, nodes, at_bed_);
    if (!tops.empty()) begin_.assign(at_bed_.size() + 1, 0);
    for (const auto& [node, own] : tops) {
        const auto k = static_cast<std::size_t>(node);
        const auto sides = by_sides.find(node);
        for (const auto& [top, share] : shares_above(own, sides == by_sides.end() ? Taken{} : sides->second))
            steps_.push_back({top, at_bed_[k] / share}), ++begin_[k + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
}

}  // namespace frana
