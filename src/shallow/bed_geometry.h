#pragma once
// The bed for the solver, one number per node and quantity. It is computed once, and anew where it is eroded. THEORY
// (5) to (7).
#include <array>

#include "mpm/tile_grid.h"
#include "scene/scene.h"
#include "shallow/tile_box.h"

namespace frana {

/// Nodes that are no ground like others. Exits: the elevation model has no data, outside of the terrain or in a hole of
/// it. Or points that leave are noted, for another model to take them up. And holes that are walls, where nothing
/// leaves.
constexpr std::uint8_t kNoData = 1, kNoted = 2, kHole = 3, kWall = 4;
inline bool leads_out(std::uint8_t kind) { return kind != 0 && kind != kWall; }
inline bool has_no_data(std::uint8_t kind) { return kind == kNoData || kind == kHole || kind == kWall; }

/// Node values on the storage of a TileGrid, filled on all of it. Beyond walls they are mirrored, beyond open sides
/// extended linearly. Over nodata they have the nearest known value. A wall in a hole adds its height to that in z and ground.
struct BedGeometry {
    LazyArray<double> z;       ///< bed averaged with the node's own shape function, (1/A) int N_i Z dx [m]
    LazyArray<double> ground;  ///< the elevation model's own elevation at the node [m]
    std::array<double, 3> averaging{1.0, 0.0, 0.0};  ///< weights that make z of ground: centre, one, two nodes away
    LazyArray<double> z_min;                         ///< least z of the 5 x 5 neighbourhood [m]
    LazyArray<double> slope_x;  ///< dz/dx by the 4th-order stencil that also differentiates the free surface [1]
    LazyArray<double> slope_y;  ///< [1]
    LazyArray<double> hxx, hxy,
        hyy;                 ///< Hessian of the bed smoothed to `curvature_length` [1/m]; empty without curvature
    LazyArray<Pair> smooth;  ///< slopes of that smoothed bed, which the flow's path has [1]; empty on gentle terrain
    LazyArray<double> smoothed;    ///< that smoothed bed, where an erodible one may change it; otherwise empty [m]
    LazyArray<std::uint8_t> exit;  ///< 0, or what kind of node it is
    bool has_exits = false;        ///< some node is of such a kind
};

/// Slopes of the bed smoothed to `curvature_length`, which velocities along the bed follow [1].
LazyArray<Pair> smooth_slopes(const Scene& scene, const TileGrid& grid);

/// Fills the geometry of scene.bed for the scheme's shape function. quadratic: the elevation model is taken bilinear
/// between nodes, and its average with the B-spline is exact. Its weights are (1, 76, 230, 76, 1)/384 in each
/// direction. cubic: (1, 26, 66, 26, 1)/120. linear: z is the nodal elevation itself, as Fois et al. 2024 have it.
/// Throws UserError when scene.bed holds no data at all.
BedGeometry make_bed_geometry(const Scene& scene, const TileGrid& grid);

constexpr Index kSlopeReach = 2;  ///< reach of slopes and least elevations [nodes]

/// Slopes and least elevations of some of a tile's nodes anew, from z up to kSlopeReach nodes around.
void refresh_slopes(const TileGrid& grid, BedGeometry& bed, Index tile, const TileBox& nodes = TileBox::whole());
/// Slopes and curvature of the smoothed bed of a tile's nodes anew, from up to two nodes around. bed.smoothed is there.
void refresh_path(const TileGrid& grid, BedGeometry& bed, Index tile);

/// By how much a node falls when something is cut out of the ground.
struct NodeFall {
    Index k, i, j;           ///< its storage index, and its place
    double ground, z, path;  ///< of the numbers of BedGeometry; path: of `smoothed`, before that is smoothed [m]
};
/// All nodes that fall when so much is cut out of the ground, those beyond the sides too; row after row from the south.
std::vector<NodeFall> falls_of(const std::vector<ScarNode>& cut, const TileGrid& grid, const BedGeometry& bed,
                               bool walls);

/// A level bed at zero, without curvature.
BedGeometry level_bed(const TileGrid& grid);

}  // namespace frana
