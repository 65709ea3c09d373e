// The loops over the nodes in a step of structured solids. Forces, bed, obstacles and free water change their velocity.
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "structured/node_forces.h"
#include "structured/node_water.h"

namespace frana {
namespace {

using Moved = StructuredBody::Moved;

double total(double a) { return a; }
double total(Double4 a) { return sum(a); }

/// Impulses and energies of a tile's nodes (StructuredTally), of one after the other or of four.
template <class Real>
struct TallyOf {
    FlatOf<Real> weight, pressure, friction, obstacles;
    Real braked{}, squeezed{}, obstacle_work{}, kinetic{}, potential{};

    void add_to(StructuredTally& t) const {
        const auto flat = [](const FlatOf<Real>& a) { return Vec2(total(a.x), total(a.y)); };
        t.impulse.weight += flat(weight), t.impulse.pressure += flat(pressure);
        t.impulse.friction += flat(friction), t.impulse.obstacles += flat(obstacles);
        t.friction += total(braked), t.squeezed += total(squeezed), t.obstacles += total(obstacle_work);
        t.kinetic += total(kinetic), t.potential += total(potential);
    }
};

/// Nodes between the forces and the bed.
template <class Real>
struct DrivenOf {
    Real mass, across, depth;
    FlatOf<Real> before, driven;
    Real law_depth;         ///< for friction (friction_depth) [m]
    double density;         ///< of what is there [kg/m^3]
    FlatOf<Real> beyond{};  ///< of what drove it, by earth pressure that is not hydrostatic [m/s]
    FlatOf<Real> thrust{};  ///< and by the grains' surface and all their pressure [kg m/s]
};

/// A tile and its step.
template <class Law>
struct NodeStep {
    const Law& law;
    StructuredBody& body;
    StepTimes times;
    StructuredTally tally;
    TallyOf<double> single;
    TallyOf<Double4> four;
    /// At node k, or at four from there on.
    template <class Real>
    decltype(auto) law_at(Index k) const {
        return frana::law_at<Real>(law, body.flow.laws, k);
    }
    auto& of(double) { return single; }
    auto& of(Double4) { return four; }
};

[[gnu::always_inline]] inline void store_motion(Moved* moved, const FlatOf<double>& v, double across, double depth) {
    *moved = {v.x, v.y, across, depth};
}
[[gnu::always_inline]] inline void store_motion(Moved* moved, const FlatOf<Double4>& v, Double4 across, Double4 depth) {
    Double4 of[4];
    transpose(v.x, v.y, across, depth, of);
    for (int n = 0; n < 4; ++n) store(moved + n, of[n]);
}

/// Where node k is, or the one `lane` behind it [m].
Vec2 place_of(const StructuredBody& body, Index k, int lane) {
    const GridGeometry& g = body.grid.geometry();
    return {g.x(k % body.grid.stride() - kTile + lane), g.y(k / body.grid.stride() - kTile)};
}

/// The velocity `v` of node k, or of the one `lane` behind it, without what obstacles stop.
Vec2 stopped(const StructuredBody& body, Index k, int lane, const Vec2& v) {
    const Vec2 place = place_of(body, k, lane);
    Vec2 left = v;
    for (std::size_t n = 0; n < body.obstacles.size(); ++n) {
        const FaceBehind at = nearest_face(body.obstacles, n, place, body.grid.cell());
        if (at.face >= 0) left = body.obstacles[n].stopped(at.face, left);
    }
    return left;
}
FlatOf<double> stopped(const StructuredBody& body, Index k, const FlatOf<double>& v) {
    const Vec2 left = stopped(body, k, 0, {v.x, v.y});
    return {left.x(), left.y()};
}
[[gnu::always_inline]] inline FlatOf<Double4> stopped(const StructuredBody& body, Index k, const FlatOf<Double4>& v) {
    FlatOf<Double4> all;
    for (int n = 0; n < 4; ++n) {
        const Vec2 left = stopped(body, k, n, {v.x[n], v.y[n]});
        all.x[n] = left.x(), all.y[n] = left.y();
    }
    return all;
}

/// The axis across the face that stops a node; below 0 where none does.
int axis_of_face(const StructuredBody& body, Index k, int lane) {
    for (std::size_t n = 0; n < body.obstacles.size(); ++n) {
        const FaceBehind at = nearest_face(body.obstacles, n, place_of(body, k, lane), body.grid.cell());
        if (at.face >= 0) return at.face / 2;
    }
    return -1;
}

/// The grains of a node that may press on faces.
struct GrainsPressing {
    double mass, depth, across, density;  ///< [kg], [m], [m/s^2], [kg/m^3]
    double dt;                            ///< of the step [s]
};

/// What faces of obstacles do to a node's grains that press on them.
struct FacesPressed {
    Vec2 reaction{0, 0};  ///< impulse on the grains [kg m/s]
    Vec2 brake{0, 0};     ///< most by which friction along the faces changes the velocity [m/s]
};

/// The obstacle that covers most of a node.
const Obstacle& obstacle_at(const StructuredBody& body, const Vec2& node) {
    const double cell = body.grid.cell();
    return *std::max_element(body.obstacles.begin(), body.obstacles.end(), [&](const Obstacle& a, const Obstacle& b) {
        return covered(a.low, a.high, node, cell) < covered(b.low, b.high, node, cell);
    });
}

/// Whether node k is behind a face, with next to nothing open: its surface is that of the grains before the face.
bool is_blocked(const StructuredBody& body, Index k) { return body.ground[k].open <= kLeastOpen; }

/// The surface goes on level behind faces (grain_surface.cpp), so that their reaction to earth pressure is a part of
/// the thrust. It is rho g_z K h^2 / 2 for each metre of them. Between two nodes there is as much of a face as less is
/// open.
FacesPressed press_on_faces(const StructuredBody& body, Index k, int lane, const GrainsPressing& grains) {
    FacesPressed faces;
    const Index node = k + lane, up = body.grid.stride();
    if (is_blocked(body, node) || !(grains.depth > 0.0)) return faces;
    const GridGeometry& g = body.grid.geometry();
    const Vec2 place = place_of(body, k, lane);
    const double impulse = 0.5 * grains.density * grains.across * grains.depth * grains.depth * g.cell * grains.dt;
    const StructuredBody::GrainPressure& pressure = body.grain_pressure[node];
    for (const int axis : {0, 1})
        for (const int side : {-1, 1}) {
            const Index next = node + side * (axis == 0 ? 1 : up);
            const double beyond = is_blocked(body, next) ? 0.0 : body.ground[next].open;
            const double length = body.ground[node].open - beyond;
            if (!(length > 0.0) || body.ground[next].open == 0.0) continue;  // 0: no particle has come near it
            const double normal = length * impulse * (axis == 0 ? pressure.xx : pressure.yy);
            faces.reaction[axis] -= side * normal;
            Vec2 behind = place;
            behind[axis] += side * g.cell;
            // What sticks is held at the nodes of the face: what is a cell before it may slip.
            const double friction = obstacle_at(body, behind).friction;
            if (std::isfinite(friction)) faces.brake[1 - axis] += friction * normal / grains.mass;
        }
    return faces;
}

double lane_of(double a, int) { return a; }
double lane_of(Double4 a, int n) { return a[n]; }
void set_lane(double& a, int, double value) { a = value; }
void set_lane(Double4& a, int n, double value) { a[n] = value; }

double less(double v, double brake) { return std::copysign(std::max(0.0, std::abs(v) - brake), v); }

/// The reaction of faces to the grains of a node, or of four [kg m/s]. Friction along them changes the velocity `v`.
template <class Real>
FlatOf<Real> reaction_of_faces(const StructuredBody& body, Index k, const DrivenOf<Real>& node, double dt,
                               FlatOf<Real>& v) {
    constexpr int kLanes = std::is_same_v<Real, double> ? 1 : 4;
    FlatOf<Real> reaction;
    for (int n = 0; n < kLanes; ++n) {
        FacesPressed faces = press_on_faces(
            body, k, n, {lane_of(node.mass, n), lane_of(node.depth, n), lane_of(node.across, n), node.density, dt});
        if (is_blocked(body, k + n)) {
            // Its thrust is that of a surface that is not there: what it does to the motion the face does.
            const int axis = axis_of_face(body, k, n);
            if (axis >= 0) faces.reaction[axis] = lane_of(axis == 0 ? node.thrust.x : node.thrust.y, n);
        }
        set_lane(reaction.x, n, faces.reaction.x()), set_lane(reaction.y, n, faces.reaction.y());
        if (faces.brake.x() > 0.0) set_lane(v.x, n, less(lane_of(v.x, n), faces.brake.x()));
        if (faces.brake.y() > 0.0) set_lane(v.y, n, less(lane_of(v.y, n), faces.brake.y()));
    }
    return reaction;
}

/// Obstacles, then friction, and what they took: what an obstacle bears friction need not hold.
template <class Real, class Law>
[[gnu::always_inline]] inline void finish(NodeStep<Law>& step, Index k, const GroundOf<Real>& ground,
                                          const DrivenOf<Real>& node) {
    const StructuredBody& body = step.body;
    TallyOf<Real>& tally = step.of(Real{});
    FlatOf<Real> free = body.obstacles.empty() ? node.driven : stopped(body, k, node.driven);
    if (body.grains && !body.obstacles.empty()) {
        const FlatOf<Real> reaction = reaction_of_faces(body, k, node, step.times.velocity_dt, free);
        tally.obstacles += reaction, tally.pressure += FlatOf<Real>{} - reaction;
    }
    const FlatOf<Real> left = braked(step.template law_at<Real>(k), body, node.density, ground, node.across,
                                     node.law_depth, node.before, free, step.times);
    tally.friction += node.mass * (left - free);
    // By the velocity that is left: what rests under stress and friction loses nothing.
    tally.braked += node.mass * ground.along(free - left, left);
    if (body.grains) tally.squeezed -= (0.5 * node.mass) * ground.along(node.beyond, node.before + left);
    if (!body.obstacles.empty()) {
        tally.obstacles += node.mass * (free - node.driven);
        tally.obstacle_work += node.mass * ground.along(node.driven - free, left);
    }
    tally.kinetic += 0.5 * node.mass * ground.along(left, left);
    tally.potential += (body.gravity * node.mass) * (ground.elevation + 0.5 * node.depth);
    store_motion(&step.body.moved[k], left, node.across, node.depth);
}

/// Depth of a node's particles in the dry [m].
template <class Real>
[[gnu::always_inline]] inline Real dry_depth(const StructuredBody& body, Index k, Real mass, Real open) {
    if (body.grains) return read<Real>(&body.flow.nodes.depth[k]);
    return mass / (body.density * body.flow.area * open);
}

/// The depth that friction uses [m]. `share`: of grains, which have that of the depth-averaged flow. Structure is as deep
/// as its particles are. Around a block its depth is smeared, and covers a part of each node. Drag of thin flow there
/// would hold the whole block. What lies on a block makes it deeper.
template <class Real>
[[gnu::always_inline]] inline Real friction_depth(const StructuredBody& body, Index k, Real mass, Real depth,
                                                  Real share) {
    if (!body.by_depth) return depth;
    const Real of_blocks = max(read<Real>(&body.block_depth[k]) / mass, (1.0 - share) * depth);
    return body.grains ? share * read<Real>(&body.flow.nodes.law_depth[k]) + of_blocks : of_blocks;
}

/// What grains do at a node whose weight acts already. Over a bend that is by the velocity in the middle of the step.
/// There the stress of the structure does not count: a node with next to no mass gets any speed by it.
template <class Real, class Law>
[[gnu::always_inline]] inline GrainForceOf<Real> force_of_grains(const NodeStep<Law>& step, Index k,
                                                                 const GroundOf<Real>& ground,
                                                                 const DrivenOf<Real>& node, double bears) {
    if (!step.body.curved) return grain_force(step.body, k, ground, bears, node.before);
    const double dt = step.times.velocity_dt;
    const FlatOf<Real> brought = frana::brought(step.body, k, read<Real>(&step.body.node_mass[k]));
    const GrainForceOf<Real> at_start = grain_force(step.body, k, ground, bears, brought);
    const FlatOf<Real> all = (Real{} + 1.0 / dt) * (node.driven - node.before) + at_start.acceleration;
    return grain_force(
        step.body, k, ground, bears,
        midway(step.template law_at<Real>(k), ground, node.across * at_start.weight(), brought, all, dt));
}

/// What grains add to a velocity that is `driven` without them.
template <class Real, class Law>
[[gnu::always_inline]] inline FlatOf<Real> thrust_of(const NodeStep<Law>& step, Index k,
                                                     const GrainForceOf<Real>& grains, double bears,
                                                     const FlatOf<Real>& driven) {
    const double dt = step.times.velocity_dt;
    const FlatOf<Real> thrust = (Real{} + dt) * grains.acceleration;
    return step.body.curved ? climbed(step.body, k, grains, bears, driven + thrust, dt) - driven : thrust;
}

/// A node without water, or four.
template <class Real, class Law>
[[gnu::always_inline]] inline void move_dry(NodeStep<Law>& step, Index k) {
    const StructuredBody& body = step.body;
    const Real mass = read<Real>(&body.node_mass[k]), dt = Real{} + step.times.velocity_dt;
    const GroundOf<Real> ground = ground_at(&body.ground[k], Real{});
    const FlatOf<Real> weight = dt * ground.plane_gravity, before = stressed(body, k, mass, step.times.velocity_dt);
    const Real depth = dry_depth(body, k, mass, ground.open);
    DrivenOf<Real> node{mass, ground.across, depth, before, before + weight, Real{}, body.density};
    Real share{};  // of grains
    TallyOf<Real>& tally = step.of(Real{});
    tally.weight += mass * weight;
    if (body.grains) {
        const GrainForceOf<Real> grains = force_of_grains(step, k, ground, node, 1.0);
        const FlatOf<Real> thrust = thrust_of(step, k, grains, 1.0, node.driven);
        node.driven += thrust, node.thrust = mass * thrust;
        tally.pressure += node.thrust;
        node.beyond = dt * grains.beyond;
        node.across *= grains.weight();
        share = grains.share;
    }
    node.law_depth = friction_depth(body, k, mass, depth, share);
    finish(step, k, ground, node);
}

Vec2 vec(const FlatOf<double>& a) { return {a.x, a.y}; }
FlatOf<double> flat(const Vec2& a) { return {a.x(), a.y()}; }

/// What water adds to the velocity of a node's particles. Drag uses what friction holds, and friction then what drag does.
/// Where it holds that as well, the water slips past what rests.
template <class Law>
Vec2 drag_after_friction(NodeStep<Law>& step, Index k, const Met& met, const GroundOf<double>& ground,
                         const DrivenOf<double>& node) {
    StructuredBody& body = step.body;
    const double dt = step.times.velocity_dt;
    const auto left = [&](const FlatOf<double>& driven) {
        return vec(braked(step.template law_at<double>(k), body, node.density, ground, node.across, node.law_depth,
                          node.before, driven, {dt, 0.0}));
    };
    const Vec2 held = left(node.driven);
    DragStep drags = drag_step(body, k, met, vec(node.before), held, step.times);
    if (held.isZero(0.0)) drags.held = left(node.driven + flat(drags.dragged(dt))).isZero(0.0);
    return drag(body, k, met, drags, step.times, step.tally) - held;
}

/// A node that may have water.
template <class Law>
void move_wet(NodeStep<Law>& step, Index k) {
    StructuredBody& body = step.body;
    const double dt = step.times.velocity_dt, mass = body.node_mass[k];
    const GroundOf<double> ground = ground_at(&body.ground[k], 0.0);
    const Met met = meet_water(body, k);
    const bool releases = met.mass != mass;
    const FlatOf<double> before = releases ? stressed_part(body, k, mass, met.mass, dt) : stressed(body, k, mass, dt);
    StructuredImpulses& impulse = step.tally.impulse;
    if (releases) impulse.water -= (mass - met.mass) * vec(brought(body, k, mass));
    const FlatOf<double> weight = dt * (ground.plane_gravity + flat(met.lift));
    DrivenOf<double> node{met.mass,
                          (1.0 - met.support) * ground.across,
                          met.depth,
                          before,
                          before + weight,
                          0.0,
                          density_of(body, k, met)};
    impulse.weight += met.mass * vec(weight);
    double share = 0.0;  // of grains
    if (body.grains) {
        const GrainForceOf<double> grains = force_of_grains(step, k, ground, node, 1.0 - met.support);
        const FlatOf<double> thrust = thrust_of(step, k, grains, 1.0 - met.support, node.driven);
        node.driven += thrust, node.across *= grains.weight();
        node.beyond = dt * grains.beyond, node.thrust = met.mass * thrust;
        impulse.pressure += vec(node.thrust);
        share = grains.share;
    }
    node.law_depth = friction_depth(body, k, mass, met.depth, share);
    if (has_water(body, k)) {
        const Vec2 dragged = drag_after_friction(step, k, met, ground, node);
        node.driven += flat(dragged);
        impulse.water += met.mass * dragged;
    }
    finish(step, k, ground, node);
}

/// Whether four nodes in a row may go together: particles at each, and grains inside their flow.
[[gnu::always_inline]] inline bool together(const StructuredBody& body, Index k) {
    const auto all_have_particles = [&](Index n) { return !any(~(load(&body.node_mass[n]) > 0.0)); };
    if (!all_have_particles(k)) return false;
    const Index up = body.grid.stride();
    return !body.grains || (four_have(&body.flow.nodes.flags[k], kWideX | kWideY, 0) && all_have_particles(k - 1) &&
                            all_have_particles(k + 1) && all_have_particles(k - up) && all_have_particles(k + up));
}

/// Calls body(first of four nodes in a row) for those of a tile.
template <class Body>
void for_each_row_of_four(const TileGrid& grid, Index tile, Body&& body) {
    const Index first = grid.at(grid.tile_i(tile), grid.tile_j(tile));
    for (Index j = 0; j < kTile; ++j)
        for (Index i = 0; i < kTile; i += 4) body(first + j * grid.stride() + i);
}

template <bool kWater, class Law>
void move_nodes_by(const Law& law, StructuredBody& body, const StepTimes& times) {
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        NodeStep<Law> step{law, body, times, {}, {}, {}};
        for_each_row_of_four(body.grid, tile, [&](Index k) {
            if (!kWater && together(body, k)) return move_dry<Double4>(step, k);
            for (Index node = k; node < k + 4; ++node) {
                if (!(body.node_mass[node] > 0.0))
                    body.moved[node] = {};
                else if constexpr (kWater)
                    move_wet(step, node);
                else
                    move_dry<double>(step, node);
            }
        });
        step.single.add_to(step.tally), step.four.add_to(step.tally);
        body.tallies[static_cast<std::size_t>(n)] = step.tally;
    });
}

