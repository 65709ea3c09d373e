#include "coupling/barriers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/round_number.h"
#include "coupling/solid_scene.h"
#include "scene/barrier_box.h"
#include "shallow/feed.h"
#include "solid3d/face_ledger.h"
#include "terrain/bed_points.h"
#include "terrain/outline_nodes.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {
namespace {

/// Cells: as far from a barrier run-up counts. Particles stop one before it, where its ramp begins.
constexpr double kClose = 2.0;

/// Elevations of the nodes, `height` higher.
Raster lifted(Raster bed, double height) {
    for (double& z : bed.values) z += height;
    return bed;
}

bool near_box(const std::pair<Vec3, Vec3>& box, const Vec2& place, double margin) {
    const auto& [low, high] = box;
    return ((place - low.head<2>()).array() >= -margin).all() && ((high.head<2>() - place).array() >= -margin).all();
}

/// Whether a barrier's top at a place is above the ground there. What is over a buried part has not met the barrier.
bool stands_out(const Surface& barrier, const Raster& ground, const Vec2& place) {
    if (ground.values.empty()) return true;
    const double top = barrier.prism ? barrier.prism->top_at(place) : barrier.shape->top_at(place);
    return !std::isfinite(top) || !(top <= bed_below(ground, place.x(), place.y()));
}

/// Whether a place is within `distance` of a barrier in plan, below its top, where it stands out. The box of a bent
/// wall holds far more.
bool stands_near(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec3& x,
                 double distance, double cell) {
    if (!near_box(box, x.head<2>(), distance)) return false;
    const double top = barrier.prism ? barrier.prism->top_at(x.head<2>()) : box.second.z();
    const Vec3 foot(x.x(), x.y(), std::min(x.z(), top - cell));
    const auto reaches = [&](const Contact& met) {
        const Vec3 there = foot - std::max(0.0, met.distance) * met.normal;
        return met.distance <= distance && stands_out(barrier, ground, there.head<2>());
    };
    if (barrier.shape) return reaches(barrier.shape->contact(foot));
    if (barrier.prism->inside(foot)) return stands_out(barrier, ground, foot.head<2>());
    Contact near[kMostContacts];
    return barrier.prism->contacts(foot, cell, near) > 0 && reaches(near[0]);
}

/// The face that a place is nearest to, if it can meet any in cells of that size.
std::optional<Contact> nearest_face(const Surface& barrier, const Vec3& x, double cell) {
    if (barrier.shape) return barrier.shape->contact(x);
    Contact list[kMostContacts];
    if (barrier.prism->contacts(x, cell, list) == 0) return {};
    return list[0];
}

/// Whether the way from a place outside of a barrier to another one leads over it, however thin it is.
bool crosses(const Surface& barrier, const Raster& ground, const std::pair<Vec3, Vec3>& box, const Vec2& from,
             const Vec2& to) {
    const auto& [low, high] = box;
    const double z = barrier.shape ? 0.5 * (low.z() + high.z()) : high.z() - 1e6;  // footprints reach down without end
    Entry entry;
    return enters(barrier, {from.x(), from.y(), z}, {to.x(), to.y(), z}, entry) &&
           stands_out(barrier, ground, from + entry.share * (to - from));
}

/// Whether a place on a barrier is at its crest. What stands on a mesh's sloping face is not yet over it: half a cell
/// up from there the face still rises. What goes over moves less than a cell between two samples.
bool at_crest(const Surface& barrier, const Vec2& place, double cell) {
    if (!barrier.shape) return true;
    const double here = top_of(barrier, place);
    const auto top = [&](const Vec2& x) {
        const double z = top_of(barrier, x);
        return std::isfinite(z) ? z : here;
    };
    const Vec2 x(0.25 * cell, 0.0), y(0.0, 0.25 * cell),
        rise(top(place + x) - top(place - x), top(place + y) - top(place - y));
    // Of a cell, over half of one: what sampling makes of a level crest. Along an axis a crest may rise by 1 in 5
    // itself, and at a mesh's ends the steepest way is that of its edge.
    constexpr double kLevel = 0.02, kCrest = 0.1;
    const auto rises = [&](const Vec2& way, double by) {
        if (way.norm() <= kLevel * cell) return false;
        const Vec2 half = 0.5 * cell * way.normalized();
        return top(place + 2.0 * half) > top(place + half) + by * cell;
    };
    return !rises(rise, kLevel) && !rises({rise.x(), 0.0}, kCrest) && !rises({0.0, rise.y()}, kCrest);
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

void stand_on_barriers(FlowParticles& particles, const std::vector<Surface>& surfaces) {
    for (const Surface& surface : surfaces) {
        if (!surface.is_barrier()) continue;
        for (std::size_t k = 0; k < particles.count(); ++k)
            particles.bed[k] = std::max(particles.bed[k], top_of(surface, {particles.x[k], particles.y[k]}));
    }
}

namespace {

/// The outline of a barrier that is no mesh.
Polygons plan_of(const Barrier& barrier, double cell) {
    if (barrier.line.empty()) return barrier.outline;
    const double least = least_wall_thickness(barrier.line, cell);
    return wall_outline(barrier.line, barrier.wet_left ? WetSide::left : WetSide::right,
                        std::max(barrier.thickness.value_or(0.0), least));
}

}  // namespace

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

/// Those of one barrier, row after row, whether there is ground or not.
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

/// The middle of the footprint, on the bed. A middle beyond the terrain is as high as the bed under the barrier nearest
/// to it: moments are about its foot wherever that is. `barrier` may be unknown.
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

/// The ground that a barrier may be buried in, at the lowest that erosion may leave it. Nothing for one whose top
/// follows the ground.
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

}  // namespace

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

/// Calls f(i, j) for a node and its eight neighbours: the slopes of those have its top in them.
template <class F>
void for_footing(const BarrierNode& node, const GridGeometry& g, F&& f) {
    const NodeBox footing = common(widened({node.i, node.j, 1, 1}, 1), NodeBox::all(g));
    for (Index j = footing.j0; j < footing.j0 + footing.ny; ++j)
        for (Index i = footing.i0; i < footing.i0 + footing.nx; ++i) f(i, j);
}

/// Of loose ground `depth` there stays what lies above a barrier's top. The rest [m], summed.
double firm_up(Raster& depth, const Raster& bed, const BarrierNode& node) {
    double firm = 0.0;
    for_footing(node, bed.geometry, [&](Index i, Index j) {
        const double z = bed.at(i, j);
        if (std::isnan(z)) return;
        const double left = std::min(depth.at(i, j), std::max(0.0, z - node.top));
        firm += std::exchange(depth.at(i, j), left) - left;
    });
    return firm;
}

/// Of releases that stand in the bed, a barrier holds what is below its top.
void hold_up(std::vector<LateRelease>& late, const Raster& bed, const std::vector<BarrierNode>& nodes) {
    for (LateRelease& release : late) {
        if (release.scar.empty()) continue;
        std::map<std::pair<Index, Index>, double> above;  // [m]
        for (const BarrierNode& node : nodes)
            above[{node.i, node.j}] = std::max(0.0, bed.at(node.i, node.j) - node.top);
        for (ScarNode& node : release.scar) {
            const NodeAt nearest = nearest_node(bed.geometry, node.at);
            const auto left = above.find({nearest.i, nearest.j});
            if (left == above.end()) continue;
            node.depth = std::min(node.depth, left->second);
            left->second -= node.depth;
        }
    }
}

}  // namespace

