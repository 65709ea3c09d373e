#include "coupling/staged_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/error.h"
#include "base/free_memory.h"
#include "base/round_number.h"
#include "coupling/bed_friction.h"
#include "coupling/start_pressure.h"
#include "scene/stage_reach.h"
#include "terrain/part_of.h"
#include "terrain/places.h"

namespace frana {

StagedRun::StagedRun(const Scene& scene, Start start)
    : scene_(scene), terrain_(std::make_unique<TerrainParticles>(scene, start)), map_(scene), spray_(scene) {
    expect(scene.solid.has_value(), "a staged run has a 3D stage");
    if (!scene.barriers.empty()) {
        mark_raised();
        depth_averaged().note_parents();
        particles_watch_.emplace(scene_);
    }
    scene_.particles = {};
    status_ = depth_averaged().status();
    if (start == Start::placed && scene.solid->from == 0.0)
        begin_3d([&](const Scene& now, const Marks& marks) { return particles_of(scene.particles, now, marks); });
}

/// A step aside must not begin or end the stage: a rounding error less than what is left.
double StagedRun::longest_step() const {
    const auto just_before = [&](double time) { return std::nextafter(time - status_.time, 0.0); };
    if (!points_) return std::min(depth_averaged().longest_step(), just_before(scene_.solid->from));
    if (ended_) return depth_averaged().longest_step();
    if (!points_alone()) return 0.0;
    const double longest = points_->longest_step();
    return scene_.solid->until ? std::min(longest, just_before(*scene_.solid->until)) : longest;
}

/// One step of the model in charge: particles until their stage ends; then points; then, perhaps, particles.
void StagedRun::advance(double until) {
    if (!points_) {
        const double before = status_.time;
        try {
            terrain_->advance(std::min(until, scene_.solid->from));
        } catch (const UserError&) {  // its step was done
            status_ = depth_averaged().status();
            throw;
        }
        watch_particles(before, until);
        status_ = depth_averaged().status();
        if (status_.time < scene_.solid->from) return;
        const std::vector<Mat2> domains =
            domains_of(depth_averaged().flow().particles, scene_.bed.geometry.cell, scene_.scheme);
        begin_3d([&](const Scene& now, const Marks& marks) {
            return particles_of(terrain_->frame(), domains, now.bed, marks);
        });
        return;
    }
    const auto count = [&] {
        status_.step += 1;
        accumulate(depth_averaged().status());
    };
    const double end = scene_.solid->until.value_or(until);
    try {
        if (ended_)
            step_particles_alone(until);
        else
            step_points(std::min(until, end));
        if (!ended_ && scene_.solid->until && points_->status().time >= end) end_3d();
    } catch (const UserError&) {  // all but what is refused was done, and the last frame shows it
        count();
        throw;
    }
    count();
}

void StagedRun::step_particles_alone(double until) {
    const double before = depth_averaged().status().time;
    terrain_->advance(until);
    watch_particles(before, until);
}

/// After a step of particles: what they do to barriers adds to what points do.
void StagedRun::watch_particles(double before, double until) {
    if (particles_watch_ && particles_watch_->is_due(depth_averaged(), before, until))
        timed_("map", [&] { sample_particles(); });
}

void StagedRun::sample_particles() {
    const BarrierLoads before = particles_watch_->loads();
    particles_watch_->sample_particles(depth_averaged(), scene_.density);
    if (watch_) watch_->add(before, particles_watch_->loads());
}

bool StagedRun::points_alone() const { return depth_averaged().status().particles == 0 && pending_.empty(); }

/// The end of the points' next step towards a time that they have to meet. Their steps there are equally long. A force
/// on a barrier that is a few steps old would jump where the last one is much shorter.
double StagedRun::next_on_the_way_to(double time) const {
    constexpr double kShorter = 1.0 + 1e-9;  // than the longest step, or round-off would make two of one
    const double left = time - points_->status().time, steps = std::ceil(kShorter * left / points_->longest_step());
    return steps > 1.0 ? points_->status().time + left / steps : time;
}

/// Particles that are left go a step ahead of the points. So what flows into the window is there when the points arrive
/// at that time.
void StagedRun::step_points(double until) {
    if (depth_averaged().status().time <= points_->status().time) step_particles(until);
    const bool alone = points_alone();
    points_->advance(alone ? until : std::min(until, next_on_the_way_to(depth_averaged().status().time)));
    note_departed();
    if (alone || points_->status().time == depth_averaged().status().time) {
        convert_to_3d();
        if (!returning_.empty())
            timed_("3D to 2D", [&] {
                convert_to_2d([&](const DepartedPoint& point, const Vec2& to) { return place_of_particle(point, to); });
            });
    }
    for (const Mpm3d::Birth& birth : points_->take_births())
        if (watch_) watch_->inherit(birth.child, birth.parent);
    if (watch_) watch_->accumulate_loads(*points_);
    moved_ += points_->status().max_speed * points_->status().dt;
    sample(until);
}

/// Particles in the window become points, those outside stay; none of them is in both.
void StagedRun::begin_3d(const std::function<FlowParticles(const Scene&, const Marks&)>& particles_at) {
    const Status before = depth_averaged().status();
    timed_("2D to 3D", [&] {
        const Scene& now = scene_now();
        const Marks inside = nodes_in_window(now), everywhere(inside.size(), 1);
        start_ = choose_start(now, particles_at(now, everywhere));  // what is outside still comes
        SolidScene space = space_of_stage();
        FlowParticles particles = particles_at(now, inside);
        take_start_pressure(particles, scene_);
        space.points = seeds_of_window(particles, space.surfaces);
        points_ = std::make_unique<Mpm3d>(space);
        points_->start_at(scene_.solid->from);
        points_->note_departed();
        if (particles_watch_) begin_watch();
        at_edge_ = nodes_at_edge(scene_);
        note_largest();
        terrain_->open_exits(window_nodes(*scene_.solid), true);
        terrain_->show_always(map_.nodes());
    });
    const Status& now = depth_averaged().status();  // what they gave counts as left
    converted_.mass = now.mass_left - before.mass_left;
    converted_.energy = now.energy_left - before.energy_left;
    // Points from the start on are what sums begin with: the release never stood on the ramp of a barrier as particles.
    converted_.lost = scene_.solid->from > 0.0 ? converted_.energy - points_->status().energy_given : 0.0;
    for (std::size_t axis = 0; axis < 2; ++axis)
        converted_.momentum[axis] = now.momentum_left[axis] - before.momentum_left[axis];
    sample(points_->status().time);
    accumulate(depth_averaged().status());
}

void StagedRun::begin_watch() {
    watch_.emplace(scene_, *points_, start_.blur);
    watch_->note_start(*points_);
    BarrierLoads none;
    none.barriers.resize(scene_.barriers.size());
    watch_->add(none, particles_watch_->loads());
}

/// The ground comes first; it brakes by the bed law, where that depends on speed.
SolidScene StagedRun::space_of_stage() const {
    SolidScene space = solid_scene(scene_, start_);
    if (scene_.solid->whole_bed_law && !start_.stuck)
        space.surfaces.front().law = std::make_shared<BedFriction>(scene_, map_);
    return space;
}

/// Refuses what does not fit into memory before it is allocated.
void StagedRun::require_room(const FlowParticles& particles) const {
    // Of a point: its numbers, room to sort, and both forms while it is converted. At the end it is converted back as well.
    const double per_point = scene_.solid->until ? 600.0 : 450.0, per_particle = 160.0;
    const PartsForecast parts = forecast_parts(particles, scene_.solid->spacing, scene_.bed.geometry.cell);
    const double bytes = parts.particles * per_particle + parts.points * per_point, free = free_memory();
    if (bytes <= free) return;
    throw UserError(
        fmt::format("stage.spacing = {:.6g}: makes {:.3g} points, about {:.3g} GB; expected what fits into "
                    "the {:.3g} GB that are free; "
                    "give a larger spacing or a smaller window",
                    scene_.solid->spacing, parts.points, bytes / 1e9, free / 1e9));
}

/// Refuses what does not fit below the top of the space.
void StagedRun::require_below_top(const FlowParticles& particles) const {
    for (std::size_t k = 0; k < particles.count(); ++k)
        if (particles.bed[k] + particles.depth[k] > start_.top)
            throw UserError(
                fmt::format("stage.top: found {:.6g} m; expected more than the {:.6g} m that material "
                            "reaches at x {:.10g}, y {:.10g}, "
                            "t = {:.6g} s; give a higher top",
                            start_.top, particles.bed[k] + particles.depth[k], particles.x[k], particles.y[k],
                            std::max(depth_averaged().status().time, scene_.solid->from)));
}

SolidSeeds StagedRun::seeds_of_window(const FlowParticles& particles, const std::vector<Surface>& surfaces) {
    require_room(particles);
    FlowParticles parts =
        in_parts(particles, scene_.solid->spacing, scene_.bed.geometry.cell, scene_.bed, reach_of(scene_));
    look_ahead(parts, scene_.bed, kAhead * scene_.solid->cell);
    stand_on_barriers(parts, surfaces);
    require_below_top(parts);
    for (std::size_t k = 0; k < particles.count(); ++k)
        became_points_ += particles.mass[k], their_depth_ += particles.mass[k] * particles.depth[k];
    return seeds_of(parts, *scene_.solid);
}

void StagedRun::step_particles(double until) {
    if (depth_averaged().status().particles == 0) {
        points_->set_adjacent(GhostParticles{});
        map_.set_adjacent(FlowParticles{});
        return;
    }
    show_points();
    const double before = depth_averaged().status().time;
    try {
        terrain_->advance(until);
    } catch (const UserError&) {  // its step was done
        take_departed();
        throw;
    }
    watch_particles(before, until);
    take_departed();
    show_particles();
}

/// They are on their way into the window.
void StagedRun::take_departed() {
    pending_ = depth_averaged().take_departed();
    for (const Departed& particle : pending_) {
        converted_.mass += particle.mass, converted_.mass_later += particle.mass;
        converted_.energy += particle.energy;
        converted_.momentum[0] += particle.mass * particle.vx, converted_.momentum[1] += particle.mass * particle.vy;
    }
}

/// The particles that flowed into the window in the particles' last step.
void StagedRun::convert_to_3d() {
    if (pending_.empty()) return;
    timed_("2D to 3D", [&] {
        std::vector<Mat2> gradients;
        const FlowParticles all = particles_at_edge(gradients);
        FlowParticles particles;
        for (std::size_t k = 0; k < pending_.size(); ++k) particles.take(all, k);
        const SolidSeeds seeds =
            seeds_of_window(particles, points_->body().surfaces);  // may be refused, with all still here
        const double given = points_->status().energy_given;
        points_->add(seeds);
        for (const Departed& particle : pending_) converted_.lost += particle.energy;
        converted_.lost -= points_->status().energy_given - given;
        pending_.clear();
    });
}

/// The map follows when material has moved by a quarter of a cell, and at output times. With barriers it follows when
/// material has moved by half a cell of the points. So what goes over them is seen there.
void StagedRun::sample(double until) {
    constexpr double kShare = 0.25;
    double far = kShare * scene_.bed.geometry.cell;
    if (watch_) far = std::min(far, 2.0 * kShare * scene_.solid->cell);
    if (points_->status().time < until && moved_ < far) return;
    if (points_->status().time >= until) find_pieces();
    spray_.sample(*points_);
    timed_("map", [&] {
        map_.sample(*points_, points_->status().time, aside_ ? FlowMap::Peaks::stay : FlowMap::Peaks::grow);
        if (watch_ && !aside_) watch_->sample(*points_);
    });
    moved_ = 0.0;
}

/// To be called before material passes from one model to the other, and the map forgets it.
void StagedRun::note_largest() {
    deepest_ = std::max({deepest_, depth_averaged().status().max_depth, map_.extent().max_depth});
    fastest_ = std::max({fastest_, depth_averaged().status().max_speed, points_->status().max_speed});
}

/// Sums of both models. All energy that the points lost counts as dissipated. What particles do not have, that of their
/// compression, is in the residual.
void StagedRun::accumulate(const Status& particles) {
    const SolidStatus& s = points_->status();
    const Index step = status_.step;
    double mass = 0.0, energy = 0.0;  // on their way, in neither model
    Vec2 momentum(0, 0);
    for (const Departed& particle : pending_) {
        mass += particle.mass, energy += particle.energy;
        momentum += particle.mass * Vec2(particle.vx, particle.vy);
    }
    double mass_back = 0.0, energy_back = 0.0;  // the same the other way
    Vec2 momentum_back(0, 0);
    for (const DepartedPoint& point : returning_) {
        mass_back += point.mass, energy_back += point.energy;
        momentum_back += point.mass * point.velocity.head<2>();
    }
    Vec3 impulse = s.momentum_given + s.weight_impulse;
    for (const Vec3& of_surface : points_->body().impulse) impulse += of_surface;
    impulse += s.ghost_impulse;
    status_ = particles;
    status_.step = step;
    if (!ended_) status_.time = s.time, status_.dt = s.dt;
    status_.particles += s.points + static_cast<Index>(pending_.size() + returning_.size());
    status_.mass += s.mass + mass + mass_back;
    status_.mass_left += s.mass_left - converted_.mass - mass_back;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        status_.momentum[axis] += s.momentum[k] + momentum[k] + momentum_back[k];
        status_.impulse[axis] += impulse[k] + momentum[k] - converted_.momentum[axis];
        status_.momentum_left[axis] += s.momentum_left[k] - converted_.momentum[axis] - momentum_back[k];
    }
    status_.kinetic += s.kinetic;
    status_.potential += s.potential + energy + energy_back;
    status_.stored = s.stored;
    const double lost = converted_.lost + returned_.lost;  // as particles became points, and points particles
    status_.in_3d = {s.friction, -s.contact_work, s.material, s.numerical() + lost, s.volume};
    status_.dissipated += s.energy_given - s.kinetic - s.potential - s.stored - s.energy_left + lost;
    status_.energy_left += s.energy_left - converted_.energy - energy_back - returned_.lost;
    status_.max_depth = std::max({deepest_, particles.max_depth, map_.extent().max_depth});
    status_.max_speed = std::max({fastest_, particles.max_speed, s.max_speed});
    deepest_ = fastest_ = 0.0;
    status_.max_speed_on_map = std::max(particles.max_speed_on_map, s.max_speed);
    status_.mean_speed = status_.mass > 0.0 ? (particles.mean_speed * particles.mass + s.speeds) / status_.mass : 0.0;
    status_.covered_area += map_.extent().covered_area;
    status_.front = std::max(particles.front, map_.extent().front);
    if (start_.sound_speed > 0.0) largest_mach_ = std::max(largest_mach_, s.max_speed / start_.sound_speed);
    if (start_.stuck && s.mass > 0.0)
        finest_needed_ = std::min(
            finest_needed_, resolving_cell(scene_.solid->law, scene_.density, depth_of_points(), s.speeds / s.mass));
}

