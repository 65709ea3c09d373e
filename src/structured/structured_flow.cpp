#include "structured/structured_flow.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "base/compensated_sum.h"
#include "base/error.h"
#include "base/flush_denormals.h"
#include "mpm/stencil.h"

namespace frana {
namespace {

/// Cells a point may have moved since the last sort. Tiles of one colour stand 16 nodes apart and reach 2 nodes and
/// twice the drift.
constexpr double kDriftLimit = 2.0;

constexpr Index kStepsBetweenSplits = 3;

void require_inside(const StructuredSeeds& seeds, const GridGeometry& g) {
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        const double x = (seeds.x[p] - g.x0) / g.cell, y = (seeds.y[p] - g.y0) / g.cell;
        expect(x >= 0.0 && y >= 0.0 && x <= static_cast<double>(g.nx) - 1.0 && y <= static_cast<double>(g.ny) - 1.0,
               "structured particles start in the grid");
        expect(seeds.mass[p] > 0.0 && seeds.depth[p] > 0.0 && seeds.cohesion[p] >= 0.0 && seeds.damage[p] >= 0.0 &&
                   seeds.damage[p] <= 1.0,
               "structured particles have mass, depth, cohesion and damage");
    }
}

}  // namespace

StructuredBody::StructuredBody(const StructuredScene& scene)
    : flow({scene.grid, scene.density, scene.gravity, false, true, false, scene.scheme}, {}),
      law(scene.material),
      grain_pressure(grid.size()),
      moved(grid.size()),
      ground(grid.size()),
      block_depth(grid.size()),
      obstacles(scene.obstacles),
      rankine(scene.hydrostatic ? Rankine{} : Rankine{law.active(), law.passive()}),
      bed_law(scene.bed_law),
      creep_filter(scene.laws || !std::holds_alternative<bed::None>(scene.bed_law), grid),
      density(scene.density),
      share(scene.share),
      gravity(scene.gravity),
      by_depth(scene.laws || hangs_on_speed(scene.bed_law)),
      mapped(static_cast<bool>(scene.bed)),
      curved(scene.bed && scene.curved) {
    if (scene.laws) flow.laws.emplace(*scene.laws, grid);
}

StructuredFlow::StructuredFlow(const StructuredScene& scene)
    : body_(scene),
      ground_(scene.ground),
      bed_(scene.bed),
      rules_{scene.scheme.split_length, 0.0, scene.scheme.split, scene.scheme.reset_domains, 0.0},
      cfl_(scene.cfl),
      sound_speed_(scene.share > 0.0 || !scene.hydrostatic ? body_.law.sound_speed(scene.density) : 0.0),
      hydrostatic_(scene.hydrostatic) {
    flush_denormals_on_all_threads();
    for (const double m : scene.points.mass)
        rules_.least_mass = std::max(rules_.least_mass, scene.scheme.split_min_mass * m);
    place(scene);
    if (body_.grains) begin_grains();
    sort();
    sample();
}

void StructuredFlow::place(const StructuredScene& scene) {
    const StructuredSeeds& seeds = scene.points;
    const GridGeometry& g = body_.grid.geometry();
    require_inside(seeds, g);
    StructuredPoints& q = body_.points;
    const Index count = static_cast<Index>(seeds.x.size());
    q.resize(count);
    CompensatedSum mass;
    for (Index p = 0; p < count; ++p) {
        const std::size_t n = static_cast<std::size_t>(p);
        q.x[p] = (seeds.x[n] - g.x0) / g.cell, q.y[p] = (seeds.y[n] - g.y0) / g.cell;
        q.vx[p] = seeds.vx[n], q.vy[p] = seeds.vy[n];
        for (Array* array : {&q.cxx, &q.cxy, &q.cyx, &q.cyy, &q.xx, &q.yy, &q.xy, &q.strain}) (*array)[p] = 0.0;
        q.mass[p] = seeds.mass[n], q.volume[p] = seeds.mass[n] / body_.density;
        q.depth[p] = q.layer[p] = seeds.depth[n];
        q.damage[p] = seeds.damage[n], q.cohesion[p] = seeds.cohesion[n];
        q.normal_gravity[p] = ground_(seeds.x[n], seeds.y[n]).across;
        q.zz[p] = -0.5 * body_.density * q.normal_gravity[p] * q.depth[p];
        q.confined[p] = scene.confined * q.volume[p], q.solids[p] = q.volume[p] - q.confined[p];
        q.released[p] = 0.0;
        q.r1x[p] = q.r2y[p] = std::sqrt(q.volume[p] / q.depth[p]) / g.cell, q.r1y[p] = q.r2x[p] = 0.0;
        q.id[p] = p;
        const Vec2 v(q.vx[p], q.vy[p]);
        mass.add(q.mass[p]);
        status_.momentum += q.mass[p] * v;
        status_.kinetic += 0.5 * q.mass[p] * v.squaredNorm();
        status_.damage += q.mass[p] * q.damage[p];
        status_.max_speed = std::max(status_.max_speed, v.norm());
        wave_ = std::max(wave_, v.norm() + std::sqrt(2.0 * q.normal_gravity[p] * q.depth[p]));
        signal_ = std::max(signal_, v.norm() + std::sqrt(q.normal_gravity[p] * q.depth[p]));
        if (q.damage[p] > 0.0 || body_.share < 1.0) body_.grains = true;
    }
    status_.mass = mass.value();
    if (status_.mass > 0.0) status_.damage /= status_.mass;
    status_.momentum_given = status_.momentum;
    status_.points = count;
    halves_.next_id = count;
}

