#include "solid3d/mpm3d.h"

#include <fmt/core.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "base/compensated_sum.h"
#include "base/error.h"
#include "base/flush_denormals.h"

namespace frana {
namespace {

/// Cells a point may have moved since the last sort. Tiles of one colour stand 16 nodes apart and reach 8 + 2 nodes and
/// twice the drift.
constexpr double kDriftLimit = 1.5;

/// Tiles whose mirror particles give to nodes at once stand so many tiles apart, from two to four. A tile's reach 8 + 2
/// nodes, twice the drift and twice the distance of a mirror particle from its point [cells].
constexpr double kOwnReach = static_cast<double>(kTile3d) + 2.0 + 2.0 * kDriftLimit;
Index tiles_apart(double farthest) {
    return static_cast<Index>(std::ceil((kOwnReach + 2.0 * farthest) / static_cast<double>(kTile3d)));
}

/// Seeds that would not be where the solver expects them.
void require_inside(const SolidSeeds& seeds, const GridGeometry3d& grid) {
    const std::size_t count = seeds.mass.size();
    expect(seeds.position.size() == count && seeds.velocity.size() == count &&
               (seeds.pressure.empty() || seeds.pressure.size() == count),
           "3D points have a place, a velocity and a mass each");
    for (std::size_t p = 0; p < count; ++p) {
        const Vec3 x = (seeds.position[p] - grid.origin) / grid.cell;
        for (int k = 0; k < 3; ++k)
            expect(x[k] >= 0.5 && x[k] <= static_cast<double>(grid.nodes[k]) - 1.5, "3D points lie in the grid");
        expect(seeds.mass[p] > 0.0, "3D points have mass");
    }
}

}  // namespace

SolidBody::SolidBody(const SolidScene& scene)
    : grid(scene.grid),
      nodes(grid.size()),
      surfaces(scene.surfaces),
      impulse(scene.surfaces.size(), Vec3::Zero()),
      gravity(scene.gravity),
      averaging(scene.averaging),
      density(scene.density) {
    if (!surfaces.empty()) real = LazyArray<Node>(grid.size());
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].is_barrier()) barriers |= SurfaceSet{1} << s;
    if (barriers != 0) mirror_force = LazyArray<Node>(grid.size()), on_barriers = LazyArray<Node>(grid.size());
    Vec3 high = scene.grid.origin;
    for (int k = 0; k < 3; ++k) high[k] += scene.grid.cell * static_cast<double>(scene.grid.nodes[k] - 1);
    ledger = FaceLedger(surfaces, scene.grid.origin, high, scene.grid.cell);
}

Mpm3d::Mpm3d(const SolidScene& scene)
    : body_(scene),
      kernel_(make_mpm3d_kernel(scene.law, scene.affine, scene.flip)),
      law_(scene.law),
      density_(scene.density),
      cfl_(scene.cfl),
      sound_speed_(kernel_->sound_speed(scene.density)),
      blending_(scene.blending),
      apic_(scene.affine == Affine::apic),
      splits_(scene.split) {
    expect(!scene.flip || (scene.affine == Affine::tpic && scene.blending > 0.0),
           "points that keep their velocities have tpic's gradients and a time in which they give them up");
    expect(scene.surfaces.size() <= kMostSurfaces, "more surfaces than a set of them can hold");
    flush_denormals_on_all_threads();
    if (scene.flip)
        body_.flip_sums = LazyArray<SolidBody::Node>(body_.grid.size());
    else
        body_.mass_j = LazyArray<double>(body_.grid.size());
    body_.points.states = kernel_->states();
    place(scene.points);
    sort();
}