Footings stand_in(Scene& scene, const std::vector<BarrierNode>& nodes, Index i0, Index j0) {
    const GridGeometry g = scene.bed.geometry;
    const double area = g.cell * g.cell;
    std::vector<BarrierNode> here = nodes;
    for (BarrierNode& node : here) node.i -= i0, node.j -= j0;
    Footings footings;
    if (scene.erodible)
        for (const BarrierNode& node : here) footings.firm += area * firm_up(scene.erodible->depth, scene.bed, node);
    if (scene.cuts_later()) hold_up(scene.late, scene.bed, here);
    for (const BarrierNode& node : here) {
        double& z = scene.bed.at(node.i, node.j);
        if (!(node.top > z)) continue;
        z = node.top;
        if (!scene.forest) continue;
        for_footing(node, g, [&](Index i, Index j) {
            if (std::exchange(scene.forest->pressure.at(i, j), 0.0) > 0.0) footings.cleared += area;
        });
    }
    return footings;
}

std::vector<std::string> remarks_on(const Footings& footings) {
    std::vector<std::string> all;
    if (footings.firm > 0.0)
        all.push_back(fmt::format(
            "erodible: {:.6g} m3 of loose ground under barriers and a cell around them is taken for firm, or it "
            "would be carried away from under them; no scour at their foot is foretold",
            footings.firm));
    if (footings.displaced > 0.0)
        all.push_back(fmt::format(
            "barriers: {:.6g} m3 of the lake are not there, since barriers and the cell around them are ground",
            footings.displaced));
    if (footings.cleared > 0.0)
        all.push_back(
            fmt::format("forest: no trees stand on barriers and a cell around them, on {:.4g} ha that had some",
                        1e-4 * footings.cleared));
    return all;
}

