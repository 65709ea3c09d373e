#include "coupling/barriers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "particles/bed_points.h"
#include "solid3d/face_ledger.h"

namespace frana {
namespace {

/// Elevations of the nodes, `height` higher.
Raster lifted(Raster bed, double height) {
    for (double& z : bed.values) z += height;
    return bed;
}

/// Of a shape without the room around it.
std::pair<Vec3, Vec3> box_of(const Surface& barrier) {
    if (barrier.prism) return barrier.prism->box();
    const DistanceField& f = *barrier.shape;
    Vec3 low = f.end(), high = f.origin;
    for (Index k = 0; k < f.nodes[2]; ++k)
        for (Index j = 0; j < f.nodes[1]; ++j)
            for (Index i = 0; i < f.nodes[0]; ++i)
                if (f.at(i, j, k) < 0.0) low = low.cwiseMin(f.place(i, j, k)), high = high.cwiseMax(f.place(i, j, k));
    return {low, high};
}

bool near_box(const std::pair<Vec3, Vec3>& box, const Vec2& place, double margin) {
    const auto& [low, high] = box;
    return ((place - low.head<2>()).array() >= -margin).all() && ((high.head<2>() - place).array() >= -margin).all();
}

/// Whether a place is within `distance` of a barrier in plan, below its top: the box of a bent wall holds far more.
bool stands_near(const Surface& barrier, const std::pair<Vec3, Vec3>& box, const Vec3& x, double distance,
                 double cell) {
    if (!near_box(box, x.head<2>(), distance)) return false;
    const double top = barrier.prism ? barrier.prism->top_at(x.head<2>()) : box.second.z();
    const Vec3 foot(x.x(), x.y(), std::min(x.z(), top - cell));
    if (barrier.shape) return barrier.shape->contact(foot).distance <= distance;
    Contact near[kMostContacts];
    return barrier.prism->inside(foot) ||
           (barrier.prism->contacts(foot, cell, near) > 0 && near[0].distance <= distance);
}

/// Whether the way from a place beside a barrier to another one leads over it, however thin it is.
bool crosses(const Surface& barrier, const std::pair<Vec3, Vec3>& box, const Vec2& from, const Vec2& to) {
    const auto& [low, high] = box;
    const double z = barrier.shape ? 0.5 * (low.z() + high.z()) : high.z() - 1e6;  // footprints reach down without end
    Entry entry;
    return enters(barrier, {from.x(), from.y(), z}, {to.x(), to.y(), z}, entry);
}

/// The middle of the footprint, on the bed.
Vec3 middle_of(const Surface& barrier, const Raster& bed) {
    const auto [low, high] = box_of(barrier);
    Vec3 middle = 0.5 * (low + high);
    const double z = bed_elevation(bed, middle.x(), middle.y());
    middle.z() = std::isfinite(z) ? z : high.z();
    return middle;
}

/// Whether a node stands in a barrier, or within half a cell of it.
bool is_in_reach(const Surface& barrier, const Vec2& node, double top, double cell) {
    if (barrier.shape) return true;  // top_near() has looked there
    const Vec3 below(node.x(), node.y(), top - 2.0 * cell);
    Contact contact[kMostContacts];
    return barrier.prism->inside(below) ||
           (barrier.prism->contacts(below, cell, contact) > 0 && contact[0].distance <= 0.5 * cell);
}

/// Cells that make a wall along a line as thick as columns see it: as points will meet it, so that none of them starts
/// inside; where there are none, and no thickness is given, a cell thick (least_wall_thickness() is three of them).
double cell_for_columns(const Barrier& barrier, const Scene& scene) {
    if (scene.solid) return scene.solid->cell;
    return barrier.thickness ? 0.0 : scene.bed.geometry.cell / 3.0;
}

/// Top of a barrier at a node; of a shape the highest within half a cell.
double top_near(const Surface& barrier, const Vec2& node, double cell) {
    if (barrier.prism) return barrier.prism->top_at(node);
    double top = -std::numeric_limits<double>::infinity();
    const int steps = static_cast<int>(std::ceil(0.5 * cell / barrier.shape->spacing));
    for (int j = -steps; j <= steps; ++j)
        for (int i = -steps; i <= steps; ++i)
            top = std::max(top, barrier.shape->top_at(node + 0.5 * cell / steps * Vec2(i, j)));
    return top;
}

}  // namespace

double top_of(const Surface& barrier, const Vec2& place) {
    if (barrier.shape) return barrier.shape->top_at(place);
    const double top = barrier.prism->top_at(place);
    return barrier.prism->inside({place.x(), place.y(), top - 1.0}) ? top : -std::numeric_limits<double>::infinity();
}

void stand_on_barriers(FlowColumns& columns, const std::vector<Surface>& surfaces) {
    for (const Surface& surface : surfaces) {
        if (!surface.is_barrier()) continue;
        for (std::size_t k = 0; k < columns.count(); ++k)
            columns.bed[k] = std::max(columns.bed[k], top_of(surface, {columns.x[k], columns.y[k]}));
    }
}

Prism solid_of(const Barrier& barrier, const Raster& bed, double cell) {
    Polygons outline = barrier.outline;
    if (!barrier.line.empty()) {
        const double least = least_wall_thickness(barrier.line, cell);
        outline = wall_outline(barrier.line, barrier.wet_left ? WetSide::left : WetSide::right,
                               std::max(barrier.thickness.value_or(0.0), least));
    }
    if (barrier.top) return Prism(outline, *barrier.top);
    return Prism(outline, lifted(bed, barrier.height));
}

Surface surface_of(const Barrier& barrier, const Raster& bed, double cell) {
    const Hold hold = barrier.stuck ? Hold::stuck : Hold::free;
    const double friction = barrier.stuck ? 0.0 : barrier.friction;
    Surface surface = barrier.shape ? Surface::barrier(*barrier.shape, hold, friction)
                                    : Surface::barrier(solid_of(barrier, bed, cell), hold, friction);
    surface.name = barrier.name;
    return surface;
}

Raster with_barriers(const Scene& scene) {
    Raster bed = scene.bed;
    const GridGeometry& g = bed.geometry;
    for (const Barrier& barrier : scene.barriers) {
        const Surface solid = surface_of(barrier, scene.bed, cell_for_columns(barrier, scene));
        const auto box = box_of(solid);
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const Vec2 node(g.x(i), g.y(j));
                if (!near_box(box, node, 0.5 * g.cell)) continue;
                const double top = top_near(solid, node, g.cell);
                if (top > bed.at(i, j) && is_in_reach(solid, node, top, g.cell)) bed.at(i, j) = top;
            }
    }
    return bed;
}

