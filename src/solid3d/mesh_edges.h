#pragma once
// Barriers given as meshes near their sharp edges, as prisms are there (prism.h).
#include <functional>

#include "solid3d/edge_faces.h"
#include "terrain/distance_field.h"

namespace frana {

/// The contact with the flat face before a place, or nearest to one inside. Where the face adjoins a sharp edge, it has
/// nothing that the field rounds there. Else the field's.
Contact sharp_contact(const DistanceField& shape, const Vec3& x);
/// Whether no material is before a face with that normal at a place on it. Below the ground a house's foot is no such
/// face.
using Hidden = std::function<bool(const Vec3& x, const Vec3& normal)>;
/// Prism::faces_at_edge.
MetFaces faces_at_edge(const DistanceField& shape, const Vec3& x, double cell, const Hidden& hidden, Contact* list,
                       int count);
/// Prism::mirror_share of the mirror particle at `place` of a point at x before `contact`.
double mirror_share(const DistanceField& shape, const Vec3& x, const Contact& contact, const Vec3& place, double blend,
                    const Hidden& hidden);

}  // namespace frana
