// The loops over the nodes in a step of structured solids: what forces, bed, obstacles and free water make of their
// velocity.
#include <algorithm>
#include <cmath>
#include <limits>

#include "law/bed_stop.h"
#include "solver/kick_bed.h"
#include "solver/surface_gradient.h"
#include "structured/structured_flow.h"

namespace frana {
namespace {

using Moved = StructuredBody::Moved;

/// What drives the grains of a node, besides the share of their weight that the whole node is given.
class Grains {
public:
    Grains(const StructuredBody& body, Index k) : body_(body), k_(k), stride_(body.grid.stride()) {}

    /// Of a node of mass m, by scheme S2: the slope of the free surface instead of the ground's, for their share s of the
    /// mass; the rest of their earth pressure, K - 1, along with it; what either lacks where s or K changes,
    /// -g_z h / 2 div(s K); and the artificial viscosity at bores. `bears`: share of the weight on the bed.
    Vec2 acceleration(const StructuredBody::Pull& ground, double bears) const {
        const Flow& flow = body_.flow;
        const double cell = flow.cell;
        const Double4 here = share(k_);
        const Double4 kx = share(k_ + 1) - share(k_ - 1), ky = share(k_ + stride_) - share(k_ - stride_);
        const double s = here[3], half = 0.25 * flow.nodes.depth[k_] / cell;
        const auto [drive, push] = slopes(ground);
        const double xx = here[0] - s, yy = here[1] - s, xy = here[2];
        const Vec2 beyond(xx * push.x() + xy * push.y() + ground.across * half * (kx[0] + ky[2]),
                          xy * push.x() + yy * push.y() + ground.across * half * (kx[2] + ky[1]));
        return bears * (-s * drive - beyond) + s * viscosity();
    }

private:
    /// K (1 - f), 1 - f; beside dry nodes it goes on as it is here. Of grains alone it is 1, whatever round-off says.
    Double4 share(Index at) const {
        const double m = body_.node_mass[at];
        const Double4 all_of = m > 0.0 ? load(&body_.push[at]) / m : load(&body_.push[k_]) / body_.node_mass[k_];
        constexpr double kNearly = 1.0 - 1e-12;
        return all_of[3] > kNearly ? all_of / all_of[3] : all_of;
    }
    struct Slopes {
        Vec2 drive;  ///< of the free surface less the weight that the node was given [m/s^2]
        Vec2 push;   ///< of the surface less that of a uniform depth [m/s^2]
    };
    Slopes slopes(const StructuredBody::Pull& ground) const {
        const Flow& flow = body_.flow;
        const std::uint8_t flags = flow.nodes.flags[k_];
        const double ex = surface_gradient(flow, k_, 1, flags & kWideX, flow.bed.slope_x[k_]),
                     ey = surface_gradient(flow, k_, stride_, flags & kWideY, flow.bed.slope_y[k_]);
        if (!body_.mapped) {
            const Vec2 push = ground.across * Vec2(ex, ey);
            return {push, push};
        }
        const SteepBed<double, Curvature::none, false> bed(flow, k_);
        const Drive<double> all = bed.drive(ex, ey, 1.0), even = bed.drive(bed.bx, bed.by, 1.0);
        const double g = flow.gravity;
        return {Vec2(g * all.x + ground.x, g * all.y + ground.y), Vec2(g * (all.x - even.x), g * (all.y - even.y))};
    }
    /// Of bores (solver/shock.h), as in the depth-averaged flow's kick.
    Vec2 viscosity() const {
        const Flow& flow = body_.flow;
        const double depth = flow.nodes.depth[k_];
        if (!(depth > 1e-12 * flow.cell)) return {0, 0};
        const Pair* flux = &flow.nodes.viscous_flux[k_];
        return Vec2(flux[-1].x - flux[0].x, flux[-stride_].y - flux[0].y) / (flow.cell * depth);
    }

