#include "coupling/growing_particles.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/free_memory.h"
#include "coupling/lake_at_barriers.h"
#include "mpm/stored_points.h"
#include "scene/bed_smoothing.h"
#include "scene/memory_need.h"
#include "scene/remarks.h"
#include "terrain/holes.h"

namespace frana {
namespace {

constexpr Index kShownAround = 8;  ///< nodes that frames show around those that material has come near to
constexpr Index kGrowAtLeast = 256;

/// Values of the part that was held already stay: a release may have been cut out of them.
void lay_over(Raster& bed, const Raster& part, Index i0, Index j0) {
    for (Index j = 0; j < part.geometry.ny; ++j)
        for (Index i = 0; i < part.geometry.nx; ++i) bed.at(i0 + i, j0 + j) = part.at(i, j);
}

}  // namespace

GrowingParticles::GrowingParticles(const Scene& scene, Start start)
    : scene_(scene), wider_(scene.wider), held_(wider_->held) {
    scene_.wider.reset();  // the particles depend on nothing but what they have
    find_barriers();
    particles_ = particles_among_walls(start);
    shown_ = cells_of(wider_->shown, wider_->grid);
    const std::vector<double>& volume = scene_.particles.volume;
    const double largest = volume.empty() ? 0.0 : *std::max_element(volume.begin(), volume.end());
    scene_.particles = {};
    scene_.particles.volume = {largest};  // what may split depends on it, also when a saved part is restored
    if (start == Start::placed) sample();
}

/// Barriers stand on the part that the run begins with. A larger one has the same tops, to the last bit.
void GrowingParticles::find_barriers() {
    barrier_nodes_ = barrier_nodes(scene_);
    for (BarrierNode& node : barrier_nodes_) node.i += held_.i0, node.j += held_.j0;
}

std::unique_ptr<DepthAveraged> GrowingParticles::particles_among_walls(Start start) {
    if (barrier_nodes_.empty()) return std::make_unique<DepthAveraged>(scene_, start);
    Scene walled = scene_;
    footings_ = stand_in(walled, barrier_nodes_, held_.i0, held_.j0);
    footings_.displaced = make_room_in_lake(walled, scene_.bed);
    return std::make_unique<DepthAveraged>(walled, start);
}

/// To be filled with what others have, or with a state.
std::unique_ptr<DepthAveraged> GrowingParticles::resumed_particles() {
    auto particles = particles_among_walls(Start::resumed);
    if (exits_) particles->open_exits(of_part(*exits_), false);
    return particles;
}

void GrowingParticles::open_exits(const NodeBox& nodes, bool leave_now) {
    exits_ = nodes;
    particles_->open_exits(of_part(nodes), leave_now);
}

void GrowingParticles::close_exits() {
    exits_.reset();
    particles_->close_exits();
}

void GrowingParticles::advance(double until) {
    particles_->advance(until);
    sample();
}

void GrowingParticles::add(const Seeds& particles) {
    particles_->add(particles);
    if (!aside_) sample();
}

/// Notes where material is, and grows where it comes near an edge that is none of the terrain.
void GrowingParticles::sample() {
    NodeBox worked = particles_->worked();
    if (worked.nx == 0) return;
    worked.i0 += held_.i0, worked.j0 += held_.j0;
    shown_ = united(shown_, worked);
    const Index clear = clear_of_edge(scene_, scene_.bed.geometry.cell);
    const NodeBox room = room_for(worked, clear);
    if (aside_) {
        expect(room_for(worked, clear - kTile) == held_, "a step aside stays clear of the part's edge");
        return;
    }
    if (!(room == held_)) grow(room);
}

/// The part that material needs. It stays as it is while material is so many nodes clear of the edges. Beyond those
/// that it is not clear of, the part is half as large again.
NodeBox GrowingParticles::room_for(const NodeBox& worked, Index clear) const {
    const NodeBox needed = common(widened(worked, clear), NodeBox::all(wider_->grid));
    const Index more_x = std::max(kGrowAtLeast, held_.nx / 2), more_y = std::max(kGrowAtLeast, held_.ny / 2);
    NodeBox room = held_;
    if (needed.i0 < held_.i0) room.i0 -= more_x, room.nx += more_x;
    if (needed.j0 < held_.j0) room.j0 -= more_y, room.ny += more_y;
    if (needed.i0 + needed.nx > held_.i0 + held_.nx) room.nx += more_x;
    if (needed.j0 + needed.ny > held_.j0 + held_.ny) room.ny += more_y;
    return common(room, NodeBox::all(wider_->grid));
}

/// Elevations of another part of the terrain, that held now among them. Where some are missing it is all of the
/// terrain. Only the whole shows what is outside of it, and what is a hole in it.
void GrowingParticles::hold(NodeBox box) {
    Raster bed = read_part(box);
    const NodeBox all = NodeBox::all(wider_->grid);
    if (has_nodata(bed) && !(box == all)) box = all, bed = read_part(all);
    if (wider_->fields) take_fields(wider_->fields(bed));
    lay_over(bed, scene_.bed, held_.i0 - box.i0, held_.j0 - box.j0);
    scene_.bed = std::move(bed);
    scene_.holes = holes_of(scene_.bed);
    const Index east = held_.i0 - box.i0, north = held_.j0 - box.j0;
    if (scene_.solid)
        for (std::size_t side = 0; side < 4; ++side) scene_.solid->window[side] += side % 2 == 0 ? east : north;
    held_ = box;
}

void GrowingParticles::take_fields(GroundFields fields) {
    scene_.friction = std::move(fields.friction);
    if (scene_.erodible) scene_.erodible->depth = std::move(fields.loose);
    if (scene_.forest) scene_.forest->pressure = std::move(fields.trees);
}

Raster GrowingParticles::read_part(const NodeBox& box) const {
    const double nodes = double(box.nx * box.ny);
    require_memory(memory_of_part(nodes) + memory_of_fields(scene_, nodes), free_memory(),
                   {"terrain.window", fmt::format("the flow has come so far that {} x {} nodes", box.nx, box.ny),
                    "give a window around the flow, or a larger grid.cell"});
    return wider_->read(box);
}

/// A run that cannot grow is refused: what it has so far is written.
void GrowingParticles::grow(const NodeBox& box) {
    const NodeBox before = held_;
    try {
        hold(box);
    } catch (const UserError& error) {
        throw UserError(fmt::format("step {}, t = {:.6g} s: more of the terrain is needed: {}",
                                    particles_->status().step, particles_->status().time, error.what()));
    }
    const Index east = before.i0 - held_.i0, north = before.j0 - held_.j0;
    auto larger = resumed_particles();
    larger->take_over(*particles_, east, north);
    particles_ = std::move(larger);
    ++times_grown_;
}

void GrowingParticles::show_part() { particles_->show(of_part(common(widened(shown_, kShownAround), held_))); }

Frame GrowingParticles::frame() {
    show_part();
    return particles_->frame();
}

Status GrowingParticles::frame_status() {
    show_part();
    return particles_->frame_status();
}

std::vector<std::string> GrowingParticles::remarks() const {
    std::vector<std::string> all = particles_->remarks();
    for (const std::string& remark : remarks_on(footings_)) all.push_back(remark);
    const GridGeometry& g = wider_->grid;
    const auto extent = scene_.bed.geometry.pixel_extent();
    all.push_back(
        fmt::format("terrain: {} x {} of {} x {} nodes were needed, x {:.10g} to {:.10g}, y {:.10g} to {:.10g}; files "
                    "show the part "
                    "that the flow has reached (output.extent)",
                    held_.nx, held_.ny, g.nx, g.ny, extent[0], extent[2], extent[1], extent[3]));
    if (times_grown_ > 0) remark_on_holes(all, scene_.holes, scene_.bed.geometry, !scene_.hole_top, "terrain.dem");
    return all;
}

void GrowingParticles::serialize(Archive& archive) {
    aside_ = archive.aside() && !archive.loading();
    {
        const Archive::Part part(archive, "part");
        NodeBox box = held_;
        archive.number("i0", box.i0), archive.number("j0", box.j0);
        archive.number("nx", box.nx), archive.number("ny", box.ny);
        archive.number("shown_i0", shown_.i0), archive.number("shown_j0", shown_.j0);
        archive.number("shown_nx", shown_.nx), archive.number("shown_ny", shown_.ny);
        archive.number("times_grown", times_grown_);
        if (archive.loading() && !(box == held_)) {
            if (!(common(held_, box) == held_) || !(common(box, NodeBox::all(wider_->grid)) == box))
                throw misfit("its part of the terrain is not one of this terrain");
            hold(box);
            particles_ = resumed_particles();
        }
    }
    particles_->serialize(archive);
}

}  // namespace frana
