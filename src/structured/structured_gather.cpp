// What particles take from the nodes in a step of structured solids, and what they make of it. Four are done at once.
#include <algorithm>
#include <cmath>

#include "base/touch.h"
#include "mpm/stencils.h"
#include "mpm/tile_points.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

using Moved = StructuredBody::Moved;

/// What a particle takes from its nodes, and how it changes there [1/cell].
struct Taken {
    Double4 mean, slope_x, slope_y;
};

[[gnu::always_inline]] inline Taken take(const Moved* nodes, Index stride, const Reach& r) {
    Taken taken{};
    for (int j = 0; j < 3; ++j) {
        const Moved* const first = nodes + r.node + j * stride;
        const Double4 a = load(first), b = load(first + 1), c = load(first + 2);
        const Double4 row = r.wx[0] * a + r.wx[1] * b + r.wx[2] * c;
        taken.mean += r.wy[j] * row;
        taken.slope_x += r.wy[j] * (r.sx[0] * a + r.sx[1] * b + r.sx[2] * c);
        taken.slope_y += r.sy[j] * row;
    }
    return taken;
}

/// Four particles after a step, number by number.
struct Batch {
    Double4 vx, vy, normal_gravity, layer, cxx, cyx, cxy, cyy;
};

[[gnu::always_inline]] inline Batch take_four(const StructuredBody& body, Index p, int lanes) {
    const Stencils sx(load(&body.points.x[p], lanes)), sy(load(&body.points.y[p], lanes));
    const double per_cell = 1.0 / body.grid.cell();
    Taken taken[4] = {};
    for (int n = 0; n < lanes; ++n)
        taken[n] = take(body.moved.data(), body.grid.stride(), Reach(sx, sy, body.grid.stride(), n));
    Double4 mean[4], x[4], y[4];
    transpose(taken[0].mean, taken[1].mean, taken[2].mean, taken[3].mean, mean);
    transpose(taken[0].slope_x, taken[1].slope_x, taken[2].slope_x, taken[3].slope_x, x);
    transpose(taken[0].slope_y, taken[1].slope_y, taken[2].slope_y, taken[3].slope_y, y);
    return {mean[0], mean[1], mean[2], mean[3], per_cell * x[0], per_cell * x[1], per_cell * y[0], per_cell * y[1]};
}

/// An edge of four domains goes with the material.
[[gnu::always_inline]] inline void stretch(double* rx, double* ry, const Batch& b, double dt, int lanes) {
    const Double4 x = load(rx, lanes), y = load(ry, lanes);
    store(rx, x + dt * (b.cxx * x + b.cxy * y), lanes);
    store(ry, y + dt * (b.cyx * x + b.cyy * y), lanes);
}

/// Stress, damage and the particle's own depth, which changes with its area: exp(-div dt) to second order.
/// Returns the work of the strains on the structure [J].
template <bool kWater, bool kHexagon>
[[gnu::always_inline]] inline Double4 strain_four(StructuredBody& body, const Batch& b, Index p, int lanes, double dt) {
    StructuredPoints& q = body.points;
    const Double4 half = (0.5 * dt) * (b.cxx + b.cyy), damage = load(&q.damage[p], lanes);
    const Double4 depth = load(&q.depth[p], lanes) * ((1.0 - half) / (1.0 + half));
    store(&q.depth[p], depth, lanes);
    const Mask4 intact = damage < 1.0;
    const Double4 none = {};
    if (!any(intact)) return none;
    const auto if_intact = [&](Double4 a) { return select(intact, a, none); };
    StructuredStateOf<Double4> state{{if_intact(load(&q.xx[p], lanes)), if_intact(load(&q.yy[p], lanes)),
                                      if_intact(load(&q.zz[p], lanes)), if_intact(load(&q.xy[p], lanes))},
                                     damage,
                                     load(&q.strain[p], lanes)};
    const auto step =
        StructuredStepOf<Double4>::of(if_intact(b.cxx), if_intact(b.cxy), if_intact(b.cyx), if_intact(b.cyy), dt);
    Double4 density = all(body.density);
    if constexpr (kWater) density = load(&q.mass[p], lanes) / max(load(&q.volume[p], lanes), all(1e-300));
    const Double4 weight = if_intact(-0.5 * density * b.normal_gravity * depth);
    const StructuredStressOf<Double4> old = state.stress;
    body.law.update_as<kHexagon>(step, weight, load(&q.cohesion[p], lanes), state);
    store(&q.xx[p], state.stress.xx, lanes), store(&q.yy[p], state.stress.yy, lanes);
    store(&q.zz[p], state.stress.zz, lanes), store(&q.xy[p], state.stress.xy, lanes);
    store(&q.damage[p], state.damage, lanes), store(&q.strain[p], state.strain, lanes);
    const StructuredStressOf<Double4>& now = state.stress;
    const Double4 work = (old.xx + now.xx) * step.xx + (old.yy + now.yy) * step.yy + 2.0 * (old.xy + now.xy) * step.xy;
    return (0.5 * body.share) * load(&q.volume[p], lanes) * (1.0 - damage) * work;
}