BarrierTiles::BarrierTiles(const GridGeometry& grid, const std::vector<std::pair<Vec3, Vec3>>& boxes, double margin)
    : x0_(grid.x0), y0_(grid.y0) {
    constexpr Index kCells = 4;  // a side: about a house, so that a tile has few barriers
    size_ = static_cast<double>(kCells) * grid.cell;
    across_ = grid.nx / kCells + 1;
    const Index rows = grid.ny / kCells + 1;
    last_i_ = static_cast<double>(across_ - 1), last_j_ = static_cast<double>(rows - 1);
    std::vector<std::pair<std::size_t, Index>> all;  // tile, number
    const auto tile = [&](double at, double last) { return static_cast<Index>(std::clamp(at / size_, 0.0, last)); };
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const auto& [low, high] = boxes[n];
        for (Index j = tile(low.y() - margin - y0_, last_j_); j <= tile(high.y() + margin - y0_, last_j_); ++j)
            for (Index i = tile(low.x() - margin - x0_, last_i_); i <= tile(high.x() + margin - x0_, last_i_); ++i)
                all.emplace_back(static_cast<std::size_t>(j * across_ + i), static_cast<Index>(n));
    }
    std::sort(all.begin(), all.end());
    begin_.assign(static_cast<std::size_t>(across_ * rows) + 1, 0);
    for (const auto& entry : all) ++begin_[entry.first + 1], numbers_.push_back(entry.second);
    for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
}

ParticleWatch::ParticleWatch(const Scene& scene) : grid_(scene.bed.geometry), cell_(grid_.cell) {
    for (const Barrier& barrier : scene.barriers) {
        surfaces_.push_back(surface_around(barrier, scene));
        boxes_.push_back(box_around(surfaces_.back()));
        BarrierLoad load;
        load.about = middle_of(surfaces_.back(), &barrier, scene);
        ground_.push_back(ground_around(barrier, surfaces_.back(), scene));
        loads_.barriers.push_back(load);
        for (const BarrierNode& node : nodes_of(barrier, surfaces_.back(), scene))
            raised_.push_back(node.j * grid_.nx + node.i);
    }
    std::sort(raised_.begin(), raised_.end());
    tiles_ = BarrierTiles(scene.bed.geometry, boxes_, kClose * cell_);
    for (const Seeds* seeds : scene.all_particles())
        for (std::size_t p = 0; p < seeds->x.size(); ++p)
            if (!scene.still_surface && is_on_top({seeds->x[p], seeds->y[p]})) placed_ += seeds->volume[p];
    note_inflows(scene);
}