/// Seeds become points behind those that are there, and count from now on.
void Mpm3d::place(const SolidSeeds& seeds) {
    require_inside(seeds, body_.grid.geometry());
    MaterialPoints& q = body_.points;
    const GridGeometry3d& g = body_.grid.geometry();
    const Index before = q.count(), count = static_cast<Index>(seeds.mass.size());
    q.resize(before + count);
    SolidLedger given;
    CompensatedSum total(status_.mass), energy_given;
    Vec3 moment = status_.mass * status_.centre;
    for (Index p = before; p < before + count; ++p) {
        const std::size_t n = static_cast<std::size_t>(p - before);
        const Vec3 x = (seeds.position[n] - g.origin) / g.cell;
        const double mass = seeds.mass[n], speed = seeds.velocity[n].norm();
        for (int k = 0; k < 3; ++k) q.x[k][p] = x[k], q.v[k][p] = seeds.velocity[n][k];
        for (Array& array : q.gradient) array[p] = 0.0;
        double state[7];
        const double energy = kernel_->press(seeds.pressure.empty() ? 0.0 : seeds.pressure[n], q.j[p], state);
        for (int k = 0; k < q.states; ++k) q.state[k][p] = state[k];
        q.mass[p] = mass;
        q.rest_volume[p] = mass / density_;
        q.id[p] = next_id_++;
        given.momentum_given += mass * seeds.velocity[n];
        status_.momentum += mass * seeds.velocity[n];
        moment += mass * seeds.position[n];
        total.add(mass);
        const double kinetic = 0.5 * mass * speed * speed, potential = -mass * body_.gravity.dot(seeds.position[n]),
                     stored = q.rest_volume[p] * energy;
        status_.kinetic += kinetic, status_.potential += potential, status_.stored += stored;
        energy_given.add(kinetic + potential + stored);
        status_.speeds += mass * speed;
        status_.volume += q.j[p] * q.rest_volume[p];
        status_.max_speed = std::max(status_.max_speed, speed);
    }
    given.energy_given = energy_given.value();
    account(given);
    status_.mass = total.value();
    if (status_.mass > 0.0) status_.centre = moment / status_.mass;
    status_.points = q.count();
}

void Mpm3d::add(const SolidSeeds& seeds) {
    place(seeds);
    body_.gone.resize(static_cast<std::size_t>(body_.points.count()), 0);
    sort();
}

void Mpm3d::start_at(double time) {
    expect(status_.step == 0, "a clock is set before the first step");
    status_.time = time;
}

void Mpm3d::sort() {
    sorter_.sort(body_.points, body_.grid, body_.gone, body_.active);
    body_.gone.assign(static_cast<std::size_t>(body_.points.count()), 0);
    drift_ = 0.0;
    mark_near();
}

/// Which tiles can meet which surfaces until the next sort.
void Mpm3d::mark_near() {
    const Grid3d& grid = body_.grid;
    const double h = grid.cell();
    const std::size_t surfaces = body_.surfaces.size();
    body_.near_points.assign(body_.active.tile.size(), 0);
    body_.mirror_reach.resize(body_.active.tile.size());
    body_.near_nodes.assign(body_.active.work.size(), 0);
    body_.sums.resize(body_.active.tile.size());
    body_.boxes.resize(body_.active.tile.size());
    body_.tile_work.assign(body_.active.work.size(), {});
    body_.tile_impulse.resize(body_.active.work.size() * surfaces);
    body_.point_impulse.resize(body_.active.tile.size() * surfaces);
    for (auto& colour : body_.mirror_colour) colour.clear();
    if (surfaces == 0) return;
    const auto box = [&](Index tile, double before, double behind) {
        const std::array<Index, 3> t = grid.tile_place(tile);
        std::pair<Vec3, Vec3> corners;
        for (int axis = 0; axis < 3; ++axis) {
            const double first = static_cast<double>(grid.first_node(t[axis]));
            corners.first[axis] = grid.geometry().origin[axis] + h * (first - before);
            corners.second[axis] = grid.geometry().origin[axis] + h * (first + static_cast<double>(kTile3d) + behind);
        }
        return corners;
    };
    for (Index n = 0; n < body_.active.count(); ++n) {
        // A point whose first node is n lies from n + 1/2 to n + 3/2.
        const auto [low, high] = box(body_.active.tile[n], kDriftLimit - 0.5, kDriftLimit + 0.5);
        const SurfaceSet set = surfaces_near(body_.surfaces, low, high, h, 0.0);
        body_.near_points[static_cast<std::size_t>(n)] = set;
        if (set != 0) list_mirrors(n, set, low, high);
    }
    for (std::size_t n = 0; n < body_.active.work.size(); ++n) {
        const auto [low, high] = box(body_.active.work[n], 0.0, -1.0);
        body_.near_nodes[n] = surfaces_near(body_.surfaces, low, high, h, 0.0);
    }
    mark_visible_mirrors();
    if (body_.barriers != 0) make_room_for_impulses();
}

