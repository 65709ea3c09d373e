// The loops over the nodes in a step of structured solids: what forces, bed, obstacles and free water make of their
// velocity.
#include <algorithm>
#include <cmath>
#include <limits>

#include "structured/structured_flow.h"

namespace frana {
namespace {

using Node = StructuredBody::Node;
using Moved = StructuredBody::Moved;

/// A node with its neighbours, for centred differences.
struct Around {
    const StructuredBody& body;
    Index k, stride;

    /// As mass per share of the node that is open; what was released is not part of it.
    double depth(Index at) const {
        const double mass = body.water ? body.density * (body.bound[at].volume - body.bound[at].released) : body.nodes[at].m;
        return mass / body.pull[at].open;
    }
    Double4 share(Index at) const {  // K (1 - f); beside dry nodes it goes on as it is here
        const double m = body.nodes[at].m;
        return m > 0.0 ? load(&body.push[at]) / m : load(&body.push[k]) / body.nodes[k].m;
    }
    /// Acceleration -g_z (K . grad h + h / 2 div K) of grains.
    Vec2 acceleration(double pull, double cell, double depth_of_mass) const {
        const double slope = 0.5 * depth_of_mass / cell;
        const double hx = slope * (depth(k + 1) - depth(k - 1)),
                     hy = slope * (depth(k + stride) - depth(k - stride));
        const Double4 kk = load(&body.push[k]) / body.nodes[k].m;
        const Double4 kx = share(k + 1) - share(k - 1), ky = share(k + stride) - share(k - stride);
        const double half = 0.25 * depth_of_mass * depth(k) / cell;
        return -pull * Vec2(kk[0] * hx + kk[2] * hy + half * (kx[0] + ky[2]),
                            kk[2] * hx + kk[1] * hy + half * (kx[2] + ky[1]));
    }
};

/// Of a cell: nodes on a face are in the obstacle, whatever round-off makes of their places.
constexpr double kOnFace = 1e-6;

/// A bed law's friction over a step that would change `before` to `driven` (law/bed_law.h); `across`: gravity that
/// presses on the ground [m/s^2].
template <class Law>
Vec2 braked(const Law& law, const StructuredBody& body, const StructuredBody::Pull& ground, double across, double depth,
            const Vec2& before, const Vec2& driven, double dt) {
    const double speed = driven.norm();
    if (speed == 0.0) return driven;
    const Vec2 unit = driven / speed, slope(ground.slope_x, ground.slope_y);
    const double along = slope.dot(unit), steep = std::sqrt(1.0 + slope.squaredNorm()),
                 kappa = std::sqrt(1.0 + along * along);
    const BedState state{across * steep / kappa, std::max(depth / steep, 1e-9), kappa, 1.0 / steep,
                         body.gravity, body.density};
    return speed_after(law, state, std::max(0.0, before.dot(unit)), speed, dt) * unit;
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
    Met met{body.nodes[k].m - water.by.material.fluid_density * bound.released, (bound.volume - bound.released) / area};
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

template <bool kWater, class Law>
Moved move(const Law& law, StructuredBody& body, Index k, const Vec2& place, double dt, StructuredTally& tally) {
    const Node& node = body.nodes[k];
    const StructuredBody::Pull& pull = body.pull[k];
    const double cell = body.grid.cell(), depth_of_mass = 1.0 / (body.density * cell * cell);
    const Vec2 before = Vec2(node.x, node.y) / node.m;
    Met met{node.m, node.m / pull.open * depth_of_mass};
    if constexpr (kWater) {
        met = meet_water(body, k);
        tally.impulse.water -= (node.m - met.mass) * before;
    }
    const Vec2 weight = dt * Vec2(pull.x, pull.y);
    Vec2 v = before + weight;
    tally.impulse.weight += met.mass * weight;
    const double across = (1.0 - met.support) * pull.across;
    if (body.grains) {
        const Vec2 push = dt * Around{body, k, body.grid.stride()}.acceleration(across, cell, depth_of_mass);
        v += push;
        tally.impulse.pressure += met.mass * push;
    }
    if constexpr (kWater) {
        v += dt * met.lift;
        tally.impulse.weight += met.mass * dt * met.lift;
        const Vec2 alone = v;
        if (has_water(body, k)) {  // drag knows what friction holds, and friction then what drag does
            const Vec2 held = braked(law, body, pull, across, met.depth, before, v, dt);
            v += drag(body, k, met, before, held, dt, tally) - held;
        }
        tally.impulse.water += met.mass * (v - alone);
    }
    const Vec2 slowed = braked(law, body, pull, across, met.depth, before, v, dt);
    tally.impulse.friction += met.mass * (slowed - v);
    Vec2 stopped = slowed;
    for (const Obstacle& obstacle : body.obstacles) stopped = obstacle.met(place, stopped, kOnFace * cell);
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
    const Node& node = body.nodes[k];
    water.h[to] += depth;
    water.qx[to] += depth * (node.x / node.m), water.qy[to] += depth * (node.y / node.m);
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
void move_nodes_by(const Law& law, StructuredBody& body, double dt) {
    const GridGeometry& g = body.grid.geometry();
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        StructuredTally tally;
        const Index i0 = body.grid.tile_i(tile), j0 = body.grid.tile_j(tile);
        for (Index j = j0; j < j0 + kTile; ++j)
            for (Index i = i0; i < i0 + kTile; ++i) {
                const Index k = body.grid.at(i, j);
                body.moved[k] =
                    body.nodes[k].m > 0.0 ? move<kWater>(law, body, k, {g.x(i), g.y(j)}, dt, tally) : Moved{};
            }
        body.tallies[static_cast<std::size_t>(n)] = tally;
    });
}

}  // namespace

void move_nodes(StructuredBody& body, double dt) {
    if (body.water) release_to_nodes(body);
    std::visit(
        [&](const auto& law) {
            if (body.water)
                move_nodes_by<true>(law, body, dt);
            else
                move_nodes_by<false>(law, body, dt);
        },
        body.bed_law);
}

void look_nodes(StructuredBody& body) {
    const double cell = body.grid.cell(), depth_of_mass = 1.0 / (body.density * cell * cell);
    for_each_work_tile(body.active, [&](Index n, Index tile) {
        StructuredTally tally;
        const Index first = body.grid.at(body.grid.tile_i(tile), body.grid.tile_j(tile));
        for (Index j = 0; j < kTile; ++j)
            for (Index k = first + j * body.grid.stride(); k < first + j * body.grid.stride() + kTile; ++k) {
                const Node& node = body.nodes[k];
                body.moved[k] = {};
                if (!(node.m > 0.0)) continue;
                const StructuredBody::Pull& pull = body.pull[k];
                const double depth = body.water ? body.bound[k].volume / (pull.open * cell * cell)
                                                : node.m / pull.open * depth_of_mass;
                const Vec2 v = Vec2(node.x, node.y) / node.m;
                const double support = body.water ? meet_water(body, k).support : 0.0;
                body.moved[k] = {v.x(), v.y(), (1.0 - support) * pull.across, depth};
                tally.kinetic += 0.5 * node.m * along_ground(pull, v, v);
                tally.potential += node.m * body.gravity * (pull.elevation + 0.5 * depth);
            }
        body.tallies[static_cast<std::size_t>(n)] = tally;
    });
}

}  // namespace frana