void ParticleWatch::note_inflows(const Scene& scene) {
    if (scene.inflows.empty()) return;
    const auto all = Feed(scene.inflows).entries(scene.end);
    for (std::size_t n = 0; n < all.size(); ++n) {
        double volume = 0.0;
        for (const Feed::Entry& entry : all[n])
            if (is_on_top(entry.at)) volume += entry.volume;
        if (volume > 0.0) enter_.push_back({scene.inflows[n].name, volume});
    }
}

bool ParticleWatch::is_on_top(const Vec2& place) const {
    const auto [first, end] = tiles_.barriers_at(place);
    return std::any_of(first, end, [&](Index n) { return is_on(static_cast<std::size_t>(n), place); });
}

bool ParticleWatch::is_on(std::size_t n, const Vec2& place) const {
    return std::isfinite(top_of(surfaces_[n], place)) && stands_out(surfaces_[n], ground_[n], place);
}

std::vector<std::string> ParticleWatch::remarks() const {
    std::vector<std::string> all;
    if (placed_ > 0.0)
        all.push_back(fmt::format(
            "barriers: found {:.4g} m3 of releases on top of barriers; expected none, since it falls from there; move "
            "the outlines apart",
            placed_));
    for (const Entering& entering : enter_)
        all.push_back(
            fmt::format("inflow {}: found {:.4g} m3 of it that enter on top of barriers by time.end; expected none, "
                        "since it falls from there; move it off their outlines, or cut them out of its area",
                        entering.inflow, entering.volume));
    return all;
}

void ParticleWatch::inherit(Index child, Index parent) {
    const auto c = static_cast<std::size_t>(child), p = static_cast<std::size_t>(parent);
    if (p >= near_.size() && c >= near_.size()) return;  // neither was near
    make_room(std::max(c, p));
    near_[c] = near_[p];
    if (const auto found = over_.find(parent); found != over_.end())
        over_[child] = found->second;
    else
        over_.erase(child);
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * c + axis] = last_[2 * p + axis];
}

void ParticleWatch::make_room(std::size_t id) {
    if (near_.size() <= id) near_.resize(id + 1, 0);
    if (last_.size() < 2 * (id + 1)) last_.resize(2 * (id + 1), 0.0);
}

void ParticleWatch::sample(const ParticleAt& particle) {
    const auto [first, end] = tiles_.barriers_at(particle.place);
    if (first == end) return;
    const auto id = static_cast<std::size_t>(particle.id);
    make_room(id);
    const Vec2 from(last_[2 * id], last_[2 * id + 1]);
    const bool came = near_[id] > 0 && near_[id] == round_ - 1;
    for (const Index* n = first; n != end; ++n)
        sample_at(static_cast<std::size_t>(*n), particle, came ? &from : nullptr);
    near_[id] = round_;
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * id + axis] = particle.place[static_cast<Eigen::Index>(axis)];
}

void ParticleWatch::sample_at(std::size_t n, const ParticleAt& particle, const Vec2* from) {
    const Vec3 top_of_it(particle.place.x(), particle.place.y(), particle.surface);
    if (!stands_near(surfaces_[n], ground_[n], boxes_[n], top_of_it, kClose * cell_, cell_)) return;
    const auto barrier = static_cast<Index>(n);
    const auto found = over_.find(particle.id);
    const bool was_over =
        found != over_.end() && std::find(found->second.begin(), found->second.end(), barrier) != found->second.end();
    const bool came_to_it = from != nullptr && !was_over;
    const bool on_it = is_on(n, particle.place),
               over = (on_it && at_crest(surfaces_[n], particle.place, cell_)) ||
                      (came_to_it && crosses(surfaces_[n], ground_[n], boxes_[n], *from, particle.place));
    BarrierLoad& load = loads_.barriers[n];
    // On the roof of a neighbour it does not run up this one.
    if (on_it || !particle.on_barrier) load.reach(particle.surface);
    if (over && came_to_it) load.overtopped += particle.volume;
    if (over && !was_over) over_[particle.id].push_back(barrier);
}

