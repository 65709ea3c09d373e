#pragma once
// What barriers are in plan: their foot, and the box that structured particles meet in place of one.
#include <array>

#include "scene/scene.h"

namespace frana {

/// Least width of a box [cells]. It then holds three rows of nodes. Shape functions are three cells wide: with fewer rows
/// a particle before it has nodes behind it, and goes through.
constexpr double kBoxCells = 3.0;

/// A rectangle along x and y [m].
struct BarrierBox {
    Vec2 low, high;
    bool holds(const Vec2& place) const { return (place - place.cwiseMax(low).cwiseMin(high)).isZero(0.0); }
};

/// Around the one polygon of a barrier's outline.
BarrierBox bounds_of(const Barrier& barrier);
/// The same; where it is thinner than kBoxCells it is as wide, about its middle.
BarrierBox box_around(const Barrier& barrier, double cell);

/// The share of a barrier's foot within x and y of a low corner and of a high one [1]. The foot is its outline, its
/// line, or of a mesh the outline of `box` around it.
double share_of_foot(const Barrier& barrier, const BarrierBox& box, const std::array<double, 4>& window);

/// Of all nodes that a barrier's outline stands on, or along its line [m]; infinity where it has no ground.
double lowest_ground(const Barrier& barrier, const Raster& bed);
/// Whether the barrier's top lies no higher than all ground that it stands on: nothing meets it.
bool is_buried(const Barrier& barrier, const Raster& bed);

/// A remark on each barrier in whose box structured particles are released.
void remark_on_releases_in_boxes(Scene& scene);

}  // namespace frana
