#pragma once
// How far around a 3D stage's window its points and depth-averaged particles act on each other.
#include <array>
#include <cmath>

#include "scene/scene.h"
#include "terrain/part_of.h"

namespace frana {

/// Nodes of the terrain, `cell` [m] apart. 3D points come out by a cell of the terrain. They and particles reach 3/2 cells of
/// the 3D grid each. Particles are half a cell of the terrain wide each way.
inline Index reach_around(const SolidStage& stage, double cell) {
    return static_cast<Index>(std::ceil((1.5 * cell + 3.0 * stage.cell) / cell));
}

inline NodeBox window_nodes(const SolidStage& stage) {
    const std::array<Index, 4>& w = stage.window;
    return {w[0], w[1], w[2] - w[0] + 1, w[3] - w[1] + 1};
}

/// All nodes that points, and particles that they feel, can give anything to: the window and its rim. Without a stage
/// the whole terrain.
inline NodeBox nodes_of_points(const Scene& scene) {
    constexpr Index kStencil = 2;  // of what stands at the outermost of these nodes
    const NodeBox all = NodeBox::all(scene.bed.geometry);
    if (!scene.solid) return all;
    const Index more = reach_around(*scene.solid, scene.bed.geometry.cell) + kStencil;
    return common(widened(window_nodes(*scene.solid), more), all);
}

}  // namespace frana
