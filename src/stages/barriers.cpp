#include "stages/barriers.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "particles/bed_points.h"
#include "solid/face_ledger.h"

namespace frana {
namespace {

/// Elevations of the nodes, `height` higher.
Raster lifted(Raster bed, double height) {
    for (double& z : bed.values) z += height;
    return bed;
}

/// The middle of the footprint, on the bed.
Vec3 middle_of(const Prism& solid, const Raster& bed) {
    const auto [low, high] = solid.box();
    Vec3 middle = 0.5 * (low + high);
    const double z = bed_elevation(bed, middle.x(), middle.y());
    middle.z() = std::isfinite(z) ? z : high.z();
    return middle;
}

}  // namespace

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

Raster with_barriers(const Scene& scene) {
    Raster bed = scene.bed;
    const GridGeometry& g = bed.geometry;
    for (const Barrier& barrier : scene.barriers) {
        // The solid that points will meet, so that none of them starts inside it; where there are none, a wall along a line
        // that has no thickness of its own is a cell thick (least_wall_thickness() is three of the cells it is given).
        const double alone = barrier.thickness ? 0.0 : g.cell / 3.0;
        const Prism solid = solid_of(barrier, scene.bed, scene.solid ? scene.solid->cell : alone);
        const auto [low, high] = solid.box();
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const double x = g.x(i), y = g.y(j), near = 0.5 * g.cell;
                if (x < low.x() - near || x > high.x() + near || y < low.y() - near || y > high.y() + near)
                    continue;
                const double top = solid.top_at({x, y});
                if (!(top > bed.at(i, j))) continue;
                Contact contact[kMostContacts];
                const Vec3 below(x, y, top - 2.0 * g.cell);
                if (solid.inside(below) ||
                    (solid.contacts(below, g.cell, contact) > 0 && contact[0].distance <= near))
                    bed.at(i, j) = top;
            }
    }
    return bed;
}

BarrierWatch::BarrierWatch(const Scene& scene, const SolidFlow& flow, double blur) : density_(scene.density) {
    const std::vector<Surface>& surfaces = flow.body().surfaces;
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].is_barrier()) surfaces_.push_back(static_cast<int>(s));
    loads_.blur = blur;
    for (const int s : surfaces_) {
        const Surface& surface = surfaces[static_cast<std::size_t>(s)];
        BarrierLoad load;
        load.faces.resize(static_cast<std::size_t>(surface.faces()));
        load.about = middle_of(*surface.prism, scene.bed);
        load.run_up = load.about.z();
        loads_.barriers.push_back(load);
    }
    over_.resize(surfaces_.size());
}

void BarrierWatch::weigh(const SolidFlow& flow) {
    const Vec3& origin = flow.body().grid.geometry().origin;
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        for (std::size_t f = 0; f < loads_.barriers[n].faces.size(); ++f) {
            const Face& face = flow.body().ledger.face(surfaces_[n], static_cast<int>(f));
            loads_.barriers[n].faces[f].impulse = -face.impulse;
            loads_.barriers[n].faces[f].moment =
                -FaceLedger::moment_about(face, loads_.barriers[n].about - origin);
        }
}

void BarrierWatch::look(const SolidFlow& flow) {
    constexpr double kClose = 2.0;  // cells
    const double cell = flow.body().grid.cell();
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Prism& solid = *flow.body().surfaces[static_cast<std::size_t>(surfaces_[n])].prism;
        BarrierLoad& load = loads_.barriers[n];
        const auto [low, high] = solid.box();
        const Vec3 margin = Vec3::Constant(kClose * cell);
        for (Index p = 0; p < flow.body().points.count(); ++p) {
            const Vec3 x = flow.position(p);
            if (((x - low + margin).head<2>().array() < 0.0).any() ||
                ((high + margin - x).head<2>().array() < 0.0).any())
                continue;
            // The place in plan, below the top: the box of a bent wall holds far more than what is near it.
            const double below = solid.top_at(x.head<2>()) - cell;
            const Vec3 foot(x.x(), x.y(), std::min(x.z(), below));
            Contact near[kMostContacts];
            if (!solid.inside(foot) &&
                !(solid.contacts(foot, cell, near) > 0 && near[0].distance <= kClose * cell))
                continue;
            load.run_up = std::max(load.run_up, x.z());
            const auto id = static_cast<std::size_t>(flow.body().points.id[p]);
            if (over_[n].size() <= id) over_[n].resize(id + 1, 0);
            // Above the top: what a place under it would be inside of.
            if (over_[n][id] || !solid.inside({x.x(), x.y(), below})) continue;
            over_[n][id] = 1;
            load.overtopped += flow.body().points.mass[p] / density_;
        }
    }
}

std::vector<PatchedFace> BarrierWatch::patched(const SolidFlow& flow) const {
    std::vector<PatchedFace> faces;
    for (std::size_t n = 0; n < surfaces_.size(); ++n)
        for (std::size_t f = 0; f < loads_.barriers[n].faces.size(); ++f) {
            const Patches& patches = flow.body().ledger.face(surfaces_[n], static_cast<int>(f)).patches;
            PatchedFace& face = faces.emplace_back();
            face.barrier = static_cast<Index>(n), face.face = static_cast<Index>(f);
            face.size = patches.size, face.count = patches.count;
            for (int k = 0; k < 3; ++k) {
                const auto c = static_cast<std::size_t>(k);
                face.corner[c] = patches.origin[k], face.right[c] = patches.right[k],
                face.up[c] = patches.up[k];
            }
            for (const Vec3& impulse : patches.impulse)
                face.impulse.push_back({-impulse[0], -impulse[1], -impulse[2]});
        }
    return faces;
}

void BarrierWatch::keep(Archive& archive) {
    const Archive::Part part(archive, "barriers");
    for (std::size_t n = 0; n < over_.size(); ++n) {
        archive.array("over_" + std::to_string(n), over_[n]);
        archive.numbers("sums_" + std::to_string(n),
                        {&loads_.barriers[n].run_up, &loads_.barriers[n].overtopped});
    }
}

}  // namespace frana
