#pragma once
// Barriers as solids: their surfaces for 3D points, the nodes that they raise for particles, and the ground around them.
#include <utility>
#include <vector>

#include "convert/flow_particles.h"
#include "scene/scene.h"
#include "solid3d/surfaces.h"

namespace frana {

/// The solid of a barrier for material on cells of that size. Walls along a line are so thick that both of their sides
/// are separate. Throws UserError for an outline without area or a line that turns too sharply.
Prism solid_of(const Barrier& barrier, const Raster& bed, double cell);

/// A node within a barrier, or within half a cell of it (nodes_of_outline()).
struct BarrierNode {
    Index i, j;
    double top;  ///< of the highest barrier there [m]
};

/// All of them, row after row. A barrier may lie below the bed, and then raises nothing.
std::vector<BarrierNode> barrier_nodes(const Scene& scene);

/// Those of one barrier, row after row, whether there is ground or not.
std::vector<BarrierNode> nodes_of(const Barrier& barrier, const Surface& solid, const Scene& scene);

/// A barrier of that scene as a 3D surface. Throws as solid_of().
Surface surface_of(const Barrier& barrier, const Raster& bed, double cell);

/// The same as particles meet it. It holds the ground around itself alone: terrains are large, and barriers many.
Surface surface_around(const Barrier& barrier, const Scene& scene);

/// Lowest and highest corner of the box around a barrier; of a shape without the room around it [m].
std::pair<Vec3, Vec3> box_around(const Surface& barrier);

/// Whether a place of the map is within such a box, or within `margin` of it.
bool near_box(const std::pair<Vec3, Vec3>& box, const Vec2& place, double margin);

/// Elevation of a barrier's top at a place of the map; minus infinity outside of it [m].
double top_of(const Surface& barrier, const Vec2& place);

/// Particles within a barrier's outline stand on it, which is ground to them. Points inside it would be forced out and
/// gain what that lifts them.
void stand_on_barriers(FlowParticles& particles, const std::vector<Surface>& surfaces);

/// The middle of the footprint, on the bed. A middle beyond the terrain is as high as the bed under the barrier nearest
/// to it: moments are about its foot wherever that is. `barrier` may be unknown.
Vec3 middle_of(const Surface& solid, const Barrier* barrier, const Scene& scene);

/// The ground that a barrier may be buried in, at the lowest that erosion may leave it. Nothing for one whose top
/// follows the ground.
Raster ground_around(const Barrier& barrier, const Surface& solid, const Scene& scene);

}  // namespace frana