/// A particle gives away what it released in the last step, and notes what breaking releases in this one.
void release(StructuredBody& body, Index p, double damage_before, StructuredSums& sums) {
    StructuredPoints& q = body.points;
    const double gone = q.released[p];
    if (gone > 0.0) {
        const double left = q.volume[p] - gone;
        q.mass[p] -= body.water->by.material.fluid_density * gone;
        q.depth[p] *= left / q.volume[p], q.volume[p] = left;
        sums.released += gone;
    }
    const double intact = 1.0 - damage_before;
    q.released[p] = intact > 0.0 ? q.confined[p] * ((q.damage[p] - damage_before) / intact) : 0.0;
    q.confined[p] -= q.released[p];
}

/// StructuredSums of the lanes, in a fixed order.
struct Sums {
    Double4 mass = {}, kinetic = {}, damaged = {}, px = {}, py = {}, stored = {}, worked = {};
    Double4 max_speed2 = {}, max_wave = {}, max_signal = {};
    StructuredSums rare;
    StructuredSums total() const {
        StructuredSums s = rare;
        s.mass = sum(mass), s.kinetic = sum(kinetic), s.damaged = sum(damaged);
        s.momentum = Vec2(sum(px), sum(py)), s.stored = sum(stored), s.worked = sum(worked);
        s.max_speed2 = largest(max_speed2), s.max_wave = largest(max_wave), s.max_signal = largest(max_signal);
        return s;
    }
};

/// Elastic energy of the structure of four particles in the plane [J].
[[gnu::always_inline]] inline Double4 stored(const StructuredBody& body, Index p, int lanes, Double4 damage) {
    const StructuredPoints& q = body.points;
    const StructuredMaterial& of = body.law.material();
    const Double4 xx = load(&q.xx[p], lanes), yy = load(&q.yy[p], lanes), xy = load(&q.xy[p], lanes);
    const Double4 twice = xx * xx + yy * yy - (2.0 * of.poisson) * xx * yy + (2.0 * (1.0 + of.poisson)) * xy * xy;
    return (0.5 * body.share / of.young) * load(&q.volume[p], lanes) * (1.0 - damage) * twice;
}

/// The ground at the node nearest to a particle, of the grid's own nodes. Beyond its sides it is that of its edge.
const StructuredBody::NodeGround& ground_below(const StructuredBody& body, Index p) {
    const auto nearest = [](double u, Index count) {
        return static_cast<Index>(std::floor(std::clamp(u, 0.0, static_cast<double>(count - 1)) + 0.5));
    };
    const StructuredPoints& q = body.points;
    return body.ground[body.grid.at(nearest(q.x[p], body.grid.nx()), nearest(q.y[p], body.grid.ny()))];
}

/// What a particle carries out: motion along the bed, and its own height above z = 0 [J].
double energy_of(const StructuredBody& body, Index p) {
    const StructuredPoints& q = body.points;
    const StructuredBody::NodeGround& ground = ground_below(body, p);
    const double vz = ground.slope_x * q.vx[p] + ground.slope_y * q.vy[p];
    return q.mass[p] * (0.5 * (q.vx[p] * q.vx[p] + q.vy[p] * q.vy[p] + vz * vz) +
                        body.gravity * (ground.elevation + 0.5 * std::max(q.depth[p], 0.0)));
}

