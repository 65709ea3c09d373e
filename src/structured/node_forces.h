#pragma once
// What drives and brakes the particles of a node (Real: double) or of four in a row (Double4).
#include "base/simd.h"
#include "law/bed/node_friction.h"
#include "shallow/grid_update_bed.h"
#include "shallow/surface_gradient.h"
#include "structured/structured_flow.h"

namespace frana {

/// A vector of the plane at a node, or at four.
template <class Real>
struct FlatOf {
    Real x{}, y{};
    [[gnu::always_inline]] friend FlatOf operator+(const FlatOf& a, const FlatOf& b) { return {a.x + b.x, a.y + b.y}; }
    [[gnu::always_inline]] friend FlatOf operator-(const FlatOf& a, const FlatOf& b) { return {a.x - b.x, a.y - b.y}; }
    [[gnu::always_inline]] friend FlatOf operator*(Real s, const FlatOf& a) { return {s * a.x, s * a.y}; }
    [[gnu::always_inline]] FlatOf& operator+=(const FlatOf& a) { return x += a.x, y += a.y, *this; }
    [[gnu::always_inline]] Real dot(const FlatOf& a) const { return x * a.x + y * a.y; }
};

/// The ground there (StructuredBody::Pull).
template <class Real>
struct GroundOf {
    FlatOf<Real> plane_gravity;  ///< gravity along the plane [m/s^2]
    Real across;                 ///< and on the ground
    FlatOf<Real> slope;
    Real elevation, open;

