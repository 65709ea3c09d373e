#pragma once
// Barriers of any shape as solids to be drawn. They have their mesh, with the pressure on the sides of the box around
// it.
#include <array>
#include <memory>
#include <vector>

#include "vtk_io/figures/barriers_3d.h"
#include "vtk_io/figures/faces_3d.h"

namespace frana {

/// The mesh in pieces of a patch, without those under the ground. The six faces are the sides of a box, towards -x, +x,
/// -y, +y, -z and +z (terrain/distance_field.h). A piece has the pressure of the face that it is turned to. One between
/// two faces has the sum of both, for the force may have been recorded with either. Two walls of a mesh that are turned
/// to the same face one behind the other have one pressure.
BarrierSolid mesh_solid(const std::vector<LoadedFace>& faces, std::shared_ptr<const TriangleMesh> mesh,
                        const Raster& bed);

/// Where neighbouring triangles turn by more than 30 degrees, in parts no longer than `longest` [m].
std::vector<std::vector<Vec3>> sharp_edges(const TriangleMesh& mesh, double longest);

/// A barrier that is a mesh in a vertical plane: distances along it and elevations [m].
struct MeshCut {
    std::vector<std::vector<Vec2>> areas;     ///< convex, together all that is inside
    std::vector<std::vector<Vec2>> outlines;  ///< the last corner is the first
    /// Part of the outline that is loaded.
    struct Strip {
        Vec2 from, to, inward;  ///< the last of unit length
        double pressure;        ///< [Pa]
    };
    std::vector<Strip> strips;
};

/// In the plane through `from` along the unit vector `along` of the map.
MeshCut cut_of(const BarrierSolid& barrier, const Vec2& from, const Vec2& along);

}  // namespace frana