/// Mirror particles in a level bed stand below their points, not to their side. So more tiles may give to nodes at
/// once. Where more surfaces are near, there are mirror particles of mirror particles.
void Mpm3d::list_mirrors(Index n, SurfaceSet near, const Vec3& low, const Vec3& high) {
    const bool one = (near & (near - 1)) == 0;
    const Surface& surface = body_.surfaces[static_cast<std::size_t>(__builtin_ctz(near))];
    const double farthest = one ? std::min(sideways_reach(surface, low, high), kFarthestMirror) : kFarthestMirror;
    const Index apart = tiles_apart(farthest);
    body_.mirror_reach[static_cast<std::size_t>(n)] = 0.5 * (static_cast<double>(apart * kTile3d) - kOwnReach);
    const std::array<Index, 3> t = body_.grid.tile_place(body_.active.tile[n]);
    const Index colour = t[0] % apart + 4 * (t[1] % apart) + 16 * (t[2] % 4);
    body_.mirror_colour[static_cast<std::size_t>(64 * (apart - 2) + colour)].push_back(n);
}

/// In a bent surface mirror particles may stand where its nodes lie farther than mirror particles reach in a plane.
/// There too the real material has to be told from them. A mirror particle stands up to nine cells from its point
/// (solid_kernel.cpp).
void Mpm3d::mark_visible_mirrors() {
    SurfaceSet bent = 0;
    for (std::size_t s = 0; s < body_.surfaces.size(); ++s)
        if (body_.surfaces[s].kind != Surface::Kind::plane) bent |= SurfaceSet{1} << s;
    if (bent == 0) return;
    constexpr Index kTilesAway = 2;
    const Grid3d& grid = body_.grid;
    for (Index n = 0; n < body_.active.count(); ++n) {
        const SurfaceSet set = body_.near_points[static_cast<std::size_t>(n)] & bent;
        if (set == 0) continue;
        const std::array<Index, 3> t = grid.tile_place(body_.active.tile[n]);
        for (Index k = -kTilesAway; k <= kTilesAway; ++k)
            for (Index j = -kTilesAway; j <= kTilesAway; ++j)
                for (Index i = -kTilesAway; i <= kTilesAway; ++i) {
                    const std::array<Index, 3> to = {t[0] + i, t[1] + j, t[2] + k};
                    bool inside = true;
                    for (int axis = 0; axis < 3; ++axis)
                        inside = inside && to[axis] >= 0 && to[axis] < grid.tiles_along(axis);
                    if (!inside || !body_.active.in_work[grid.tile_at(to)]) continue;
                    const auto& work = body_.active.work;
                    const auto at = std::lower_bound(work.begin(), work.end(), grid.tile_at(to)) - work.begin();
                    body_.near_nodes[static_cast<std::size_t>(at)] |= set;
                }
    }
}

/// Lists that a step fills without allocating memory: of nodes, a force or two in every one.
void Mpm3d::make_room_for_impulses() {
    constexpr std::size_t kImpulsesOfNode = 2;
    const auto make_room = [&](std::vector<std::vector<FaceImpulse>>& lists, const std::vector<SurfaceSet>& near,
                               const auto& room) {
        if (lists.size() < near.size()) lists.resize(near.size());
        for (std::size_t n = 0; n < lists.size(); ++n) {
            lists[n].clear();
            if (n < near.size() && (near[n] & body_.barriers) != 0) lists[n].reserve(room(n));
        }
    };
    make_room(body_.node_impulses, body_.near_nodes, [&](std::size_t) { return kImpulsesOfNode * kTileNodes; });
    make_room(body_.point_impulses, body_.near_points, [&](std::size_t n) {
        return static_cast<std::size_t>(body_.active.begin[n + 1] - body_.active.begin[n]);
    });
}

