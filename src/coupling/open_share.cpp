#include "coupling/open_share.h"

#include <array>
#include <bitset>
#include <cmath>
#include <map>

#include "coupling/barriers.h"
#include "coupling/solid_scene.h"
#include "particles/bed_points.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

/// West, south, east and north of what points can fill: walls of the terrain, and closed sides of the window [m].
std::array<double, 4> limits_of(const Scene& scene) {
    std::array<double, 4> limits = {-INFINITY, -INFINITY, INFINITY, INFINITY};
    const GridGeometry& g = scene.bed.geometry;
    if (scene.sides == Sides::wall) limits = {g.x0, g.y0, g.x_max(), g.y_max()};
    if (!scene.solid) return limits;
    const std::array<double, 4> window = window_of(scene);
    for (std::size_t side = 0; side < 4; ++side)
        if (scene.solid->closed[side]) limits[side] = window[side];
    return limits;
}

constexpr int kParts = 16;  ///< of two cells, each way
using Taken = std::bitset<kParts * kParts>;

/// From a node to one of its parts [cells].
Vec2 to_part(int part) {
    return {2.0 * (part % kParts + 0.5) / kParts - 1.0, 2.0 * (part / kParts + 0.5) / kParts - 1.0};
}

/// What is taken of each node that anything takes room from.
class TakenRoom {
public:
    explicit TakenRoom(const GridGeometry& grid) : g_(grid) {}

    /// Marks the parts of nodes around these corners at which `takes(place)` holds.
    template <class Takes>
    void mark(const std::vector<Vec2>& corners, Takes&& takes) {
        const NodeBox box = common(widened(cells_of(corners, g_), 1), NodeBox::all(g_));
        for (Index j = box.j0; j < box.j0 + box.ny; ++j)
            for (Index i = box.i0; i < box.i0 + box.nx; ++i) {
                Taken& taken = taken_[j * g_.nx + i];
                for (int part = 0; part < kParts * kParts; ++part)
                    if (takes(Vec2(Vec2(g_.x(i), g_.y(j)) + g_.cell * to_part(part)))) taken.set(part);
            }
    }
    const std::map<Index, Taken>& by_node() const { return taken_; }

private:
    GridGeometry g_;
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

/// What stands out of the ground.
void mark_barriers(const Scene& scene, TakenRoom& room) {
    for (const Barrier& barrier : scene.barriers) {
        const Surface solid = surface_around(barrier, scene);
        const auto [low, high] = box_around(solid);
        room.mark({low.head<2>(), high.head<2>()}, [&](const Vec2& place) {
            const double top = top_of(solid, place);
            return std::isfinite(top) && top > bed_elevation(scene.bed, place.x(), place.y());
        });
    }
}

double open_share(const Taken& taken) {
    constexpr double kNothing = 0.05;  // points there are on top
    double all = 0.0, open = 0.0;
    for (int part = 0; part < kParts * kParts; ++part) {
        const Vec2 away = to_part(part);
        const double weight = (1.0 - std::abs(away.x())) * (1.0 - std::abs(away.y()));
        all += weight;
        if (!taken[part]) open += weight;
    }
    return open < kNothing * all ? 1.0 : open / all;
}

}  // namespace

std::vector<double> open_shares(const Scene& scene) {
    TakenRoom room(scene.bed.geometry);
    mark_sides(scene, room);
    if (scene.solid) mark_barriers(scene, room);
    std::vector<double> shares(static_cast<std::size_t>(scene.bed.geometry.size()), 1.0);
    for (const auto& [node, taken] : room.by_node()) shares[static_cast<std::size_t>(node)] = open_share(taken);
    return shares;
}

}  // namespace frana