bool ParticleWatch::is_raised(const Vec2& node) const {
    const Index i = std::lround((node.x() - grid_.x0) / grid_.cell),
                j = std::lround((node.y() - grid_.y0) / grid_.cell);
    if (i < 0 || j < 0 || i >= grid_.nx || j >= grid_.ny) return false;
    return std::binary_search(raised_.begin(), raised_.end(), j * grid_.nx + i);
}

double ParticleWatch::adjacent_surface(const DepthAveraged& particles, const Vec2& place) const {
    const Flow& flow = particles.flow();
    const GridGeometry& g = flow.grid.geometry();
    const auto first = [&](double at, double start, Index count) {
        return std::clamp<Index>(static_cast<Index>(std::floor((at - start) / g.cell)), 0, count - 2);
    };
    const Index i = first(place.x(), g.x0, g.nx), j = first(place.y(), g.y0, g.ny);
    double sum = 0.0, weights = 0.0;
    for (const Index b : {j, j + 1})
        for (const Index a : {i, i + 1}) {
            const double w =
                (1.0 - std::abs((place.x() - g.x(a)) / g.cell)) * (1.0 - std::abs((place.y() - g.y(b)) / g.cell));
            const Index k = flow.grid.at(a, b);
            if (!(w > 0.0) || !flow.is_in_reach(a, b) || !(flow.nodes.depth[k] > 0.0) || is_raised({g.x(a), g.y(b)}))
                continue;
            sum += w * (flow.bed.ground[k] + flow.nodes.depth[k]), weights += w;
        }
    return weights > 0.0 ? sum / weights : std::numeric_limits<double>::quiet_NaN();
}

bool ParticleWatch::is_due(DepthAveraged& particles, double before, double until) {
    for (const DepthAveraged::Birth& birth : particles.take_births()) inherit(birth.child, birth.parent);
    const Status& now = particles.status();
    moved_ += now.max_speed_on_map * (now.time - before);  // where something enters, dt begins anew
    if (moved_ < 0.5 * cell_ && now.time < until) return false;
    moved_ = 0.0;
    return true;
}

void ParticleWatch::sample_particles(const DepthAveraged& particles, double density) {
    const Flow& flow = particles.flow();
    const GridGeometry& g = flow.grid.geometry();
    const Particles& c = flow.particles;
    begin_round();
    for (Index p = 0; p < c.count(); ++p) {
        const Vec2 place(g.x0 + g.cell * c.x[p], g.y0 + g.cell * c.y[p]);
        if (!is_near(place)) continue;
        double surface = adjacent_surface(particles, place);
        const bool on_barrier = std::isnan(surface);
        if (on_barrier) {
            const Sample there = particles.at(place);
            surface = there.elevation + there.depth;
        }
        sample({c.id[p], place, surface, c.mass[p] / density, on_barrier});
    }
}

void ParticleWatch::serialize(Archive& archive) {
    const Archive::Part part(archive, "barriers");
    archive.numbers("moved", {&moved_});
    std::vector<double> sums;
    for (const BarrierLoad& load : loads_.barriers) sums.insert(sums.end(), {load.run_up, load.overtopped});
    std::vector<Index> over;  // number of the particle, of the barrier
    for (const auto& entry : over_)
        for (const Index barrier : entry.second) over.insert(over.end(), {entry.first, barrier});
    archive.number("round", round_);
    archive.array("near", near_);
    archive.array("over", over);
    archive.array("sums", sums);
    archive.array("last", last_);
    if (!archive.loading()) return;
    expect(sums.size() == 2 * loads_.barriers.size(), "a state has the barriers of its scene");
    for (std::size_t n = 0; n < loads_.barriers.size(); ++n)
        loads_.barriers[n].run_up = sums[2 * n], loads_.barriers[n].overtopped = sums[2 * n + 1];
    over_.clear();
    for (std::size_t k = 0; k + 1 < over.size(); k += 2) over_[over[k]].push_back(over[k + 1]);
}