/// Particles and points on their way from one model to the other move.
MovingMass StagedRun::motion(const MotionQuery& query) const {
    MovingMass motion = depth_averaged().motion(query);
    if (!points_) return motion;
    motion.mass = status_.mass, motion.fastest = status_.max_speed_on_map;
    for (const Departed& particle : pending_) motion.moving += particle.mass;
    for (const DepartedPoint& point : returning_) motion.moving += point.mass;
    for (Index p = 0; p < points_->body().points.count(); ++p)
        if (points_->velocity(p).norm() > query.faster_than)
            motion.moving += points_->body().points.mass[static_cast<std::size_t>(p)];
    motion.fronts += map_.fronts(query.since, query.faster_than);
    return motion;
}

/// What rests as particles may flow as points, and the other way round.
bool StagedRun::may_rest() const {
    return points_ && (!scene_.solid->until || (ended_ && depth_averaged().status().dt > 0.0));
}

/// Whether it is points that stand on a node.
bool StagedRun::stands_in_window(Index i, Index j) const {
    const std::array<Index, 4>& w = scene_.solid->window;
    return points_ && !ended_ && i >= w[0] && j >= w[1] && i <= w[2] && j <= w[3];
}

/// What depth at a node stands on [m]. In the window of points it is their ground, or the top of a barrier that leaves no
/// room beside it. Particles have barriers as ground, with a ramp before each: the ground elsewhere.
double StagedRun::ground_at(Index i, Index j) const {
    const NodeAt origin = terrain_->origin();
    const Flow& flow = depth_averaged().flow();
    const double of_particles = flow.bed.z[flow.grid.at(i + origin.i, j + origin.j)];
    if (!stands_in_window(i, j)) return of_particles;
    const double top = map_.top_below(map_.number(i, j)), bed = scene_.bed.at(i, j);
    return std::isfinite(top) ? top : std::isfinite(bed) ? bed : of_particles;
}