/// Makes shares of what grains gave the nodes. Of grains alone it is 1, whatever round-off says.
void share_out(StructuredBody& body) {
    for_each_work_tile(body.active, [&](Index, Index tile) {
        for_each_node_of(body.grid, tile, body.flow.in_reach[tile], [&](Index k, Index, Index) {
            if (!(body.node_mass[k] > 0.0)) return;
            constexpr double kNearly = 1.0 - 1e-12;
            const Double4 share = 1.0 / body.node_mass[k] * load(&body.grain_pressure[k]);
            store(&body.grain_pressure[k], share[3] > kNearly ? share / share[3] : share);
        });
    });
}

/// The weight of a node's particles on the bed over that at rest, before share_out(): grains alone feel a bend.
double weight_on_bend(const StructuredBody& body, Index k, double mass, const Vec2& v) {
    if (!body.curved || !body.grains) return 1.0;
    const SteepBed<double, Curvature::full, false> bed(body.flow, k);
    return 1.0 + body.grain_pressure[k].share / mass * (bed.gravity(body.gravity, v.x(), v.y()) / body.gravity - 1.0);
}

}  // namespace

void move_nodes(StructuredBody& body, const StepTimes& times) {
    if (body.water) release_to_nodes(body);
    if (body.grains) share_out(body);
    const auto move = [&](const auto& law) {
        if (body.water)
            move_nodes_by<true>(law, body, times);
        else
            move_nodes_by<false>(law, body, times);
    };
    // Grains nearly always slide by Coulomb's law.
    if (body.flow.laws)
        move(LawOfEachNode{});
    else if (const auto* coulomb = std::get_if<bed::Coulomb>(&body.bed_law))
        move(*coulomb);
    else
        move(AnyLaw(body.bed_law));
}

void sample_nodes(StructuredBody& body) {
    const double area = body.grid.cell() * body.grid.cell();
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        StructuredTally tally;
        const Index first = body.grid.at(body.grid.tile_i(tile), body.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j)
            for (Index k = first + j * body.grid.stride(); k < first + j * body.grid.stride() + kTile; ++k) {
                const Deposit& node = body.nodes[k];
                body.moved[k] = {};
                const double mass = body.node_mass[k];
                if (!(mass > 0.0)) continue;
                const StructuredBody::NodeGround& ground = body.ground[k];
                const double depth =
                    body.water ? body.bound[k].volume / (ground.open * area) : dry_depth(body, k, mass, ground.open);
                const Vec2 v = Vec2(node.px, node.py) / mass;
                const double support = body.water ? meet_water(body, k).support : 0.0;
                const double weight = weight_on_bend(body, k, mass, v);
                body.moved[k] = {v.x(), v.y(), (1.0 - support) * weight * ground.across, depth};
                tally.kinetic += 0.5 * mass * along_ground(ground, v, v);
                tally.potential += mass * body.gravity * (ground.elevation + 0.5 * depth);
            }
        body.tallies[static_cast<std::size_t>(n)] = tally;
    });
}

}  // namespace frana
