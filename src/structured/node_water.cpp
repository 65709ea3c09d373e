#include "structured/node_water.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "structured/node_forces.h"

namespace frana {

/// Water has cells around the nodes of the grid; particles at its sides reach nodes beyond them.
bool has_water(const StructuredBody& body, Index k) {
    const Index i = k % body.grid.stride() - kTile, j = k / body.grid.stride() - kTile;
    return i >= 0 && j >= 0 && i < body.grid.nx() && j < body.grid.ny() && body.water->h[k] > body.water->film;
}

namespace {

/// Elevation of the water's surface where there is water, else `otherwise`.
double water_surface_at(const StructuredBody& body, Index k, double otherwise) {
    const FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const double open = body.ground[k].open;  // 0 where no particle has been near
    const double depth =
        open > 0.0 ? (bound.volume - bound.released) / (open * body.grid.cell() * body.grid.cell()) : 0.0;
    return has_water(body, k) ? water.bed[k] + water.h[k] + depth : otherwise;
}

/// Slope of the surface over the cells on both sides that have water, or over one.
Vec2 surface_slope(const StructuredBody& body, Index k) {
    const double here = water_surface_at(body, k, 0.0), nan = std::numeric_limits<double>::quiet_NaN();
    const auto along = [&](Index step) {
        const double up = water_surface_at(body, k + step, nan), down = water_surface_at(body, k - step, nan);
        const int sides = (up == up ? 1 : 0) + (down == down ? 1 : 0);
        if (sides == 0) return 0.0;
        return ((up == up ? up : here) - (down == down ? down : here)) / (sides * body.grid.cell());
    };
    return {along(1), along(body.grid.stride())};
}

/// What drives the water of a node down the slope of its surface [m/s^2]. Next to a face it goes along it alone.
Vec2 fall_of_water(const StructuredBody& body, Index k, const Met& met) {
    const auto behind_face = [&](Index n) { return body.ground[n].open > 0.0 && body.ground[n].open <= kLeastOpen; };
    Vec2 fall = -body.ground[k].across * met.slope;
    for (const int axis : {0, 1}) {
        const Index step = axis == 0 ? 1 : body.grid.stride();
        if (behind_face(k - step) || behind_face(k + step)) fall[axis] = 0.0;
    }
    return fall;
}

/// Rate at which water speeds up its slip where grains are not spread evenly over the depth [1/s]. It is stable only
/// where drag is stronger. (van den Bout et al. 2021, sec. 2.4; its share of mobile water, alpha_u, stands above and
/// below.)
double spread_rate(const WaterViscosity& viscosity, const Mixture& mixture, double total) {
    return viscosity.kinematic * viscosity.profile * mixture.grains() / (total * total);
}

/// What the particles of a node released in the last step joins the water at `to`. It has the velocity that points
/// brought the node. The structure's stress acts on what stays bound. At the edge of particles it would speed up thin
/// nodes without limit.
void release_to(StructuredBody& body, Index k, Index to) {
    FreeWater& water = *body.water;
    const double depth = body.bound[k].released / (body.grid.cell() * body.grid.cell());
    const FlatOf<double> velocity = brought(body, k, body.node_mass[k]);
    water.h[to] += depth;
    water.qx[to] += depth * velocity.x, water.qy[to] += depth * velocity.y;
}

}  // namespace

Met meet_water(const StructuredBody& body, Index k) {
    const FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const StructuredBody::NodeGround& ground = body.ground[k];
    const double area = ground.open * body.grid.cell() * body.grid.cell();
    Met met{body.node_mass[k] - water.by.material.fluid_density * bound.released,
            (bound.volume - bound.released) / area};
    if (!has_water(body, k)) return met;
    met.support = water.support(met.mass / (area * met.depth), met.depth, water.h[k]);
    met.slope = surface_slope(body, k);
    met.lift = -met.support * (ground.across * met.slope + Vec2(ground.x, ground.y));
    return met;
}

DragStep drag_step(const StructuredBody& body, Index k, const Met& met, const Vec2& before, const Vec2& driven,
                   const StepTimes& times) {
    const FreeWater& water = *body.water;
    const StructuredBody::Bound& bound = body.bound[k];
    const double dt = times.velocity_dt;
    // Particles fill the open share of the water's cell. There they are as deep as elsewhere, and there alone both hold
    // on to one another. Momentum is that of the whole cell, so that what one gives the other gets.
    const double area = body.grid.cell() * body.grid.cell(), open = body.ground[k].open;
    const double h = water.h[k], total = met.depth + h, solids = bound.solids / (open * area);
    const double confined = std::max(0.0, met.depth - solids), fluid = confined + h;
    const Mixture mixture{solids / total, bound.structured / bound.solids, confined / fluid};
    const Vec2 v(water.qx[k] / h, water.qy[k] / h);
    // Of what drives the water friction takes a part, and all of it at most.
    const Vec2 falls = fall_of_water(body, k, met);
    const double drive = falls.norm(),
                 brake = quadratic_drag(water.friction_at(k), {body.gravity, h, 1.0}) * v.squaredNorm() +
                         linear_drag(water.viscosity, total) * v.norm();
    DragStep step;
    if (drive > brake) step.driving = falls * (1.0 - brake / drive);
    // The water had all of it before the particles' steps. Were it left so, they would slip the less the longer its step.
    const double mass = water.by.material.fluid_density * h;
    step.driven = driven;
    step.c = {met.mass / area, before, (met.mass / area / dt) * (driven - before)};
    step.u = {mass, v - times.ahead * step.driving, mass * step.driving};
    const double flux = (mixture.bound() * before + mixture.free() * step.u.velocity).norm();
    step.by = {open * total * water.drag.coefficient(mixture, flux), water.by.material.power,
               open * virtual_mass(water.by.virtual_mass, water.by.material, mixture, total)};
    if (!water.viscosity.solid_gradient) return step;
    const Vec2 slip = before - step.u.velocity;
    const double rate = spread_rate(water.viscosity, mixture, total),
                 reduced = step.c.mass * mass / (step.c.mass + mass);
    const double holds = step.by.drag * (step.by.power == 2 ? slip.norm() : 1.0) / reduced;
    // It is a part of the viscous stress at the bed, which slows the water and does not drive it. What that stops
    // within a step slips no more.
    const double brakes = linear_drag(water.viscosity, total), length = slip.norm();
    step.outrun = rate > holds;
    if (!step.outrun && length > 0.0 && brakes * dt <= 1.0)
        step.u.force -= open * mass * std::min(rate, brakes * step.u.velocity.norm() / length) * slip;
    return step;
}

Vec2 DragStep::dragged(double dt) const {
    Phase solids = c, fluid = u;
    exchange(by, dt, solids, fluid);
    return solids.velocity;
}

Vec2 drag(StructuredBody& body, Index k, const Met& met, const DragStep& step, const StepTimes& times,
          StructuredTally& tally) {
    constexpr double kHeld = 1e20;  // the mass of the ground, over that of particles
    FreeWater& water = *body.water;
    const double dt = times.velocity_dt, h = water.h[k];
    Phase c = step.c, u = step.u;
    if (step.held) c.mass *= kHeld, c.force *= kHeld;
    exchange(step.by, dt, c, u);
    Vec2 solids = c.velocity;
    if (step.held)  // what they got, though the ground has it already
        solids = step.driven + 1.0 / step.c.mass * (u.mass * (step.u.velocity - u.velocity) + dt * step.u.force);
    tally.outrun += step.outrun ? 1 : 0;
    const Vec2 slip = step.c.velocity - step.u.velocity;
    tally.drag += met.mass * along_ground(body.ground[k], step.driven - solids, 0.5 * (slip + c.velocity - u.velocity));
    u.velocity += (times.ahead - dt) * step.driving;
    water.qx[k] = h * u.velocity.x(), water.qy[k] = h * u.velocity.y();
    return solids;
}

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

}  // namespace frana