ColumnWatch::ColumnWatch(const Scene& scene) : cell_(scene.bed.geometry.cell) {
    for (const Barrier& barrier : scene.barriers) {
        surfaces_.push_back(surface_of(barrier, scene.bed, cell_for_columns(barrier, scene)));
        boxes_.push_back(box_of(surfaces_.back()));
        BarrierLoad load;
        load.about = middle_of(surfaces_.back(), scene.bed);
        load.run_up = load.about.z();
        loads_.barriers.push_back(load);
    }
    seen_.resize(surfaces_.size());
}

void ColumnWatch::inherit(Index child, Index parent) {
    const auto c = static_cast<std::size_t>(child), p = static_cast<std::size_t>(parent);
    make_room(std::max(c, p));
    for (std::vector<std::uint8_t>& seen : seen_) seen[c] = seen[p];
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * c + axis] = last_[2 * p + axis];
}

void ColumnWatch::make_room(std::size_t id) {
    for (std::vector<std::uint8_t>& seen : seen_)
        if (seen.size() <= id) seen.resize(id + 1, kNever);
    if (last_.size() < 2 * (id + 1)) last_.resize(2 * (id + 1), 0.0);
}

void ColumnWatch::sample(const ColumnAt& column) {
    constexpr double kClose = 2.0;  // cells
    const auto id = static_cast<std::size_t>(column.id);
    make_room(id);
    const Vec2 from(last_[2 * id], last_[2 * id + 1]);
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Vec3 top_of_it(column.place.x(), column.place.y(), column.surface);
        const bool near = stands_near(surfaces_[n], boxes_[n], top_of_it, kClose * cell_, cell_);
        std::vector<std::uint8_t>& seen = seen_[n];
        const bool over = near && (std::isfinite(top_of(surfaces_[n], column.place)) ||
                                   (seen[id] == kAdjacent && crosses(surfaces_[n], boxes_[n], from, column.place)));
        BarrierLoad& load = loads_.barriers[n];
        if (near) load.run_up = std::max(load.run_up, column.surface);
        if (over && seen[id] == kAdjacent) load.overtopped += column.volume;
        if (over || seen[id] == kNever) seen[id] = over ? kOver : kAdjacent;
    }
    for (std::size_t axis = 0; axis < 2; ++axis) last_[2 * id + axis] = column.place[static_cast<Eigen::Index>(axis)];
}