Sample StagedRun::at(const Vec2& point) const {
    Sample sample = depth_averaged().at(point);
    if (!points_) return sample;
    const Sample more = map_.at(point);
    const double depth = sample.depth + more.depth;
    if (depth > 0.0) {
        sample.velocity = (sample.depth * sample.velocity + more.depth * more.velocity) / depth;
        sample.speed = (sample.depth * sample.speed + more.depth * more.speed) / depth;
    }
    sample.depth = depth;
    sample.elevation = 0.0;
    const NodeAt origin = terrain_->origin();
    const NodeSquare around(depth_averaged().flow().grid.geometry(), point);
    for (Index n = 0; n < 4; ++n)
        if (const double w = around.weight(n); w > 0.0)
            sample.elevation += w * ground_at(around.node(n).i - origin.i, around.node(n).j - origin.j);
    return sample;
}

/// What the 3D model has of the case's bed law.
void StagedRun::remark_law(std::vector<std::string>& remarks) const {
    const SolidStage& stage = *scene_.solid;
    const auto* grains = std::get_if<solid::MuI>(&stage.law);
    if (stage.of_bed && grains != nullptr)
        remarks.push_back(
            fmt::format("3D points are grains with the mu(I) of material.bed, from {:.4g} to {:.4g}; stage.law names "
                        "another law",
                        grains->mu_s, grains->mu_2));
    else if (stage.of_bed)
        remarks.push_back(fmt::format(
            "3D points are sand with an internal friction of {:.3g} degrees, {}{}; stage.law names another law",
            std::atan(start_.friction) / constants::kDegree,
            stage.whole_bed_law ? "the mean of what friction at the bed may be on the way down, the slope at most"
                                : "as along the bed",
            scene_.bed_laws() ? ", or the largest friction at rest in the stage's window" : ""));
    if (stage.fluid_by_drag)
        remarks.push_back(
            "3D points are a fluid without friction inside, since the bed law has no friction at rest; stage.law names "
            "another law");
    if (stage.whole_bed_law || start_.stuck) return;
    if (scene_.bed_laws())
        remarks.push_back(fmt::format(
            "3D points have a friction of {:.3g} at the bed, by stage.bed_friction, wherever they are; friction "
            "that varies from place to place is that of particles alone",
            stage.bed_friction));
    if (hangs_on_speed(scene_.bed_law))
        remarks.push_back(fmt::format(
            "3D points feel of the bed law its Coulomb friction alone, {:.3g}: what grows with speed is missing "
            "there, so they are too fast rather than too slow",
            stage.bed_friction));
}