namespace {

/// The share of a barrier's foot on the terrain that lies in the window of points [1].
double share_in_window(const Barrier& barrier, const std::pair<Vec3, Vec3>& box, const Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    const BarrierBox plan{box.first.head<2>(), box.second.head<2>()};
    const double terrain = share_of_foot(barrier, plan, {g.x0, g.y0, g.x_max(), g.y_max()});
    return terrain > 0.0 ? share_of_foot(barrier, plan, window_of(scene)) / terrain : 0.0;
}

}  // namespace

BarrierWatch::BarrierWatch(const Scene& scene, const Mpm3d& flow, double blur)
    : density_(scene.density), ramp_(scene.bed.geometry.cell), cell_(flow.body().grid.cell()) {
    const std::vector<Surface>& surfaces = flow.body().surfaces;
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].is_barrier()) surfaces_.push_back(static_cast<int>(s));
    loads_.blur = blur;
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Surface& surface = surfaces[static_cast<std::size_t>(surfaces_[n])];
        boxes_.push_back(box_around(surface));
        names_.push_back(surface.name);
        inside_.push_back(scene.solid ? share_in_window(scene.barriers[n], boxes_.back(), scene) : 1.0);
        BarrierLoad load;
        if (inside_.back() > 0.0) load.faces.resize(static_cast<std::size_t>(surface.faces()));
        const Barrier* const barrier = n < scene.barriers.size() ? &scene.barriers[n] : nullptr;
        load.about = middle_of(surface, barrier, scene);
        ground_.push_back(barrier ? ground_around(*barrier, surface, scene) : Raster());
        loads_.barriers.push_back(load);
    }
    places_.resize(surfaces_.size());
    at_start_.assign(surfaces_.size(), 0.0);
    due_.assign(surfaces_.size(), std::numeric_limits<double>::max());
    over_crest_.assign(surfaces_.size(), 0.0);
}

/// Particles come no nearer than a cell of the terrain, where a barrier's ramp begins.
void BarrierWatch::note_start(const Mpm3d& flow) {
    const MaterialPoints& points = flow.body().points;
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Surface& solid = flow.body().surfaces[static_cast<std::size_t>(surfaces_[n])];
        for (Index p = 0; p < points.count(); ++p) {
            const Vec3 x = flow.position(p);
            if (!near_box(boxes_[n], x.head<2>(), 2.0 * ramp_)) continue;
            const std::optional<Contact> met = nearest_face(solid, x, 2.0 * ramp_);
            const double volume = points.mass[p] / density_, half = 0.5 * std::cbrt(volume);
            if (std::isfinite(top_above(n, solid, x.head<2>())) || (met && met->distance <= ramp_ + half))
                at_start_[n] += volume;
            if (met && met->distance <= 2.0 * half) due_[n] = flow.status().time;  // as near as rows of points lie
        }
    }
    sample(flow);
}

std::vector<std::string> BarrierWatch::remarks(double from) const {
    std::vector<std::string> all;
    std::string late;
    for (std::size_t n = 0; n < names_.size(); ++n) {
        if (from > 0.0 && at_start_[n] > 0.0)
            late += fmt::format("{}{} ({:.3g} m3)", late.empty() ? "" : ", ", names_[n], at_start_[n]);
        if (inside_[n] > 0.0 && inside_[n] < 0.99)
            all.push_back(
                fmt::format("{}: {:.0f} % of it stand in stage.window; forces are those on that part; expected all of "
                            "it, if the force on the whole is asked for",
                            names_[n], 100.0 * inside_[n]));
    }
    if (!late.empty())
        all.push_back(fmt::format(
            "barriers: material is at {} as points begin, at {:.6g} s; first contact and the first forces are of that "
            "moment; expected a stage that begins before the flow is there",
            late, from));
    remark_thin_over(all);
    if (placed_ > 0.0)
        all.push_back(
            fmt::format("barriers: {:.4g} m3 came to be points on top of barriers; they fall from there, and do not "
                        "count as gone over",
                        placed_));
    return all;
}

