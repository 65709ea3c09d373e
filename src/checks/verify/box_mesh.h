#pragma once
// A box as a closed mesh.
#include "terrain/distance_field.h"

namespace frana::verify {

/// Distances from the box between two corners [m], sampled as a case's meshes are. There are two nodes a cell of that
/// size [m], as far beyond the box as material meets it.
DistanceField box_as_mesh(const Vec3& low, const Vec3& high, double cell);

}  // namespace frana::verify