/// The largest depth of points at a barrier's faces so far, within a cell of the terrain [m].
double StagedRun::deepest_at(const Surface& barrier) const {
    const GridGeometry& g = scene_.bed.geometry;
    const auto [low, high] = box_around(barrier);
    const NodeBox box = common(widened(cells_of({low.head<2>(), high.head<2>()}, g), 1), map_.nodes());
    double deepest = 0.0;
    for (Index j = box.j0; j < box.j0 + box.ny; ++j)
        for (Index i = box.i0; i < box.i0 + box.nx; ++i) {
            const double depth = map_.peak(map_.number(i, j)).depth,
                         distance =
                             depth > deepest ? contact(barrier, {g.x(i), g.y(j), scene_.bed.at(i, j)}).distance : -1.0;
            if (distance >= 0.0 && distance <= g.cell) deepest = depth;
        }
    return deepest;
}

constexpr double kEnoughCells = 4.0;  ///< of depth

/// Flow that is deep as it becomes points may be thin where it comes to a barrier. It piles up there, so this says it
/// late rather than too often.
void StagedRun::remark_cells_at_barriers(std::vector<std::string>& remarks) const {
    if (!watch_) return;
    std::size_t n = 0, thin = 0;
    double least = kEnoughCells * scene_.solid->cell;
    std::string name;
    for (const Surface& surface : points_->body().surfaces) {
        if (!surface.is_barrier() || !watch_->loads().barriers[n++].touched) continue;
        const double depth = deepest_at(surface);
        if (!(depth > 0.0) || depth >= kEnoughCells * scene_.solid->cell) continue;
        ++thin;
        if (depth < least) least = depth, name = surface.name;
    }
    if (thin == 0) return;
    remarks.push_back(
        fmt::format("{}: 3D points were up to {:.3g} m deep at its faces, {:.2g} cells{}; expected {:.0f} or more, or "
                    "forces hang on "
                    "the cell, and run-up and what goes over it much more; stage.cell = {:g} would do",
                    name, least, least / scene_.solid->cell,
                    thin > 1 ? fmt::format(", and at {} more barriers fewer than expected", thin - 1) : "",
                    kEnoughCells, round_number_below(least / kEnoughCells)));
}