/// Particles leave beyond the outer nodes, and where there is no ground: whether this one does, which is then recorded.
bool leaves(StructuredBody& body, Index p, StructuredSums& sums) {
    const StructuredPoints& q = body.points;
    const bool inside = q.x[p] >= 0.0 && q.y[p] >= 0.0 && q.x[p] <= static_cast<double>(body.grid.nx()) - 1.0 &&
                        q.y[p] <= static_cast<double>(body.grid.ny()) - 1.0;
    if (inside && !(ground_below(body, p).exit > 0.0)) return false;
    const double m = q.mass[p];
    const Vec2 v(q.vx[p], q.vy[p]);
    body.gone[static_cast<std::size_t>(p)] = 1;
    if (inside && ground_below(body, p).exit > 1.0) sums.lost_in_holes += m;
    sums.left_mass += m, sums.left_momentum += m * v;
    sums.left_confined += q.confined[p] + q.released[p];
    sums.left_energy += energy_of(body, p);
    return true;
}

/// A particle that a step brought into obstacles is put on their nearest face.
void put_on_face(StructuredBody& body, Index p, double deepest) {
    StructuredPoints& q = body.points;
    const GridGeometry& g = body.grid.geometry();
    for (std::size_t n = 0; n < body.obstacles.size(); ++n) {
        const Vec2 place(g.x0 + g.cell * q.x[p], g.y0 + g.cell * q.y[p]);
        const FaceBehind at = nearest_face(body.obstacles, n, place, g.cell);
        if (at.face < 0 || !(at.depth > 0.0) || at.depth > deepest) continue;
        const Obstacle& obstacle = body.obstacles[n];
        const int axis = at.face / 2;
        const double face = at.face % 2 == 0 ? obstacle.low[axis] : obstacle.high[axis];
        (axis == 0 ? q.x : q.y)[p] = (face - (axis == 0 ? g.x0 : g.y0)) / g.cell;
    }
}

/// Nodes in an obstacle do not move into it, but a particle next to it feels those before it too, and creeps on. It
/// ends at the nearest face. What was released deep within an obstacle stays there.
void keep_out(StructuredBody& body, Index p, int lanes) {
    constexpr double kDeepest = 1.0;  // no particle goes farther in a step [cells]
    const StructuredPoints& q = body.points;
    const GridGeometry& g = body.grid.geometry();
    const Double4 x = g.x0 + g.cell * load(&q.x[p], lanes), y = g.y0 + g.cell * load(&q.y[p], lanes);
    Mask4 within = {};
    for (const Obstacle& of : body.obstacles)
        within |= (x >= of.low.x()) & (x <= of.high.x()) & (y >= of.low.y()) & (y <= of.high.y());
    if (!any(within)) return;
    for (int n = 0; n < lanes; ++n)
        if (within[n]) put_on_face(body, p + n, kDeepest * g.cell);
}

/// Sums of four particles, and what bounds the next step.
[[gnu::always_inline]] inline void count(StructuredBody& body, Index p, int lanes, const Batch& b, Sums& sums) {
    const StructuredPoints& q = body.points;
    const Double4 x = load(&q.x[p], lanes), y = load(&q.y[p], lanes), damage = load(&q.damage[p], lanes),
                  depth = load(&q.depth[p], lanes), speed2 = b.vx * b.vx + b.vy * b.vy, none = {};
    Double4 m = load(&q.mass[p], lanes), held = stored(body, p, lanes, damage);
    Mask4 here = m > 0.0;
    if (!(std::abs(sum(x + y + speed2 + held + depth)) < 1e300)) {
        for (int n = 0; n < lanes; ++n)
            if (!(std::abs(x[n] + y[n] + speed2[n] + held[n] + depth[n]) < 0.25e300)) sums.rare.bad = p + n;
        return;
    }
    const double x_max = static_cast<double>(body.grid.nx() - 1), y_max = static_cast<double>(body.grid.ny() - 1);
    if (body.has_exits || any((x < 0.0) | (x > x_max) | (y < 0.0) | (y > y_max)))
        for (int n = 0; n < lanes; ++n)
            if (leaves(body, p + n, sums.rare)) m[n] = held[n] = 0.0, here[n] = 0;
    const Double4 speed = sqrt(speed2), high = select(damage < 1.0, max(b.layer, depth), b.layer);
    sums.mass += m, sums.kinetic += (0.5 * m) * speed2, sums.damaged += m * damage;
    sums.px += m * b.vx, sums.py += m * b.vy, sums.stored += held;
    sums.max_speed2 = max(sums.max_speed2, select(here, speed2, none));
    sums.max_wave = max(sums.max_wave, select(here, speed + sqrt(2.0 * b.normal_gravity * high), none));
    sums.max_signal = max(sums.max_signal, select(here, speed + sqrt(b.normal_gravity * high), none));
}