/// A layer of few cells is braked at a crest: its lowest nodes take part in what stands before the face. Of what should
/// go over a wall of 1 m under 2 m of water about a thirteenth did on cells of 0.5 m, and four tenths on 0.25 m.
void BarrierWatch::remark_thin_over(std::vector<std::string>& remarks) const {
    constexpr double kEnoughCells = 4.0;
    for (std::size_t n = 0; n < names_.size(); ++n) {
        const double depth = over_crest_[n];
        if (!(depth > 0.0) || !(loads_.barriers[n].overtopped > 0.0) || depth >= kEnoughCells * cell_) continue;
        remarks.push_back(fmt::format(
            "{}: {:.4g} m3 went over it, up to {:.3g} m deep on its crest, {:.2g} cells; expected {:.0f} or "
            "more, or far too little goes over; stage.cell = {:g} would do, and smaller ones let more over",
            names_[n], loads_.barriers[n].overtopped, depth, depth / cell_, kEnoughCells,
            round_number_below(depth / kEnoughCells)));
    }
}

void BarrierWatch::accumulate_loads(const Mpm3d& flow) {
    const Vec3& origin = flow.body().grid.geometry().origin;
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        for (std::size_t f = 0; f < loads_.barriers[n].faces.size(); ++f) {
            const Face& face = flow.body().ledger.face(surfaces_[n], static_cast<int>(f));
            loads_.barriers[n].faces[f].impulse = -face.impulse;
            loads_.barriers[n].faces[f].moment = -FaceLedger::moment_about(face, loads_.barriers[n].about - origin);
        }
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        if (!loads_.barriers[n].touched) loads_.barriers[n].touched = is_touched(n, flow);
}

/// Nodes exert force on what is still a cell away, and so slow down what comes fast. So a point touches at the time of
/// its undisturbed arrival, when it is no farther than half a cell. At the latest it touches when half of its width is
/// left. What stands at the barrier as points begin touches as soon as it presses.
bool BarrierWatch::is_touched(std::size_t n, const Mpm3d& flow) {
    const auto has_impulse = [](const FaceLoad& face) { return !face.impulse.isZero(0.0); };
    const std::vector<FaceLoad>& faces = loads_.barriers[n].faces;
    if (std::none_of(faces.begin(), faces.end(), has_impulse)) return false;
    const Surface& solid = flow.body().surfaces[static_cast<std::size_t>(surfaces_[n])];
    const MaterialPoints& points = flow.body().points;
    const double cell = flow.body().grid.cell(), now = flow.status().time;
    double nearest = std::numeric_limits<double>::infinity();  // of what is left between a point's edge and the barrier
    for (Index p = 0; p < points.count(); ++p) {
        const Vec3 x = flow.position(p);
        if (!near_box(boxes_[n], x.head<2>(), 2.0 * cell)) continue;
        const std::optional<Contact> met = nearest_face(solid, x, cell);
        if (!met) continue;
        const auto at = static_cast<std::size_t>(p);
        const double left = met->distance - 0.5 * std::cbrt(points.rest_volume[at] * points.j[at]),
                     speed = -flow.velocity(p).dot(met->normal);
        if (left > 2.0 * cell) continue;
        nearest = std::min(nearest, left);
        if (speed > 0.0) due_[n] = std::min(due_[n], now + std::max(left, 0.0) / speed);
    }
    return nearest <= 0.0 || (now >= due_[n] && nearest <= 0.5 * cell);
}

double BarrierWatch::top_above(std::size_t n, const Surface& solid, const Vec2& place) const {
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    return stands_out(solid, ground_[n], place) ? top_of(solid, place) : kNone;
}