    /// Product of two velocities along the ground [m^2/s^2].
    [[gnu::always_inline]] Real along(const FlatOf<Real>& a, const FlatOf<Real>& b) const {
        return a.dot(b) + slope.dot(a) * slope.dot(b);
    }
};
[[gnu::always_inline]] inline GroundOf<double> ground_at(const StructuredBody::NodeGround* p, double) {
    return {{p->x, p->y}, p->across, {p->slope_x, p->slope_y}, p->elevation, p->open};
}
[[gnu::always_inline]] inline GroundOf<Double4> ground_at(const StructuredBody::NodeGround* p, Double4) {
    Double4 a[4], b[4];
    transpose(load(&p[0].x), load(&p[1].x), load(&p[2].x), load(&p[3].x), a);
    transpose(load(&p[0].slope_y), load(&p[1].slope_y), load(&p[2].slope_y), load(&p[3].slope_y), b);
    return {{a[0], a[1]}, a[2], {a[3], b[0]}, b[1], b[2]};
}

/// Velocity of a node's particles after the stress of their structure acted for dt.
[[gnu::always_inline]] inline FlatOf<double> stressed(const StructuredBody& body, Index k, double mass, double dt) {
    const Deposit& d = body.nodes[k];
    return 1.0 / mass * FlatOf<double>{d.px + dt * d.fx, d.py + dt * d.fy};
}
[[gnu::always_inline]] inline FlatOf<Double4> stressed(const StructuredBody& body, Index k, Double4 mass, double dt) {
    const Deposit* const d = body.nodes + k;
    Double4 of[4];
    transpose(load(d), load(d + 1), load(d + 2), load(d + 3), of);
    return 1.0 / mass * FlatOf<Double4>{of[0] + dt * of[2], of[1] + dt * of[3]};
}

/// The same before it acted, and after it acted on `bound` of the node's mass alone.
template <class Real>
[[gnu::always_inline]] inline FlatOf<Real> brought(const StructuredBody& body, Index k, Real mass) {
    return stressed(body, k, mass, 0.0);
}
[[gnu::always_inline]] inline FlatOf<double> stressed_part(const StructuredBody& body, Index k, double mass,
                                                           double bound, double dt) {
    const Deposit& d = body.nodes[k];
    return brought(body, k, mass) + dt / bound * FlatOf<double>{d.fx, d.fy};
}

/// What is left of grains' pressures at a node once they are shares (share_out). It is K (1 - f), 1 - f, and 2 cells
/// times div(K (1 - f)). Next to dry nodes it goes on as it is here.
template <class Real>
struct GrainsOf {
    Sym2Of<Real> k;
    Real share;
    FlatOf<Real> change;
};
[[gnu::always_inline]] inline GrainsOf<double> grains_at(const StructuredBody& body, Index k, double) {
    const Double4 here = load(&body.grain_pressure[k]);
    const auto at = [&](Index n) { return body.node_mass[n] > 0.0 ? load(&body.grain_pressure[n]) : here; };
    const Index up = body.grid.stride();
    const Double4 x = at(k + 1) - at(k - 1), y = at(k + up) - at(k - up);
    return {{here[0], here[1], here[2]}, here[3], {x[0] + y[2], x[2] + y[1]}};
}
/// Of four nodes with wet ones around.
[[gnu::always_inline]] inline GrainsOf<Double4> grains_at(const StructuredBody& body, Index k, Double4) {
    const Index up = body.grid.stride();
    const StructuredBody::GrainPressure* const p = &body.grain_pressure[k];
    Double4 here[4], x[4], y[4], of[4];
    for (int n = 0; n < 4; ++n)
        here[n] = load(p + n), x[n] = load(p + n + 1) - load(p + n - 1), y[n] = load(p + n + up) - load(p + n - up);
    transpose(here[0], here[1], here[2], here[3], of);
    transpose(x[0], x[1], x[2], x[3], here);
    transpose(y[0], y[1], y[2], y[3], x);
    return {{of[0], of[1], of[2]}, of[3], {here[0] + x[2], here[2] + x[1]}};
}

/// Gradient of the grains' free surface.
[[gnu::always_inline]] inline FlatOf<double> surface_at(const Flow& flow, Index k, double) {
    const std::uint8_t flags = flow.nodes.flags[k];
    return {surface_gradient(flow, k, 1, flags & kWideX, flow.bed.slope_x[k]),
            surface_gradient(flow, k, flow.grid.stride(), flags & kWideY, flow.bed.slope_y[k])};
}
[[gnu::always_inline]] inline FlatOf<Double4> surface_at(const Flow& flow, Index k, Double4) {
    return {wide_gradients(flow, k, 1), wide_gradients(flow, k, flow.grid.stride())};
}

/// Acceleration by the artificial viscosity at bores (shallow/shock.h), as in the depth-averaged flow's grid update
/// [m/s^2].
[[gnu::always_inline]] inline FlatOf<double> viscous_acceleration(const Flow& flow, Index k, double) {
    const double depth = flow.nodes.depth[k];
    if (!(depth > 1e-12 * flow.cell)) return {0.0, 0.0};
    const Pair *flux = &flow.nodes.viscous_flux[k], *below = flux - flow.grid.stride();
    return 1.0 / (flow.cell * depth) * FlatOf<double>{flux[-1].x - flux[0].x, below->y - flux[0].y};
}
[[gnu::always_inline]] inline FlatOf<Double4> viscous_acceleration(const Flow& flow, Index k, Double4) {
    const Pair* const flux = &flow.nodes.viscous_flux[k];
    Double4 right, left, above, below, unused;
    unzip(flux, right, above), unzip(flux - 1, left, unused), unzip(flux - flow.grid.stride(), unused, below);
    const Double4 depth = load(&flow.nodes.depth[k]), none = {};
    return select(depth > 1e-12 * flow.cell, 1.0 / (flow.cell * depth), none) *
           FlatOf<Double4>{left - right, below - above};
}

/// What drives grains on the map [m/s^2].
template <class Real>
struct DriveOf {
    FlatOf<Real> drive;   ///< of the free surface, less the weight that the node was given
    FlatOf<Real> thrust;  ///< of the free surface, less that of a uniform depth
    Real weight;          ///< on the bed, over that at rest [1]
};

/// By the grid update of the depth-averaged flow. With kCurvature the bed's own vertical acceleration along the velocity `v`
/// adds to gravity.
template <Curvature kCurvature, class Real>
[[gnu::always_inline]] inline DriveOf<Real> drive_on_map(const Flow& flow, Index k, const GroundOf<Real>& ground,
                                                         const FlatOf<Real>& surface, const FlatOf<Real>& v) {
    const SteepBed<Real, kCurvature, false> bed(flow, k);
    const Real one = Real{} + 1.0, cosine = 1.0 / sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
    const Drive<Real> slope = bed.drive(surface.x, surface.y, one), even = bed.drive(bed.bx, bed.by, one);
    const Real high = bed.height_around(flow, read<Real>(&flow.nodes.depth[k]), surface.x, surface.y);
    const Drive<Real> all = bed.driving(slope, flow.gravity, high, v.x, v.y, cosine);
    const Real weight = bed.gravity(flow.gravity, v.x, v.y);
    return {{all.x + ground.plane_gravity.x, all.y + ground.plane_gravity.y},
            {weight * (slope.x - even.x), weight * (slope.y - even.y)},
            1.0 / flow.gravity * weight};
}

/// What grains add to a node's motion.
template <class Real>
struct GrainForceOf {
    FlatOf<Real> acceleration;  ///< [m/s^2]
    FlatOf<Real> beyond;        ///< of it, by earth pressure that is not hydrostatic [m/s^2]
    Real own_weight;            ///< of grains on the bed, over that at rest [1]
    Real share;                 ///< of grains [1]
    /// The same of all that is at the node.
    [[gnu::always_inline]] Real weight() const { return 1.0 + share * (own_weight - 1.0); }
};

/// As in the depth-averaged flow. For their share s of the mass, the slope of the free surface replaces the ground's.
/// The rest of their earth pressure, K - 1, goes along with it. So do what either lacks where s or K changes, -g_z h /
/// 2 div(s K), and the artificial viscosity at bores. Besides the share of their weight that the whole node is given.
/// `bears`: share of the weight on the bed. `v`: velocity over a bend of the bed, which only grains feel.
template <class Real>
[[gnu::always_inline]] inline GrainForceOf<Real> grain_force(const StructuredBody& body, Index k,
                                                             const GroundOf<Real>& ground, double bears,
                                                             const FlatOf<Real>& v) {
    const Flow& flow = body.flow;
    const GrainsOf<Real> grains = grains_at(body, k, Real{});
    const FlatOf<Real> surface = surface_at(flow, k, Real{});
    const FlatOf<Real> in_plane = ground.across * surface;
    DriveOf<Real> by{in_plane, in_plane, Real{} + 1.0};
    if (body.mapped)
        by = body.curved ? drive_on_map<Curvature::full>(flow, k, ground, surface, v)
                         : drive_on_map<Curvature::none>(flow, k, ground, surface, v);
    const Real half = 0.25 / flow.cell * read<Real>(&flow.nodes.depth[k]) * ground.across * by.weight, s = grains.share;
    const Real xx = grains.k.xx - s, yy = grains.k.yy - s, xy = grains.k.xy;
    const FlatOf<Real> beyond{xx * by.thrust.x + xy * by.thrust.y + half * grains.change.x,
                              xy * by.thrust.x + yy * by.thrust.y + half * grains.change.y};
    return {(Real{} - bears) * (s * by.drive + beyond) + s * viscous_acceleration(flow, k, Real{}),
            (Real{} - bears) * beyond, by.weight, s};
}

[[gnu::always_inline]] inline double front_at(const Flow& flow, Index k, double) { return at_front(flow, k); }
/// Of four nodes with wet ones around.
[[gnu::always_inline]] inline Double4 front_at(const Flow&, Index, Double4) { return Double4{}; }

/// `driven`, less what grains that climb a step in the bed lose besides (SteepBed::climb).
template <class Real>
[[gnu::always_inline]] inline FlatOf<Real> climbed(const StructuredBody& body, Index k,
                                                   const GrainForceOf<Real>& grains, double bears,
                                                   const FlatOf<Real>& driven, double dt) {
    const Flow& flow = body.flow;
    const SteepBed<Real, Curvature::full, false> bed(flow, k);
    const FlatOf<Real> surface = surface_at(flow, k, Real{});
    FlatOf<Real> left = driven;
    bed.climb(surface.x, surface.y, front_at(flow, k, Real{}), flow.gravity, flow.cell,
              flow.gravity * grains.own_weight, dt, left.x, left.y);
    return driven + bears * grains.share * (left - driven);
}

/// Velocity in the middle of a step, driven and braked by Coulomb friction. It makes what a bend does second order.
template <class Real, class Law>
[[gnu::always_inline]] inline FlatOf<Real> midway(const Law& law, const GroundOf<Real>& ground, Real across,
                                                  const FlatOf<Real>& before, const FlatOf<Real>& acceleration,
                                                  double dt) {
    const FlatOf<Real> v = before + (Real{} + 0.5 * dt) * acceleration;
    const Real steep = sqrt(1.0 + ground.slope.dot(ground.slope)), speed = sqrt(ground.along(v, v));
    const Real lost = 0.5 * dt * law.friction_at_rest() * across * steep;
    return select(speed > 0.0, max(Real{}, 1.0 - lost / max(speed, Real{} + 1e-300)), Real{}) * v;
}

/// A bed law's friction over a step that would change `before` to `driven` (law/bed/node_friction.h). `across`: gravity
/// normal to the ground [m/s^2]. `density`: of what is there, with its confined water [kg/m^3].
template <class Real, class Law>
[[gnu::always_inline]] inline FlatOf<Real> braked(const Law& law, const StructuredBody& body, double density,
                                                  const GroundOf<Real>& ground, Real across, Real depth,
                                                  const FlatOf<Real>& before, const FlatOf<Real>& driven,
                                                  const StepTimes& times) {
    constexpr double kSlowest = 1e-30;  // below any speed, above the root of the smallest number [m/s]
    const Real none = {}, speed = max(sqrt(driven.dot(driven)), none + kSlowest);
    const FlatOf<Real> unit = 1.0 / speed * driven;
    const Real along = ground.slope.dot(unit), steep = sqrt(1.0 + ground.slope.dot(ground.slope)),
               kappa = sqrt(1.0 + along * along), cosine = 1.0 / steep;
    const BedStateOf<Real> state{
        across * steep / kappa, max(depth * cosine, none + 1e-9), kappa, cosine, body.gravity, density};
    const Real start = max(none, before.dot(unit)), left = speeds_after(law, state, start, speed, times.velocity_dt);
    return mean_if_stopping(law, state, BrakedOf<Real>{start, speed, left, times.velocity_dt, times.drift}) * unit;
}

}  // namespace frana