void ColumnWatch::serialize(Archive& archive) {
    const Archive::Part part(archive, "barriers");
    for (std::size_t n = 0; n < seen_.size(); ++n) {
        archive.array("seen_" + std::to_string(n), seen_[n]);
        archive.numbers("sums_" + std::to_string(n), {&loads_.barriers[n].run_up, &loads_.barriers[n].overtopped});
    }
    archive.array("last", last_);
}

BarrierWatch::BarrierWatch(const Scene& scene, const Mpm3d& flow, double blur) : density_(scene.density) {
    const std::vector<Surface>& surfaces = flow.body().surfaces;
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].is_barrier()) surfaces_.push_back(static_cast<int>(s));
    loads_.blur = blur;
    for (const int s : surfaces_) {
        const Surface& surface = surfaces[static_cast<std::size_t>(s)];
        boxes_.push_back(box_of(surface));
        BarrierLoad load;
        load.faces.resize(static_cast<std::size_t>(surface.faces()));
        load.about = middle_of(surface, scene.bed);
        load.run_up = load.about.z();
        loads_.barriers.push_back(load);
    }
    over_.resize(surfaces_.size());
}

void BarrierWatch::accumulate_loads(const Mpm3d& flow) {
    const Vec3& origin = flow.body().grid.geometry().origin;
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        for (std::size_t f = 0; f < loads_.barriers[n].faces.size(); ++f) {
            const Face& face = flow.body().ledger.face(surfaces_[n], static_cast<int>(f));
            loads_.barriers[n].faces[f].impulse = -face.impulse;
            loads_.barriers[n].faces[f].moment = -FaceLedger::moment_about(face, loads_.barriers[n].about - origin);
        }
}

void BarrierWatch::sample(const Mpm3d& flow) {
    constexpr double kClose = 2.0;  // cells
    const double cell = flow.body().grid.cell();
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Surface& solid = flow.body().surfaces[static_cast<std::size_t>(surfaces_[n])];
        BarrierLoad& load = loads_.barriers[n];
        for (Index p = 0; p < flow.body().points.count(); ++p) {
            const Vec3 x = flow.position(p);
            if (!stands_near(solid, boxes_[n], x, kClose * cell, cell)) continue;
            load.run_up = std::max(load.run_up, x.z());
            const auto id = static_cast<std::size_t>(flow.body().points.id[p]);
            if (over_[n].size() <= id) over_[n].resize(id + 1, 0);
            if (over_[n][id]) continue;
            const double top = top_of(solid, x.head<2>());
            if (!std::isfinite(top) || x.z() < top - cell) continue;  // beside it, or below what it spans
            over_[n][id] = 1;
            load.overtopped += flow.body().points.mass[p] / density_;
        }
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
    for (std::size_t n = 0; n < over_.size(); ++n) {
        archive.array("over_" + std::to_string(n), over_[n]);
        archive.numbers("sums_" + std::to_string(n), {&loads_.barriers[n].run_up, &loads_.barriers[n].overtopped});
    }
}

}  // namespace frana
