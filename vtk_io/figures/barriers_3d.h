#pragma once
// Barriers as solids to be drawn, put together again from the patches of their faces.
#include <memory>
#include <vector>

#include "terrain/raster.h"
#include "terrain/triangle_mesh.h"
#include "vtk_io/barrier_top.h"
#include "vtk_io/reader.h"

namespace frana {

/// What can be seen of a barrier.
struct BarrierSolid {
    /// A patch of a face, cut where the barrier ends and a little below the ground.
    struct Piece {
        std::vector<Vec3> corners;  ///< [m]
        Vec3 normal{0, 0, 1};       ///< outward, unit length
        double pressure = 0.0;      ///< mean over the patch and those around it on its face [Pa]
    };
    int number = 0;  ///< of the barrier, in the case's order
    std::vector<Piece> pieces;
    std::vector<Polyline> rings;               ///< of the outline, open: the last corner is not the first [m]
    std::vector<std::vector<Vec3>> edges;      ///< along the top and down the corners
    Vec3 load{0, 0, 0};                        ///< of the pressure on the sides, of a mesh on all of it [N]
    Vec3 middle_of_load{0, 0, 0};              ///< where it acts, or without any the middle of the outline [m]
    std::shared_ptr<const TriangleMesh> mesh;  ///< of a barrier that was given as one: it has no rings

    /// Whether a place lies within the outline.
    bool within(const Vec2& p) const;
};

/// The solids of all barriers in `patches`. That has the faces of each in their order, the sides round the outline
/// before the top (observe/frame.h). A barrier of any shape, whose faces are those of a box, has no solid without its
/// mesh. A barrier without an entry in `tops` is as high as its sides. A node's force acts over three cells, but is
/// recorded with one patch. So each piece has the mean of up to 3 x 3 patches. Those of a side below the ground are left out.
std::vector<BarrierSolid> barrier_solids(const std::vector<LoadedPatch>& patches, const std::vector<BarrierTop>& tops,
                                         const Raster& bed, const BarrierMeshes& meshes = {});

}  // namespace frana