double Mpm3d::longest_step() const {
    const double h = body_.grid.cell(), viscosity = kernel_->explicit_viscosity();
    double longest = cfl_ * h / (sound_speed_ + status_.max_speed);
    constexpr double kViscous = 0.1;  // of rho h^2 / mu: half of what a slice was stable with, for the third direction
    if (viscosity > 0.0) longest = std::min(longest, kViscous * density_ * h * h / viscosity);
    return longest;
}

/// The longest stable step, shortened so that `until` is hit exactly and without a crumb before it.
double Mpm3d::step_length(double until) const { return status_.step_towards(until, longest_step()); }

/// One step. Points give mass, momentum and stress to the nodes, and surfaces show their mirror particles. Nodes meet
/// the surfaces, and points are carried and strained.
void Mpm3d::advance(double until) {
    expect(until > status_.time, "a step goes forward in time");
    const double dt = step_length(until);
    body_.flip_share = blending_ > 0.0 ? std::exp(-dt / blending_) : 0.0;
    timed_("clear", [&] { kernel_->clear(body_); });
    timed_("scatter", [&] { kernel_->scatter(body_, dt); });
    const bool ghosts = !body_.ghosts.material.empty();
    if (ghosts) timed_("ghost particles", [&] { kernel_->scatter_ghosts(body_, status_.time, dt); });
    timed_("mirror particles", [&] { kernel_->scatter_mirrors(body_, dt); });
    if (ghosts) timed_("ghost particles", [&] { kernel_->scatter_ghost_mirrors(body_); });
    timed_("nodes", [&] { kernel_->move_nodes(body_); });
    timed_("gather", [&] { kernel_->gather(body_, dt); });
    status_.tick(dt, until);
    accumulate();
    if (notes_ && status_.points != body_.points.count())
        for (Index p = 0; p < body_.points.count(); ++p)
            if (body_.gone[static_cast<std::size_t>(p)]) departed_.push_back(departed(p));
    const bool strayed = drift_ > kDriftLimit - 0.5;
    if (strayed && splits_) timed_("split", [&] { split(); });
    if (strayed || status_.points != body_.points.count()) timed_("sort", [&] { sort(); });
}

/// Sums in the order of the tiles: the same bits for any number of threads.
void Mpm3d::accumulate() {
    const GridGeometry3d& g = body_.grid.geometry();
    SolidSums all;
    Index left = 0;
    for (const SolidSums& sums : body_.sums) {
        all.mass += sums.mass, all.momentum += sums.momentum, all.moment += sums.moment;
        all.kinetic += sums.kinetic, all.speeds += sums.speeds, all.volume += sums.volume;
        all.left_mass += sums.left_mass, all.left_momentum += sums.left_momentum;
        all.left_energy += sums.left_energy, left += sums.left;
        all.stored += sums.stored, all.material += sums.material, all.contact_work += sums.contact_work;
        all.max_speed2 = std::max(all.max_speed2, sums.max_speed2);
        all.max_shift = std::max(all.max_shift, sums.max_shift);
        if (sums.bad >= 0) all.bad = sums.bad;
    }
    for (const SurfaceWork& work : body_.tile_work)
        all.contact_work += work.contact_work, all.friction += work.friction;
    for (const std::vector<Vec3>* list : {&body_.tile_impulse, &body_.point_impulse})
        for (std::size_t n = 0; n < list->size(); ++n) body_.impulse[n % body_.surfaces.size()] += (*list)[n];
    if (body_.barriers != 0) accumulate_barrier_impulses();
    SolidLedger step;
    for (const Vec3& given : body_.ghosts.tile_impulse) step.ghost_impulse += given;
    step.weight_impulse = status_.dt * (all.mass + all.left_mass) * body_.gravity;
    require_finite(all);
    status_.points = body_.points.count() - left;
    status_.mass = all.mass;
    status_.momentum = all.momentum;
    status_.kinetic = all.kinetic;
    status_.stored = all.stored;
    step.material = all.material, step.contact_work = all.contact_work, step.friction = all.friction;
    status_.speeds = all.speeds;
    status_.volume = all.volume;
    status_.max_speed = std::sqrt(all.max_speed2);
    step.mass_left = all.left_mass, step.momentum_left = all.left_momentum, step.energy_left = all.left_energy;
    account(step);
    if (all.mass > 0.0) status_.centre = g.origin + g.cell / all.mass * all.moment;
    status_.potential = -all.mass * body_.gravity.dot(status_.centre);
    drift_ += all.max_shift;
}