    const StructuredBody& body_;
    Index k_, stride_;
};

/// Of a cell: nodes on a face are in the obstacle, whatever round-off makes of their places.
constexpr double kOnFace = 1e-6;

/// A bed law's friction over a step that would change `before` to `driven` (law/bed_law.h, bed_stop.h); `across`: gravity
/// that presses on the ground [m/s^2].
template <class Law>
Vec2 braked(const Law& law, const StructuredBody& body, const StructuredBody::Pull& ground, double across, double depth,
            const Vec2& before, const Vec2& driven, const StepTimes& times) {
    const double speed = driven.norm();
    if (speed == 0.0) return driven;
    const Vec2 unit = driven / speed, slope(ground.slope_x, ground.slope_y);
    const double along = slope.dot(unit), steep = std::sqrt(1.0 + slope.squaredNorm()),
                 kappa = std::sqrt(1.0 + along * along);
    const BedState state{across * steep / kappa, std::max(depth / steep, 1e-9), kappa, 1.0 / steep,
                         body.gravity, body.density};
    const double start = std::max(0.0, before.dot(unit)), left = speed_after(law, state, start, speed, times.kick);
    return mean_if_stopping(law, state, BrakedOf<double>{start, speed, left, times.kick, times.drift}) * unit;
}

/// Product of two velocities along the ground [m^2/s^2].
double along_ground(const StructuredBody::Pull& ground, const Vec2& a, const Vec2& b) {
    const Vec2 slope(ground.slope_x, ground.slope_y);
    return a.dot(b) + slope.dot(a) * slope.dot(b);
}

/// A node's columns as they meet its water.
struct Met {
    double mass;         ///< without what was released [kg]
    double depth;        ///< of grains and confined water [m]
    double support = 0;  ///< share of the weight that water takes off the bed
    Vec2 slope{0, 0};    ///< of the water's surface
    Vec2 lift{0, 0};     ///< acceleration by the pressure of the water [m/s^2]
};

/// Water has cells around the nodes of the grid; columns at its sides reach nodes beyond them.
bool has_water(const StructuredBody& body, Index k) {
    const Index i = k % body.grid.stride() - kTile, j = k / body.grid.stride() - kTile;
    return i >= 0 && j >= 0 && i < body.grid.nx() && j < body.grid.ny() && body.water->h[k] > body.water->film;
}

/// Elevation of the water's surface where there is water, else `otherwise`.
double surface_at(const StructuredBody& body, Index k, double otherwise) {
    const FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const double open = body.pull[k].open;  // 0 where no column has been near
    const double depth = open > 0.0 ? (bound.volume - bound.released) / (open * body.grid.cell() * body.grid.cell()) : 0.0;
    return has_water(body, k) ? water.bed[k] + water.h[k] + depth : otherwise;
}

/// Slope of the surface over the cells on both sides that have water, or over one.
Vec2 surface_slope(const StructuredBody& body, Index k) {
    const double here = surface_at(body, k, 0.0), nan = std::numeric_limits<double>::quiet_NaN();
    const auto along = [&](Index step) {
        const double up = surface_at(body, k + step, nan), down = surface_at(body, k - step, nan);
        const int sides = (up == up ? 1 : 0) + (down == down ? 1 : 0);
        if (sides == 0) return 0.0;
        return ((up == up ? up : here) - (down == down ? down : here)) / (sides * body.grid.cell());
    };
    return {along(1), along(body.grid.stride())};
}

/// A node's columns, without what they released in the last step, and what the water bears of them.
Met meet_water(const StructuredBody& body, Index k) {
    const FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const StructuredBody::Pull& ground = body.pull[k];
    const double area = ground.open * body.grid.cell() * body.grid.cell();
    Met met{body.node_mass[k] - water.by.material.fluid_density * bound.released, (bound.volume - bound.released) / area};
    if (!has_water(body, k)) return met;
    met.support = water.support(met.mass / (area * met.depth), met.depth, water.h[k]);
    met.slope = surface_slope(body, k);
    met.lift = -met.support * (ground.across * met.slope + Vec2(ground.x, ground.y));
    return met;
}

/// Rate at which water speeds up its slip where grains are not spread evenly over the depth (van den Bout et al. 2021, sec.
/// 2.4; its share of mobile water, alpha_u, stands above and below): stable only where drag is stronger [1/s].
double spread_rate(const WaterViscosity& viscosity, const Mixture& mixture, double whole) {
    return viscosity.kinematic * viscosity.profile * mixture.grains() / (whole * whole);
}

/// Drag and virtual mass between a node's columns and its water over a step that brought the columns from `before`
/// to `driven`; returns their velocity. What both lose is the impulse times the mean slip.
Vec2 drag(StructuredBody& body, Index k, const Met& met, const Vec2& before, const Vec2& driven, double dt,
          StructuredTally& tally) {
    FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const double area = body.grid.cell() * body.grid.cell();  // the water's: what one gives the other gets
    const double h = water.h[k], whole = met.depth + h, solids = bound.solids / area;
    const double confined = std::max(0.0, met.depth - solids), fluid = confined + h;
    const Mixture mixture{solids / whole, bound.structured / bound.solids, confined / fluid};
    Phase c{met.mass / area, before, (met.mass / area / dt) * (driven - before)};
    Phase u{water.by.material.fluid_density * h, Vec2(water.qx[k], water.qy[k]) / h};
    // Of what drives the water friction takes a part, and all of it at most.
    const Vec2 falls = -body.pull[k].across * met.slope;
    const double drive = falls.norm(),
                 brake = quadratic_drag(water.friction, {body.gravity, h, 1.0}) * u.velocity.squaredNorm() +
                         linear_drag(water.viscosity, whole) * u.velocity.norm();
    const Vec2 carried = drive > brake ? Vec2(falls * (1.0 - brake / drive)) : Vec2(0, 0);
    const double flux = (mixture.bound() * c.velocity + mixture.free() * u.velocity).norm();
    const Exchange by{whole * water.drag.coefficient(mixture, flux), water.by.material.power,
                      virtual_mass(water.by.virtual_mass, water.by.material, mixture, whole), carried};
    const Vec2 slip = before - u.velocity;
    if (water.viscosity.solid_gradient) {
        const double rate = spread_rate(water.viscosity, mixture, whole), reduced = c.mass * u.mass / (c.mass + u.mass);
        const double holds = by.drag * (by.power == 2 ? slip.norm() : 1.0) / reduced;
        if (rate > holds)
            ++tally.outrun;
        else
            u.force = -u.mass * rate * slip;
    }
    exchange(by, dt, c, u);
    tally.drag += met.mass * along_ground(body.pull[k], driven - c.velocity, 0.5 * (slip + c.velocity - u.velocity));
    water.qx[k] = h * u.velocity.x(), water.qy[k] = h * u.velocity.y();
    return c.velocity;
}

/// A node's columns as they are, in the dry.
Met met_dry(const StructuredBody& body, Index k) {
    const double m = body.node_mass[k], cell = body.grid.cell();
    if (body.grains) return {m, body.flow.nodes.depth[k]};
    return {m, m / body.pull[k].open * (1.0 / (body.density * cell * cell))};
}

template <bool kWater, class Law>
Moved move(const Law& law, StructuredBody& body, Index k, const Vec2& place, const StepTimes& times, StructuredTally& tally) {
    const Deposit& node = body.nodes[k];
    const StructuredBody::Pull& pull = body.pull[k];
    const double dt = times.kick;
    const double mass = body.node_mass[k];
    const Vec2 before = Vec2(node.px, node.py) / mass;
    const Met met = kWater ? meet_water(body, k) : met_dry(body, k);
    if constexpr (kWater) tally.impulse.water -= (mass - met.mass) * before;
    const Vec2 weight = dt * Vec2(pull.x, pull.y);
    Vec2 v = before + weight;
    tally.impulse.weight += met.mass * weight;
    const double across = (1.0 - met.support) * pull.across;
    if (body.grains) {
        const Vec2 push = dt * Grains(body, k).acceleration(pull, 1.0 - met.support);
        v += push;
        tally.impulse.pressure += met.mass * push;
    }
    if constexpr (kWater) {
        v += dt * met.lift;
        tally.impulse.weight += met.mass * dt * met.lift;
        const Vec2 alone = v;
        if (has_water(body, k)) {  // drag knows what friction holds, and friction then what drag does
            const Vec2 held = braked(law, body, pull, across, met.depth, before, v, {dt, 0.0});
            v += drag(body, k, met, before, held, dt, tally) - held;
        }
        tally.impulse.water += met.mass * (v - alone);
    }
    const Vec2 slowed = braked(law, body, pull, across, met.depth, before, v, times);
    tally.impulse.friction += met.mass * (slowed - v);
    Vec2 stopped = slowed;
    for (const Obstacle& obstacle : body.obstacles) stopped = obstacle.met(place, stopped, kOnFace * body.grid.cell());
    tally.impulse.obstacles += met.mass * (stopped - slowed);
    // By the velocity that is left: what rests under stress and friction loses nothing.
    tally.friction += met.mass * along_ground(pull, v - slowed, stopped);
    tally.obstacles += met.mass * along_ground(pull, slowed - stopped, stopped);
    tally.kinetic += 0.5 * met.mass * along_ground(pull, stopped, stopped);
    tally.potential += met.mass * body.gravity * (pull.elevation + 0.5 * met.depth);
    return {stopped.x(), stopped.y(), across, met.depth};
}

/// What the columns of a node released in the last step joins the water at `to`, with the node's velocity.
void release_to(StructuredBody& body, Index k, Index to) {
    FreeWater& water = *body.water;
    const double depth = body.bound[k].released / (body.grid.cell() * body.grid.cell());
    const Deposit& node = body.nodes[k];
    water.h[to] += depth;
    water.qx[to] += depth * (node.px / body.node_mass[k]), water.qy[to] += depth * (node.py / body.node_mass[k]);
}

/// All nodes; those beyond the grid's sides, which have no water, in one order to the nearest that has.
void release_to_nodes(StructuredBody& body) {
    const TileGrid& grid = body.grid;
    const auto each = [&](Index tile, auto&& visit) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        for (Index j = j0; j < j0 + kTile; ++j)
            for (Index i = i0; i < i0 + kTile; ++i)
                if (body.bound[grid.at(i, j)].released > 0.0) visit(i, j);
    };
    const auto inside = [&](Index i, Index j) { return i >= 0 && j >= 0 && i < grid.nx() && j < grid.ny(); };
    for_each_work_tile(body.active, [&](Index, Index tile) {
        each(tile, [&](Index i, Index j) {
            if (inside(i, j)) release_to(body, grid.at(i, j), grid.at(i, j));
        });
    });
    for (const Index tile : body.active.work) {
        const Index i0 = grid.tile_i(tile), j0 = grid.tile_j(tile);
        if (inside(i0, j0) && inside(i0 + kTile - 1, j0 + kTile - 1)) continue;
        each(tile, [&](Index i, Index j) {
            if (inside(i, j)) return;
            const Index a = std::clamp<Index>(i, 0, grid.nx() - 1), b = std::clamp<Index>(j, 0, grid.ny() - 1);
            release_to(body, grid.at(i, j), grid.at(a, b));
        });
    }
}

template <bool kWater, class Law>
void move_nodes_by(const Law& law, StructuredBody& body, const StepTimes& times) {
    const GridGeometry& g = body.grid.geometry();
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        StructuredTally tally;
        const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
        for (Index j = j0; j < j0 + kTile; ++j)
            for (Index i = i0; i < i0 + kTile; ++i) {
                const Index k = body.grid.at(i, j);
                body.moved[k] = body.node_mass[k] > 0.0 ? move<kWater>(law, body, k, {g.x(i), g.y(j)}, times, tally)
                                                         : Moved{};
            }
        body.tallies[static_cast<std::size_t>(n)] = tally;
    });
}

}  // namespace

void move_nodes(StructuredBody& body, const StepTimes& times) {
    if (body.water) release_to_nodes(body);
    std::visit(
        [&](const auto& law) {
            if (body.water)
                move_nodes_by<true>(law, body, times);
            else
                move_nodes_by<false>(law, body, times);
        },
        body.bed_law);
}

void look_nodes(StructuredBody& body) {
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
                const StructuredBody::Pull& pull = body.pull[k];
                const double depth = body.water ? body.bound[k].volume / (pull.open * area) : met_dry(body, k).depth;
                const Vec2 v = Vec2(node.px, node.py) / mass;
                const double support = body.water ? meet_water(body, k).support : 0.0;
                body.moved[k] = {v.x(), v.y(), (1.0 - support) * pull.across, depth};
                tally.kinetic += 0.5 * mass * along_ground(pull, v, v);
                tally.potential += mass * body.gravity * (pull.elevation + 0.5 * depth);
            }
        body.tallies[static_cast<std::size_t>(n)] = tally;
    });
}

}  // namespace frana