/// Whether the cells in 3D resolve the flow's depth, and the layer that shears at a bed that holds it.
void StagedRun::remark_cells(std::vector<std::string>& remarks) const {
    const SolidStage& stage = *scene_.solid;
    const double depth = depth_of_points(), cells = depth / stage.cell;
    if (became_points_ > 0.0 && cells < kEnoughCells)
        remarks.push_back(
            fmt::format("3D points came in {:.3g} m deep (mean by mass), {:.2g} cells; expected {:.0f} or more, "
                        "or forces hang on the cell, and run-up and what goes over a barrier much more; "
                        "stage.cell = {:g} would do",
                        depth, cells, kEnoughCells, round_number_below(depth / kEnoughCells)));
    else
        remark_cells_at_barriers(remarks);
    if (stage.stuck_where_resolved && !start_.stuck)
        remarks.push_back(fmt::format(
            "3D points slide over the bed, which brakes them by material.bed; for mud that sticks to it, with "
            "{:.3g} m/s, which it has or may come to by its weight, cells of {:g} m would be needed",
            start_.speed, round_number_below(resolving_cell(stage.law, scene_.density, start_.depth, start_.speed))));
    if (start_.stuck && stage.cell > finest_needed_)
        remarks.push_back(fmt::format(
            "3D points stick to the bed, on cells that did not show the layer that shears there when "
            "they were fastest; expected {:g} m or less, or the bed holds back more than the material does; "
            "give a smaller stage.cell, or stage.stuck = false, with which the bed law brakes them",
            round_number_below(finest_needed_)));
}