/// There are grains from now on: they need a bed under their surface.
void StructuredFlow::begin_grains() {
    body_.grains = true;
    body_.flow.bed = bed_ ? bed_(body_.grid) : level_bed(body_.grid);
}

/// Grains that spread are split, so that they do not fall apart by the scheme. What holds together is left as it is.
void StructuredFlow::split() {
    const StructuredPoints& q = body_.points;
    const auto may = [&](Index p) { return body_.share * (1.0 - q.damage[p]) == 0.0; };
    const double own = Quadratic::kMostOfItself / (body_.density * body_.flow.area);
    const auto alone = [&](Index p) { return may(p) && q.layer[p] <= own * q.mass[p]; };
    if (halve_points(body_.grid, body_.active, rules_, body_.points, body_.points, halves_, may, alone) > 0) {
        body_.gone.assign(static_cast<std::size_t>(q.count()), 0);
        sort();
    }
}

void StructuredFlow::sort() {
    StructuredPoints& q = body_.points;
    order_.find_tiles(q.count(), body_.grid.tiles(), [&](Index p) {
        if (!body_.gone.empty() && body_.gone[static_cast<std::size_t>(p)]) return Index{-1};
        return body_.grid.tile_of(q.x[p], q.y[p]);
    });
    order_.lay_out(body_.active);
    order_.permute_points(q);
    drift_ = 0.0;
    take_tiles();
}

void StructuredFlow::meet(const FreeWater& water) {
    body_.water = water;
    if (!body_.bound) body_.bound = LazyArray<StructuredBody::Bound>(body_.grid.size());
    sample();
    if (status_.step == 0) press(body_);
}

/// What follows from the tiles that hold particles.
void StructuredFlow::take_tiles() {
    StructuredPoints& q = body_.points;
    left_ = body_.active.work;
    lists_.list_tiles(body_.grid, body_.active);
    left_.reserve(body_.active.work.capacity());  // grows with the list, not a sort later
    for (const Index tile : left_) {              // what is not cleared any more must not show when particles return
        if (body_.active.in_work[static_cast<std::size_t>(tile)]) continue;
        const Index first = body_.grid.at(body_.grid.tile_i(tile), body_.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j) {
            std::fill_n(&body_.moved[first + j * body_.grid.stride()], kTile, StructuredBody::Moved{});
            if (body_.grains) std::fill_n(&body_.flow.nodes.column_mass[first + j * body_.grid.stride()], kTile, 0.0);
        }
    }
    body_.gone.assign(static_cast<std::size_t>(q.count()), 0);
    body_.sums.resize(body_.active.tile.size());
    body_.tallies.resize(body_.active.work.size());
    for (const Index tile : body_.active.work) body_.flow.rest.active[tile] = 1;
    learn_ground();
}

/// Finds the ground and obstacles at the nodes of tiles that are new to the list.
void StructuredFlow::learn_ground() {
    const GridGeometry& g = body_.grid.geometry();
    for (const Index tile : body_.active.work) {
        const Index i0 = body_.grid.tile_i(tile), j0 = body_.grid.tile_j(tile);
        if (body_.ground[body_.grid.at(i0, j0)].open > 0.0) continue;
        for (Index j = j0; j < j0 + kTile; ++j)
            for (Index i = i0; i < i0 + kTile; ++i) {
                const GroundGravity ground = ground_(g.x(i), g.y(j));
                body_.has_exits = body_.has_exits || ground.exit;
                const double open = open_share(body_.obstacles, {g.x(i), g.y(j)}, g.cell, kLeastOpen);
                body_.ground[body_.grid.at(i, j)] = {
                    ground.x,       ground.y,         ground.across, ground.slope_x,
                    ground.slope_y, ground.elevation, open,          ground.hole ? 2.0 : ground.exit ? 1.0 : 0.0};
            }
    }
}

double StructuredFlow::step_length(double until) const { return status_.step_towards(until, longest_step()); }

/// Sound and flow pass part of a cell. Nothing here bounds the step for grains alone. Their earth pressure grows fast
/// with the rate of squeezing (earth_pressure.h). It needs steps below cell^2 / (5 (Kp - Ka) sqrt(g_z h^3)), or is
/// noisy. The elastic step is mostly near that. Hydrostatic grains do not.
double StructuredFlow::longest_step() const {
    const bool flows = sound_speed_ == 0.0 || (hydrostatic_ && status_.damage >= 1.0);  // all grains, to the last bit
    return flows ? flow_step(wave_) : cfl_ * body_.grid.cell() / (sound_speed_ + wave_);
}