/// Four particles at once.
template <bool kGrains, bool kWater, bool kHexagon>
[[gnu::always_inline]] inline void gather_particles(StructuredBody& body, Index p, int lanes, double dt, Sums& sums) {
    StructuredPoints& q = body.points;
    const double cells = dt / body.grid.cell();
    const Batch b = take_four(body, p, lanes);
    store(&q.vx[p], b.vx, lanes), store(&q.vy[p], b.vy, lanes);
    store(&q.cxx[p], b.cxx, lanes), store(&q.cxy[p], b.cxy, lanes);
    store(&q.cyx[p], b.cyx, lanes), store(&q.cyy[p], b.cyy, lanes);
    store(&q.normal_gravity[p], b.normal_gravity, lanes), store(&q.layer[p], b.layer, lanes);
    store(&q.x[p], load(&q.x[p], lanes) + cells * b.vx, lanes);
    store(&q.y[p], load(&q.y[p], lanes) + cells * b.vy, lanes);
    if constexpr (kGrains) {
        stretch(&q.r1x[p], &q.r1y[p], b, dt, lanes);
        stretch(&q.r2x[p], &q.r2y[p], b, dt, lanes);
    }
    if (!body.obstacles.empty()) keep_out(body, p, lanes);
    const Double4 damage = load(&q.damage[p], lanes);
    sums.worked += strain_four<kWater, kHexagon>(body, b, p, lanes, dt);
    if constexpr (kWater)
        for (int lane = 0; lane < lanes; ++lane) release(body, p + lane, damage[lane], sums.rare);
    count(body, p, lanes, b, sums);
}

/// Reads ahead (base/touch.h) what a batch of particles changes.
template <bool kGrains>
void touch_particles(const StructuredPoints& q, Index first, Index end) {
    const Array* const list[] = {
        &q.x,      &q.y,        &q.vx,  &q.vy,  &q.cxx,  &q.cxy,   &q.cyx,   &q.cyy,    &q.normal_gravity,
        &q.xx,     &q.yy,       &q.zz,  &q.xy,  &q.mass, &q.layer, &q.depth, &q.volume, &q.damage,
        &q.strain, &q.cohesion, &q.r1x, &q.r1y, &q.r2x,  &q.r2y};
    constexpr int kWithGrains = sizeof list / sizeof list[0], kCount = kGrains ? kWithGrains : kWithGrains - 4;
    for (Index p = first; p < end; p += kCacheLine / sizeof(double))
        for (int n = 0; n < kCount; ++n) touch(list[n]->data() + p);
}

template <bool kGrains, bool kWater, bool kHexagon>
StructuredSums gather_tile(StructuredBody& body, Index n, double dt) {
    constexpr Index kBatch = 128;
    const Index end = body.active.begin[n + 1];
    Sums sums;
    for_each_row_of_full(body.grid, body.active, n, [&](Index k, Index count) { touch(body.moved.data() + k, count); });
    for (Index first = body.active.begin[n]; first < end; first += kBatch) {
        const Index last = std::min(first + kBatch, end);
        touch_particles<kGrains>(body.points, first, last);
        for_each_four(first, last, [&](Index p, int lanes) {
            gather_particles<kGrains, kWater, kHexagon>(body, p, lanes, dt, sums);
        });
    }
    return sums.total();
}

}  // namespace

void press(StructuredBody& body) {
    StructuredPoints& q = body.points;
    for_each_tile(body.active, [&](Index n) {
        for (Index p = body.active.begin[n]; p < body.active.begin[n + 1]; ++p) {
            q.normal_gravity[p] = take_four(body, p, 1).normal_gravity[0];
            q.zz[p] = -0.5 * body.density * q.normal_gravity[p] * q.depth[p];
        }
    });
}

void gather(StructuredBody& body, double dt) {
    with_kinds(body, [&](auto grains, auto water) {
        const auto as = [&](auto hexagon) {
            for_each_tile(body.active, [&](Index n) {
                body.sums[static_cast<std::size_t>(n)] =
                    gather_tile<grains.value, water.value, hexagon.value>(body, n, dt);
            });
        };
        if (body.law.is_hexagon())
            as(std::true_type{});
        else
            as(std::false_type{});
    });
}

}  // namespace frana
