#include "coupling/barriers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "coupling/solid_scene.h"
#include "scene/barrier_box.h"
#include "terrain/bed_points.h"
#include "terrain/outline_nodes.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Elevations of the nodes, `height` higher.
Raster lifted(Raster bed, double height) {
    for (double& z : bed.values) z += height;
    return bed;
}

/// The nodes that may be within a cell of a box, and some more.
NodeBox nodes_around(const std::pair<Vec3, Vec3>& box, const GridGeometry& g) {
    const auto& [low, high] = box;
    return common(widened(cells_of({low.head<2>(), high.head<2>()}, g), 1), NodeBox::all(g));
}

/// Cells that make a wall along a line as thick for particles as points will meet it. So none of them starts inside.
/// Where there are no points, and no thickness is given, it is a cell thick (least_wall_thickness() is three of them).
double cell_for_particles(const Barrier& barrier, const Scene& scene) {
    if (scene.solid) return scene.solid->cell;
    return barrier.thickness ? 0.0 : scene.bed.geometry.cell / 3.0;
}

/// The highest top of a shape within half a cell of a node.
double top_near(const Surface& barrier, const Vec2& node, double cell) {
    double top = -std::numeric_limits<double>::infinity();
    const int steps = static_cast<int>(std::ceil(0.5 * cell / barrier.shape->spacing));
    for (int j = -steps; j <= steps; ++j)
        for (int i = -steps; i <= steps; ++i)
            top = std::max(top, barrier.shape->top_at(node + 0.5 * cell / steps * Vec2(i, j)));
    return top;
}

/// The outline of a barrier that is no mesh.
Polygons plan_of(const Barrier& barrier, double cell) {
    if (barrier.line.empty()) return barrier.outline;
    const double least = least_wall_thickness(barrier.line, cell);
    return wall_outline(barrier.line, barrier.wet_left ? WetSide::left : WetSide::right,
                        std::max(barrier.thickness.value_or(0.0), least));
}

}  // namespace

std::pair<Vec3, Vec3> box_around(const Surface& barrier) {
    if (barrier.prism) return barrier.prism->box();
    const DistanceField& f = *barrier.shape;
    Vec3 low = f.end(), high = f.origin;
    for (Index k = 0; k < f.nodes[2]; ++k)
        for (Index j = 0; j < f.nodes[1]; ++j)
            for (Index i = 0; i < f.nodes[0]; ++i)
                if (f.at(i, j, k) < 0.0) low = low.cwiseMin(f.place(i, j, k)), high = high.cwiseMax(f.place(i, j, k));
    return {low, high};
}

double top_of(const Surface& barrier, const Vec2& place) {
    if (barrier.shape) return barrier.shape->top_at(place);
    const double top = barrier.prism->top_at(place);
    return barrier.prism->inside({place.x(), place.y(), top - 1.0}) ? top : -std::numeric_limits<double>::infinity();
}

bool near_box(const std::pair<Vec3, Vec3>& box, const Vec2& place, double margin) {
    const auto& [low, high] = box;
    return ((place - low.head<2>()).array() >= -margin).all() && ((high.head<2>() - place).array() >= -margin).all();
}

void stand_on_barriers(FlowParticles& particles, const std::vector<Surface>& surfaces) {
    for (const Surface& surface : surfaces) {
        if (!surface.is_barrier()) continue;
        for (std::size_t k = 0; k < particles.count(); ++k)
            particles.bed[k] = std::max(particles.bed[k], top_of(surface, {particles.x[k], particles.y[k]}));
    }
}

Prism solid_of(const Barrier& barrier, const Raster& bed, double cell) {
    const Polygons plan = plan_of(barrier, cell);
    if (barrier.top) return Prism(plan, *barrier.top);
    return Prism(plan, lifted(bed, barrier.height));
}

Surface surface_of(const Barrier& barrier, const Raster& bed, double cell) {
    const Hold hold = barrier.stuck ? Hold::stuck : Hold::free;
    const double friction = barrier.stuck ? 0.0 : barrier.friction;
    Surface surface = barrier.shape ? Surface::barrier(*barrier.shape, hold, friction)
                                    : Surface::barrier(solid_of(barrier, bed, cell), hold, friction);
    surface.name = barrier.name;
    return surface;
}

Surface surface_around(const Barrier& barrier, const Scene& scene) {
    const double cell = cell_for_particles(barrier, scene);
    if (barrier.shape) return surface_of(barrier, scene.bed, cell);
    std::vector<Vec2> corners;
    const Polygons plan = plan_of(barrier, cell);
    for (const Polygon& polygon : plan.parts)
        for (const auto& ring : polygon.rings) corners.insert(corners.end(), ring.begin(), ring.end());
    const GridGeometry& g = scene.bed.geometry;
    const NodeBox near = common(widened(cells_of(corners, g), 3), NodeBox::all(g));
    return surface_of(barrier, near.nx > 1 && near.ny > 1 ? part_of(scene.bed, near) : scene.bed, cell);
}