/// Walls along a line that stand thicker than they were given.
void StagedRun::remark_walls(std::vector<std::string>& remarks) const {
    for (const Barrier& barrier : scene_.barriers) {
        if (barrier.line.empty() || !barrier.thickness) continue;
        const double least = least_wall_thickness(barrier.line, scene_.solid->cell);
        if (*barrier.thickness < least)
            remarks.push_back(fmt::format(
                "{}: stands {:.3g} m thick, the least that cells of {:.3g} m hold apart; found thickness = {:.3g} m",
                barrier.name, least, scene_.solid->cell, *barrier.thickness));
    }
}

/// Points that move nearly at the speed of sound are pressed together. The stiffness of fluids, and of
/// sand by the bed, is artificial. A solid law that is given by name has the case's.
void StagedRun::remark_sound(std::vector<std::string>& remarks) const {
    constexpr double kEnough = 0.2;  // of the speed of sound: 4 % of the density
    const SolidStage& stage = *scene_.solid;
    const bool fluid = std::visit([](const auto& law) { return law.kAverages; }, stage.law);
    if (!fluid && !stage.of_bed) {
        const double sound_speed =
            std::visit([&](const auto& law) { return law.sound_speed(scene_.density); }, stage.law);
        const double mach = largest_mach_ * start_.sound_speed / sound_speed;
        if (mach > kEnough)
            remarks.push_back(fmt::format(
                "speed of sound {:.4g} m/s, by the stage's stiffness: the fastest point had {:.2g} of it, so that "
                "densities err by up to {:.3g} %; a young_modulus {:.3g} times as large would do",
                sound_speed, mach, 100.0 * mach * mach, mach * mach / (kEnough * kEnough)));
        return;
    }
    remarks.push_back(
        fmt::format("speed of sound {:.4g} m/s (artificial): the fastest point had {:.2g} of it, so that "
                    "densities err by up to {:.3g} %{}",
                    start_.sound_speed, largest_mach_, 100.0 * largest_mach_ * largest_mach_,
                    largest_mach_ > kEnough ? "; set stage.sound_speed higher" : ""));
    if (!fluid) return;  // of sand that flew apart the volume says nothing
    const SolidStatus& s = points_->status();
    const double rest = s.mass / scene_.density;
    remarks.back() += fmt::format("; volume {:.4g} of that without pressure", rest > 0.0 ? s.volume / rest : 1.0);
}

