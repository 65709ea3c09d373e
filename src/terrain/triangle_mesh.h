#pragma once
// A surface of triangles.
#include <array>
#include <memory>
#include <vector>

#include "base/types.h"

namespace frana {

/// A closed surface. Its triangles name their corners counter-clockwise as seen from outside.
struct TriangleMesh {
    std::vector<Vec3> points;  ///< map coordinates and elevation [m]
    std::vector<std::array<Index, 3>> triangles;
};

/// The meshes of a run's barriers in the case's order; nullptr for a barrier that was given otherwise.
using BarrierMeshes = std::vector<std::shared_ptr<const TriangleMesh>>;

}  // namespace frana
