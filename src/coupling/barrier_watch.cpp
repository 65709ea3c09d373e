#include "coupling/barrier_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/round_number.h"
#include "coupling/at_barrier.h"
#include "coupling/barriers.h"
#include "coupling/solid_scene.h"
#include "scene/barrier_box.h"
#include "solid3d/face_ledger.h"

namespace frana {
namespace {

/// Whether some of a barrier's foot lies in the window of points.
bool is_in_window(const Barrier& barrier, const std::pair<Vec3, Vec3>& box, const Scene& scene) {
    return share_of_foot(barrier, {box.first.head<2>(), box.second.head<2>()}, window_of(scene)) > 0.0;
}

}  // namespace

BarrierWatch::BarrierWatch(const Scene& scene, const Mpm3d& flow, double blur)
    : density_(scene.density), ramp_(scene.bed.geometry.cell), cell_(flow.body().grid.cell()), on_top_(cell_) {
    const std::vector<Surface>& surfaces = flow.body().surfaces;
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].is_barrier()) surfaces_.push_back(static_cast<int>(s));
    loads_.blur = blur;
    for (std::size_t n = 0; n < surfaces_.size(); ++n) {
        const Surface& surface = surfaces[static_cast<std::size_t>(surfaces_[n])];
        boxes_.push_back(box_around(surface));
        names_.push_back(surface.name);
        BarrierLoad load;
        if (!scene.solid || is_in_window(scene.barriers[n], boxes_.back(), scene))
            load.faces.resize(static_cast<std::size_t>(surface.faces()));
        const Barrier* const barrier = n < scene.barriers.size() ? &scene.barriers[n] : nullptr;
        load.about = middle_of(surface, barrier, scene);
        ground_.push_back(barrier ? ground_around(*barrier, surface, scene) : Raster());
        loads_.barriers.push_back(load);
    }
    places_.resize(surfaces_.size());
    at_start_.assign(surfaces_.size(), 0.0);
    due_.assign(surfaces_.size(), std::numeric_limits<double>::max());
    over_crest_.assign(surfaces_.size(), 0.0);
    points_over_.assign(surfaces_.size(), 0.0);
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
/// go over a wall of 1 m under 2 m of water about a thirteenth did on cells of 0.5 m, and four tenths on 0.25 m. That
/// holds for points. What went over as particles, before, after or beside them, does not depend on their cells.
void BarrierWatch::remark_thin_over(std::vector<std::string>& remarks) const {
    constexpr double kEnoughCells = 4.0;
    for (std::size_t n = 0; n < names_.size(); ++n) {
        const double depth = over_crest_[n];
        if (!(depth > 0.0) || !(points_over_[n] > 0.0) || depth >= kEnoughCells * cell_) continue;
        const double rest = loads_.barriers[n].overtopped - points_over_[n];
        const std::string besides = rest > 0.0 ? fmt::format(", besides {:.4g} m3 of particles", rest) : "";
        remarks.push_back(fmt::format(
            "{}: {:.4g} m3 of 3D points went over it{}, up to {:.3g} m deep on its crest, {:.2g} cells; expected "
            "{:.0f} or more, or far too little of them goes over; stage.cell = {:g} would do, and smaller ones let "
            "more over",
            names_[n], points_over_[n], besides, depth, depth / cell_, kEnoughCells,
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
            if (in_span && x.z() > top) on_top_.add(x.head<2>(), volume);
            if (place == over) continue;
            if (place == below)
                load.overtopped += volume, points_over_[n] += volume;
            else
                placed_ += volume;
            place = over;
        }
        load.reach(reached_.level());
        over_crest_[n] = std::max(over_crest_[n], on_top_.largest());
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
            face.off_face = patches.off_face;
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
    archive.array("points_over", points_over_);
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