/// The step if nothing were elastic. Grains at rest have no speed to go by, but fall (DepthAveraged::longest_step).
double StructuredFlow::flow_step(double signal) const {
    const double reach = cfl_ * body_.grid.cell();
    return 2.0 * reach / (signal + std::sqrt(signal * signal + 2.0 * body_.gravity * reach));
}

double StructuredFlow::sub_cycling() const {
    return status_.flow_steps > 0.0 ? static_cast<double>(status_.step) / status_.flow_steps : 1.0;
}

void StructuredFlow::advance(double until) {
    expect(until > status_.time, "a step goes forward");
    const double dt = step_length(until);
    status_.flow_steps += longest_step() / flow_step(signal_);
    const double ahead = until - status_.time;
    const StepTimes times = body_.grains ? StepTimes{0.5 * (status_.dt + dt), dt, ahead} : StepTimes{dt, 0.0, ahead};
    timed_("clear", [&] { clear_nodes(body_); });
    timed_("scatter", [&] { scatter(body_); });
    if (body_.grains) timed_("surface", [&] { raise_surface(body_, times.velocity_dt); });
    timed_("nodes", [&] { move_nodes(body_, times); });
    timed_("gather", [&] { gather(body_, dt); });
    status_.tick(dt, until);
    accumulate();
}

void StructuredFlow::sample() {
    clear_nodes(body_);
    scatter(body_);
    if (body_.grains) raise_surface(body_, 0.0);
    sample_nodes(body_);
    update_totals();
}

/// Energies along the bed, of the tallies.
void StructuredFlow::update_totals() {
    status_.bed_kinetic = status_.potential = 0.0;
    for (const StructuredTally& tile : body_.tallies)
        status_.bed_kinetic += tile.kinetic, status_.potential += tile.potential;
}

/// Sums of the tiles, in their order; points that left are dropped, and points that moved far are sorted.
void StructuredFlow::accumulate() {
    StructuredSums all;
    for (const StructuredSums& tile : body_.sums) {
        all.mass += tile.mass, all.kinetic += tile.kinetic, all.damaged += tile.damaged;
        all.max_speed2 = std::max(all.max_speed2, tile.max_speed2),
        all.max_wave = std::max(all.max_wave, tile.max_wave),
        all.max_signal = std::max(all.max_signal, tile.max_signal);
        all.stored += tile.stored, all.worked += tile.worked;
        all.momentum += tile.momentum, all.left_mass += tile.left_mass, all.left_momentum += tile.left_momentum;
        all.left_energy += tile.left_energy, all.released += tile.released;
        all.left_confined += tile.left_confined, all.lost_in_holes += tile.lost_in_holes;
        if (tile.bad >= 0) all.bad = tile.bad;
    }
    StructuredLedger step;
    for (const StructuredTally& tile : body_.tallies) {
        step.impulse.add(tile.impulse);
        step.friction += tile.friction, step.obstacle_work += tile.obstacles, step.dragged += tile.drag;
        step.squeezed += tile.squeezed, status_.outrun += tile.outrun;
    }
    update_totals();
    if (all.bad >= 0)
        throw NumericsError(
            fmt::format("structured particles, step {}, t = {:.6g} s, dt = {:.3g} s: particle {} has numbers "
                        "that are not finite; a smaller cfl may help",
                        status_.step, status_.time, status_.dt, body_.points.id[all.bad]));
    status_.mass = all.mass, status_.momentum = all.momentum, status_.kinetic = all.kinetic;
    status_.stored = all.stored, step.worked = all.worked;
    step.energy_left = all.left_energy, step.released = all.released, step.confined_left = all.left_confined;
    step.lost_in_holes = all.lost_in_holes, step.mass_left = all.left_mass, step.momentum_left = all.left_momentum;
    static_cast<StructuredLedger&>(status_) = since_start_.add(step);
    status_.damage = all.mass > 0.0 ? all.damaged / all.mass : 0.0;
    status_.max_speed = std::sqrt(all.max_speed2);
    wave_ = all.max_wave, signal_ = all.max_signal;
    if (all.damaged > 0.0 && !body_.grains) begin_grains();
    drift_ += status_.dt * status_.max_speed / body_.grid.cell();
    if (all.left_mass > 0.0 || drift_ > kDriftLimit - 1.0) sort();
    if (body_.grains && status_.step % kStepsBetweenSplits == 0) split();
    status_.points = body_.points.count();
}

Vec2 StructuredFlow::position(Index p) const {
    const GridGeometry& g = body_.grid.geometry();
    return {g.x0 + g.cell * body_.points.x[p], g.y0 + g.cell * body_.points.y[p]};
}

Index StructuredFlow::particle_bytes() const { return body_.points.bytes() + order_.bytes(); }

Vec2 StructuredFlow::momentum_residual() const {
    return status_.momentum + status_.momentum_left - status_.momentum_given - status_.impulse.sum();
}

}  // namespace frana
