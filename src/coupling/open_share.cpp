#include "coupling/open_share.h"

#include <algorithm>
#include <array>
#include <cmath>

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

/// What may take room at a place.
class Obstructions {
public:
    explicit Obstructions(const Scene& scene) : scene_(scene), limits_(limits_of(scene)) {
        if (!scene.solid) return;
        for (const Barrier& barrier : scene.barriers)
            surfaces_.push_back(surface_of(barrier, scene.bed, scene.solid->cell));
    }

    bool is_open(const Vec2& place) const {
        const bool within =
            place.x() >= limits_[0] && place.y() >= limits_[1] && place.x() <= limits_[2] && place.y() <= limits_[3];
        return within && std::none_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
                   const double top = top_of(surface, place);
                   return std::isfinite(top) && top > bed_elevation(scene_.bed, place.x(), place.y());
               });
    }

    /// Nodes that a barrier or a side may take room from.
    std::vector<NodeBox> near() const {
        const GridGeometry& g = scene_.bed.geometry;
        std::vector<NodeBox> boxes;
        const auto add = [&](const std::vector<Vec2>& corners) {
            boxes.push_back(common(widened(cells_of(corners, g), 1), NodeBox::all(g)));
        };
        for (const Surface& surface : surfaces_) {
            const auto [low, high] = box_around(surface);
            add({low.head<2>(), high.head<2>()});
        }
        for (std::size_t side = 0; side < 4; ++side) {
            if (std::isinf(limits_[side])) continue;
            if (side % 2 == 0)
                add({{limits_[side], g.y0}, {limits_[side], g.y_max()}});
            else
                add({{g.x0, limits_[side]}, {g.x_max(), limits_[side]}});
        }
        return boxes;
    }

private:
    const Scene& scene_;
    std::array<double, 4> limits_;
    std::vector<Surface> surfaces_;
};

double share_at(const Obstructions& obstructions, const Vec2& node, double cell) {
    constexpr int kParts = 16;         // of two cells, each way
    constexpr double kNothing = 0.05;  // points there are on top
    double all = 0.0, open = 0.0;
    for (int b = 0; b < kParts; ++b)
        for (int a = 0; a < kParts; ++a) {
            const Vec2 away(2.0 * (a + 0.5) / kParts - 1.0, 2.0 * (b + 0.5) / kParts - 1.0);
            const double weight = (1.0 - std::abs(away.x())) * (1.0 - std::abs(away.y()));
            all += weight;
            if (obstructions.is_open(node + cell * away)) open += weight;
        }
    return open < kNothing * all ? 1.0 : open / all;
}

}  // namespace

std::vector<double> open_shares(const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    std::vector<double> shares(static_cast<std::size_t>(g.size()), 1.0);
    const Obstructions obstructions(scene);
    for (const NodeBox& box : obstructions.near())
        for (Index j = box.j0; j < box.j0 + box.ny; ++j)
            for (Index i = box.i0; i < box.i0 + box.nx; ++i)
                shares[static_cast<std::size_t>(j * g.nx + i)] = share_at(obstructions, {g.x(i), g.y(j)}, g.cell);
    return shares;
}

}  // namespace frana