void BarrierWatch::sample(const Mpm3d& flow) {
    const MaterialPoints& points = flow.body().points;
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Surface& solid = flow.body().surfaces[static_cast<std::size_t>(surfaces_[n])];
        BarrierLoad& load = loads_.barriers[n];
        reached_.begin(), on_top_.begin();
        for (Index p = 0; p < points.count(); ++p) {
            const Vec3 x = flow.position(p);
            if (!stands_near(solid, ground_[n], boxes_[n], x, kClose * cell_, cell_)) continue;
            const double mass = points.mass[static_cast<std::size_t>(p)], volume = mass / density_,
                         surface = x.z() + 0.5 * std::cbrt(volume);
            reached_.add(surface, mass);
            std::uint8_t& place = place_of(n, points.id[p]);
            const double top = top_above(n, solid, x.head<2>());
            const bool in_span = std::isfinite(top) && x.z() >= top - cell_;
            if (place != over && !(in_span && at_crest(solid, x.head<2>(), cell_))) {
                place = below;  // outside of it, below what it spans, or before its crest
                continue;
            }
            if (in_span) on_top_.add(surface - top, mass);
            if (place == over) continue;
            (place == below ? load.overtopped : placed_) += volume;
            place = over;
        }
        load.reach(reached_.level());
        over_crest_[n] = std::max(over_crest_[n], on_top_.level());
    }
}

std::uint8_t& BarrierWatch::place_of(std::size_t n, Index id) {
    const auto at = static_cast<std::size_t>(id);
    if (places_[n].size() <= at) places_[n].resize(at + 1, unknown);
    return places_[n][at];
}

void BarrierWatch::inherit(Index child, Index parent) {
    for (std::size_t n = 0; n < places_.size(); ++n)
        if (static_cast<std::size_t>(parent) < places_[n].size()) {
            const std::uint8_t place = place_of(n, parent);
            place_of(n, child) = place;
        }
}

void BarrierWatch::add(const BarrierLoads& before, const BarrierLoads& after) {
    for (std::size_t n = 0; n < loads_.barriers.size(); ++n) {
        BarrierLoad& load = loads_.barriers[n];
        load.reach(after.barriers[n].run_up);
        load.overtopped += after.barriers[n].overtopped - before.barriers[n].overtopped;
    }
}

std::vector<PatchedFace> BarrierWatch::patched(const Mpm3d& flow) const {
    std::vector<PatchedFace> faces;
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        for (std::size_t f = 0; f < loads_.barriers[n].faces.size(); ++f) {
            const Patches& patches = flow.body().ledger.face(surfaces_[n], static_cast<int>(f)).patches;
            PatchedFace& face = faces.emplace_back();
            face.barrier = static_cast<Index>(n), face.face = static_cast<Index>(f);
            face.size = patches.size, face.count = patches.count, face.area = patches.area;
            face.off_top = patches.off_top;
            for (int k = 0; k < 3; ++k) {
                const auto c = static_cast<std::size_t>(k);
                face.corner[c] = patches.origin[k], face.right[c] = patches.right[k], face.up[c] = patches.up[k];
            }
            for (const Vec3& impulse : patches.impulse) face.impulse.push_back({-impulse[0], -impulse[1], -impulse[2]});
        }
    return faces;
}

void BarrierWatch::serialize(Archive& archive) {
    const Archive::Part part(archive, "barriers");
    archive.numbers("placed", {&placed_});
    archive.array("at_start", at_start_);
    archive.array("over_crest", over_crest_);
    for (std::size_t n = 0; n < places_.size(); ++n) {
        archive.array("places_" + std::to_string(n), places_[n]);
        archive.numbers("sums_" + std::to_string(n), {&loads_.barriers[n].run_up, &loads_.barriers[n].overtopped});
        Index touched = loads_.barriers[n].touched ? 1 : 0;
        archive.number("touched_" + std::to_string(n), touched);
        loads_.barriers[n].touched = touched != 0;
        archive.numbers("due_" + std::to_string(n), {&due_[n]});
    }
}

}  // namespace frana