std::vector<std::string> StagedRun::remarks() const {
    std::vector<std::string> remarks = terrain_->remarks();
    if (particles_watch_)
        for (std::string& remark : particles_watch_->remarks()) remarks.push_back(std::move(remark));
    if (!points_) return remarks;
    remark_walls(remarks);
    if (watch_)
        for (std::string& remark : watch_->remarks(scene_.solid->from)) remarks.push_back(std::move(remark));
    const SolidStatus& s = points_->status();
    constexpr double kRoundOff = 1e-12;
    const double density = scene_.density, rest = s.mass / density, gone = s.mass_left - returned_.mass;
    remarks.push_back(fmt::format(
        "3D points from {:.6g} s on: {:.6g} m3 of particles became points then, {:.6g} m3 came in over the "
        "window's edges later, {:.6g} m3 became particles again, {:.6g} m3 left through its sides; {} points "
        "now; top of the space {:.6g} m",
        scene_.solid->from, (converted_.mass - converted_.mass_later) / density, converted_.mass_later / density,
        returned_.mass / density, gone > kRoundOff * s.mass_left ? gone / density : 0.0, s.points, start_.top));
    if (ended_ && !(converted_.mass > 0.0))
        remarks.push_back(fmt::format(
            "stage.until: the 3D stage ended at {:.6g} s, before anything came to its window: all of the run is "
            "depth-averaged, and no force is known; give a later stage.until, or a window that the flow reaches before",
            *scene_.solid->until));
    remark_law(remarks);
    remark_cells(remarks);
    if (const auto piled = map_.remark()) remarks.push_back(*piled);
    remark_sound(remarks);
    if (returned_.raised > 0.0)
        remarks.push_back(fmt::format(
            "{:.6g} m3 became particles on ground that barriers or walls in holes raise, and gained height: particles "
            "have "
            "no "
            "cell before it within three cells; leave as much between barriers, and between stage.window and holes",
            returned_.raised / density));
    remark_pieces(remarks);
    if (const auto spray = spray_.remark()) remarks.push_back(*spray);
    return remarks;
}

std::vector<PhaseTime> StagedRun::timings() const {
    std::vector<PhaseTime> all = terrain_->timings();
    if (points_)
        for (PhaseTime phase : points_->timings()) {
            phase.name = "points: " + phase.name;
            all.push_back(phase);
        }
    for (const PhaseTime& phase : timed_.times())
        if (phase.name != "frame") all.push_back(phase);
    return all;
}