namespace {

std::vector<BarrierNode> nodes_of_shape(const Surface& shape, const GridGeometry& g) {
    std::vector<BarrierNode> nodes;
    const auto box = box_around(shape);
    const NodeBox near = nodes_around(box, g);
    for (Index j = near.j0; j < near.j0 + near.ny; ++j)
        for (Index i = near.i0; i < near.i0 + near.nx; ++i) {
            const Vec2 node(g.x(i), g.y(j));
            if (!near_box(box, node, 0.5 * g.cell)) continue;
            const double top = top_near(shape, node, g.cell);
            if (std::isfinite(top)) nodes.push_back({i, j, top});
        }
    return nodes;
}

}  // namespace

std::vector<BarrierNode> nodes_of(const Barrier& barrier, const Surface& solid, const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    if (barrier.shape) return nodes_of_shape(solid, g);
    const NodeBox near = nodes_around(box_around(solid), g);
    if (near.nx < 1 || near.ny < 1) return {};
    const std::vector<char> raised = nodes_of_outline(plan_of(barrier, cell_for_particles(barrier, scene)), near.of(g));
    std::vector<BarrierNode> nodes;
    for (Index j = 0; j < near.ny; ++j)
        for (Index i = 0; i < near.nx; ++i) {
            if (!raised[static_cast<std::size_t>(j * near.nx + i)]) continue;
            const Index a = near.i0 + i, b = near.j0 + j;
            const double top = solid.prism->top_at({g.x(a), g.y(b)});
            if (std::isfinite(top)) nodes.push_back({a, b, top});
        }
    return nodes;
}

std::vector<BarrierNode> barrier_nodes(const Scene& scene) {
    std::vector<BarrierNode> nodes;
    for (const Barrier& barrier : scene.barriers)
        for (const BarrierNode& node : nodes_of(barrier, surface_around(barrier, scene), scene))
            if (!std::isnan(scene.bed.at(node.i, node.j))) nodes.push_back(node);  // else no ground to stand on
    const auto row_after_row = [](const BarrierNode& a, const BarrierNode& b) {
        return std::tuple(a.j, a.i, -a.top) < std::tuple(b.j, b.i, -b.top);
    };
    const auto same_node = [](const BarrierNode& a, const BarrierNode& b) { return a.i == b.i && a.j == b.j; };
    std::sort(nodes.begin(), nodes.end(), row_after_row);
    nodes.erase(std::unique(nodes.begin(), nodes.end(), same_node), nodes.end());
    return nodes;
}

namespace {

/// Elevation of the node with ground, of those that a barrier stands on, that is nearest to a place; of two the lower
/// one. Not a number without any [m].
double ground_nearest(const Vec2& place, const std::vector<BarrierNode>& nodes, const Raster& bed) {
    double z = std::numeric_limits<double>::quiet_NaN(), least = std::numeric_limits<double>::infinity();
    for (const BarrierNode& node : nodes) {
        const double there = bed.at(node.i, node.j);
        const double far = (Vec2(bed.geometry.x(node.i), bed.geometry.y(node.j)) - place).squaredNorm();
        if (std::isnan(there) || far > least || (far == least && there > z)) continue;
        z = there, least = far;
    }
    return z;
}

}  // namespace

Vec3 middle_of(const Surface& solid, const Barrier* barrier, const Scene& scene) {
    const auto [low, high] = box_around(solid);
    Vec3 middle = 0.5 * (low + high);
    double z = bed_elevation(scene.bed, middle.x(), middle.y());
    if (std::isnan(z) && barrier != nullptr)
        z = ground_nearest(middle.head<2>(), nodes_of(*barrier, solid, scene), scene.bed);
    if (std::isnan(z)) z = bed_below(scene.bed, middle.x(), middle.y());  // a barrier between nodes
    middle.z() = std::isfinite(z) ? z : high.z();
    return middle;
}

Raster ground_around(const Barrier& barrier, const Surface& solid, const Scene& scene) {
    if (!barrier.shape && !barrier.top) return {};
    const NodeBox near =
        common(widened(nodes_around(box_around(solid), scene.bed.geometry), 2), NodeBox::all(scene.bed.geometry));
    if (near.nx < 2 || near.ny < 2) return {};
    Raster ground = part_of(scene.bed, near);
    if (!scene.erodible) return ground;
    const Raster loose = part_of(scene.erodible->depth, near);
    for (std::size_t k = 0; k < ground.values.size(); ++k) ground.values[k] -= loose.values[k];
    return ground;
}

}  // namespace frana