void Mpm3d::account(const SolidLedger& more) { static_cast<SolidLedger&>(status_) = since_start_.add(more); }

void Mpm3d::accumulate_barrier_impulses() {
    for (const auto* lists : {&body_.node_impulses, &body_.point_impulses})
        for (const std::vector<FaceImpulse>& list : *lists)
            for (const FaceImpulse& part : list) {
                body_.ledger.add(part);
                body_.impulse[static_cast<std::size_t>(
                    body_.ledger.faces()[static_cast<std::size_t>(part.face)].surface)] += part.impulse;
            }
}

void Mpm3d::require_finite(const SolidSums& sums) const {
    if (sums.bad < 0) return;
    const Vec3 x = position(sums.bad);
    throw NumericsError(fmt::format(
        "step {}, t = {:.6g} s, dt = {:.3g} s: the point at ({:.6g}, {:.6g}, {:.6g}) would move by more than "
        "a cell in one step or is not finite; reduce the time step (cfl is {}) or look at the surfaces there",
        status_.step, status_.time, status_.dt, x.x(), x.y(), x.z(), cfl_));
}

Vec3 Mpm3d::position(Index p) const {
    const MaterialPoints& q = body_.points;
    const GridGeometry3d& g = body_.grid.geometry();
    return g.origin + g.cell * Vec3(q.x[0][p], q.x[1][p], q.x[2][p]);
}

Sym3 Mpm3d::stress(Index p) const {
    const MaterialPoints& q = body_.points;
    double state[7];
    for (int n = 0; n < q.states; ++n) state[n] = q.state[n][p];
    return std::visit([&](const auto& law) { return law.stress(q.j[p], state, gradient(p)); }, law_) * (1.0 / q.j[p]);
}

Mat3 Mpm3d::gradient(Index p) const {
    Mat3 gradient;
    for (int n = 0; n < 9; ++n) gradient(n % 3, n / 3) = body_.points.gradient[n][p];
    return gradient;
}

Vec3 Mpm3d::momentum_residual() const {
    Vec3 given = status_.momentum_given + status_.weight_impulse + status_.ghost_impulse;
    for (const Vec3& impulse : body_.impulse) given += impulse;
    return status_.momentum + status_.momentum_left - given;
}

/// Of the affine motion: m h^2 / 4 times the axial vector of the gradient's skew part. Jiang et al. (2015), eq. 6 there.
Vec3 Mpm3d::angular_momentum() const {
    Vec3 sum = Vec3::Zero();
    const double h = body_.grid.cell();
    for (Index p = 0; p < body_.points.count(); ++p) {
        sum += body_.points.mass[p] * position(p).cross(velocity(p));
        if (!apic_) continue;
        const Mat3 l = gradient(p);
        sum += body_.points.mass[p] * 0.25 * h * h * Vec3(l(2, 1) - l(1, 2), l(0, 2) - l(2, 0), l(1, 0) - l(0, 1));
    }
    return sum;
}

}  // namespace frana
