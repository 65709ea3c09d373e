#pragma once
// How far around a 3D stage's window its points and depth-averaged particles act on each other.
#include <cmath>

#include "scene/scene.h"

namespace frana {

/// Nodes of the terrain, `cell` [m] apart. 3D points come out by a cell of the terrain. They and particles reach 3/2 cells of
/// the 3D grid each. Particles are half a cell of the terrain wide each way.
inline Index reach_around(const SolidStage& stage, double cell) {
    return static_cast<Index>(std::ceil((1.5 * cell + 3.0 * stage.cell) / cell));
}

}  // namespace frana