void StagedRun::serialize(Archive& archive) {
    aside_ = archive.aside() && !archive.loading();
    Index in_3d = ended_ ? 2 : points_ ? 1 : 0;
    archive.number("in_space", in_3d);
    archive.numbers("start",
                    {&start_.sound_speed, &start_.top, &start_.blur, &start_.friction, &start_.depth, &start_.speed});
    Index stuck = start_.stuck;
    archive.number("stuck", stuck);
    start_.stuck = stuck != 0;
    if (archive.loading() && in_3d && !archive.aside()) {
        ended_ = in_3d == 2;
        points_ = std::make_unique<Mpm3d>(space_of_stage());
        points_->note_departed();
        if (!scene_.barriers.empty()) watch_.emplace(scene_, *points_, start_.blur);
        if (!ended_) terrain_->open_exits(window_nodes(*scene_.solid), false);
        at_edge_ = nodes_at_edge(scene_);
    }
    {
        const Archive::Part part(archive, "columns");
        terrain_->serialize(archive);
        if (particles_watch_) depth_averaged().note_parents();  // a larger part is another object
    }
    frana::serialize(archive, "status", status_);
    archive.numbers(
        "sums", {&converted_.mass, &converted_.energy, &converted_.lost, &converted_.mass_later,
                 &converted_.momentum[0], &converted_.momentum[1], &returned_.mass, &returned_.lost, &returned_.raised,
                 &moved_, &largest_mach_, &became_points_, &their_depth_, &finest_needed_});
    if (!archive.aside()) {  // what is in pieces is found at outputs
        archive.number("pieces", apart_.pieces);
        archive.numbers("apart", {&apart_.apart, &apart_.alone, &apart_.most_apart, &apart_.most_apart_time});
    }
    spray_.serialize(archive);
    timed_.serialize(archive);
    serialize_returning(archive);
    if (particles_watch_) {
        const Archive::Part part(archive, "columns_watch");
        particles_watch_->serialize(archive);
    }
    if (!points_) return;
    map_.serialize(archive);
    if (watch_) watch_->serialize(archive);
    if (watch_ && ended_) watch_->end();
    {
        const Archive::Part part(archive, "points");
        points_->serialize(archive);
    }
    if (archive.loading() && !ended_) {
        if (depth_averaged().status().time > points_->status().time) show_particles();
        for (const DepartedPoint& point : returning_) points_->set_adjacent(point);
    }
    if (watch_ && archive.loading()) watch_->accumulate_loads(*points_);
}

void StagedRun::serialize_returning(Archive& archive) {
    std::vector<std::int64_t> ids;
    std::vector<double> numbers;
    for (const Departed& c : pending_) {
        ids.push_back(c.id);
        numbers.insert(numbers.end(), {c.x, c.y, c.vx, c.vy, c.depth, c.mass, c.energy});
        numbers.insert(numbers.end(), c.gradient.begin(), c.gradient.end());
        numbers.insert(numbers.end(), {c.edges.r1x, c.edges.r1y, c.edges.r2x, c.edges.r2y});
    }
    archive.array("pending_id", ids);
    archive.array("pending", numbers);
    constexpr std::size_t kOfParticle = 15, kOfPoint = 19;
    if (numbers.size() != kOfParticle * ids.size())
        Archive::wrong_length("pending", numbers.size(), kOfParticle * ids.size());
    if (archive.loading()) {
        pending_.clear();
        for (std::size_t n = 0; n < ids.size(); ++n) {
            const double* const c = &numbers[kOfParticle * n];
            pending_.push_back({ids[n],
                                c[0],
                                c[1],
                                c[2],
                                c[3],
                                c[4],
                                c[5],
                                c[6],
                                {c[7], c[8], c[9], c[10]},
                                {c[11], c[12], c[13], c[14]}});
        }
    }
    std::vector<double> back;
    for (const DepartedPoint& p : returning_) {
        back.insert(back.end(), p.position.data(), p.position.data() + 3);
        back.insert(back.end(), p.velocity.data(), p.velocity.data() + 3);
        back.insert(back.end(), p.gradient.data(), p.gradient.data() + 9);
        back.insert(back.end(), {p.time, p.mass, p.energy, p.pressure});
    }
    archive.array("returning", back);
    if (back.size() % kOfPoint != 0) Archive::wrong_length("returning", back.size(), back.size() / kOfPoint * kOfPoint);
    if (!archive.loading()) return;
    returning_.clear();
    for (const double* p = back.data(); p < back.data() + back.size(); p += kOfPoint)
        returning_.push_back({p[15], Vec3(p), Vec3(p + 3), Mat3(p + 6), p[16], p[17], p[18]});
}

}  // namespace frana
