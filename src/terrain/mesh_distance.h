#pragma once
#include "terrain/distance_field.h"
#include "terrain/triangle_mesh.h"

namespace frana {

/// Fills a field with its sharp edges, and with the signed distances from a closed mesh. The mesh's triangles all run
/// the same way round. Distances are below zero on the side that they turn away from. On all threads, with the same
/// bits on any number of them.
void measure_distances(const TriangleMesh& mesh, DistanceField& field);

}  // namespace frana
