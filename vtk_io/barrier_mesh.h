#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "scene/toolbox.h"
#include "terrain/distance_field.h"
#include "terrain/triangle_mesh.h"

namespace frana {

/// A closed surface of triangles (.stl, .vtp or .obj, in metres) as signed distances, in map coordinates.
/// It may have several parts and point inwards, but all of it one way. Throws UserError when it cannot be
/// read, is open, turns its sides or cuts through itself. So too if it would need more than 10^8 nodes.
DistanceField read_barrier_mesh(const std::filesystem::path& file, const MeshSampling& sampling);

/// The same for build_scene().
MeshField barrier_mesh_of(const std::filesystem::path& file, const MeshSampling& sampling);

/// Makes that tell `say` beforehand, in one line, of a mesh that takes a second or more.
MeshReader barrier_meshes_told(std::function<void(const std::string&)> say);

/// The triangles of such a file in map coordinates, turned outwards, for pictures; `origin` [m] as in MeshSampling.
/// Throws UserError when it cannot be read.
TriangleMesh barrier_triangles(const std::filesystem::path& file, const Vec3& origin);

}  // namespace frana
