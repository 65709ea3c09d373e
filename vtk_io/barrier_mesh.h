#pragma once
#include <filesystem>

#include "solid/distance_field.h"

namespace frana {

/// How a mesh becomes a field of distances.
struct MeshSampling {
    double spacing = 1.0;  ///< between the field's nodes [m]
    double margin =
        0.0;  ///< that the field reaches beyond the mesh [m]: image_reach() cells of the flow's grid
};

/// A closed surface of triangles (.stl, .vtp or .obj, coordinates in the map's metres) as signed distances.
/// It may have several parts and point inwards, but all of it one way. Throws UserError when it cannot be
/// read, is open, turns its sides, cuts through itself, or would need more than 10^8 nodes.
DistanceField read_barrier_mesh(const std::filesystem::path& file, const MeshSampling& sampling);

}  // namespace frana
