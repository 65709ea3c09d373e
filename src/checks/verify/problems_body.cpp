// 3D solids: a bar that vibrates, a disc that turns, a bar that strikes a wall, a block that slides.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/body.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

using constants::kDegree, constants::kGravity;

/// An elastic bar without sideways strain (nu = 0): waves run with sqrt(E / rho).
struct Bar {
    double young = 1e6, density = 1000.0, length = 1.0;  ///< [Pa], [kg/m^3], [m]
    double wave() const { return std::sqrt(young / density); }

    /// The bar from x = 0 on, four cells thick, with the speed v(x) along itself and room at both ends.
    SolidScene scene(const Setup& setup, const std::function<double(double x)>& v, const Frame3& frame = {}) const {
        const double cell = length / static_cast<double>(setup.cells), side = 4.0 * cell;
        SolidScene s;
        s.gravity.setZero();
        s.density = density;
        s.law = solid::Elastic::of(young, 0.0);
        s.grid = grid_around(frame, {-0.5 * length, 0, 0}, {1.5 * length, side, side}, cell);
        for_each_part({0, 0, 0}, {length, side, side}, cell, setup.per_side, [&](const Vec3& x, double volume) {
            s.points.add(frame.at(x), frame.at({v(x.x()), 0, 0}), density * volume);
        });
        return s;
    }
};

/// A free bar in its first mode, v = v_0 cos(pi x / L): the mode's amplitude is back after 2 L / c.
Measurement run_bar(const Setup& setup) {
    const Bar bar;
    const auto mode = [&](double x) { return std::cos(constants::kPi * x / bar.length); };
    const SolidScene s = bar.scene(setup, [&](double x) { return 1e-3 * bar.wave() * mode(x); });
    std::vector<double> shape;
    for (const Vec3& x : s.points.position) shape.push_back(mode(x.x()));
    Mpm3d flow(s);
    const double kinetic = flow.status().kinetic;
    const auto amplitude = [&] {
        double sum = 0.0, all = 0.0;
        for (Index p = 0; p < flow.body().points.count(); ++p) {
            const double a = shape[static_cast<std::size_t>(flow.body().points.id[p])];
            sum += a * flow.velocity(p).x(), all += a * a;
        }
        return sum / all;
    };
    // Zeros of the amplitude: a quarter of a period after the start, then half a period apart.
    const double period = 2.0 * bar.length / bar.wave();
    std::vector<double> zeros;
    double before = amplitude(), before_time = 0.0;
    double most_stored = 0.0, lost = kNone, flowed = kNone;  // after two periods, when both energies stand still
    Measurement m = run_body(flow, 2.2 * period, [&](const Mpm3d& now) {
        most_stored = std::max(most_stored, now.status().stored);
        if (now.status().time >= 2.0 * period && !std::isfinite(lost))
            lost = now.status().numerical() / kinetic, flowed = now.status().material / kinetic;
        const double a = amplitude(), t = now.status().time;
        if (a * before < 0.0) zeros.push_back(before_time + (t - before_time) * before / (before - a));
        before = a, before_time = t;
    });
    if (zeros.size() < 2) zeros = {kNone, kNone};
    const double found = 2.0 * (zeros.back() - zeros.front()) / static_cast<double>(zeros.size() - 1);
    m.add("frequency_error", period / found - 1.0);
    m.add("stored_share", most_stored / kinetic);  // of the kinetic energy, when the bar turns round
    m.add("numerical_loss", lost);
    m.add("material_loss", flowed);
    return m;
}

/// A bar stands on a floor that holds it, when gravity is switched on. It swings about its rest, all modes with whole
/// parts of 4 L / c. So over this time its stress is rho g (L - x) in the mean. Two points of a cell may differ without
/// any node feeling it. Those nearest to the floor preserve such a difference, the worst.
Measurement run_elastic_column(const Setup& setup) {
    const Bar bar;
    const double g = 1e-3 * bar.young / (bar.density * bar.length), weight = bar.density * g * bar.length;  // [Pa]
    SolidScene s = bar.scene(setup, [](double) { return 0.0; });
    s.gravity = {-g, 0, 0};
    s.surfaces.push_back(Surface::plane({0, 0, 0}, {1, 0, 0}, Hold::stuck));
    std::vector<double> height, mean(s.points.position.size(), 0.0);
    for (const Vec3& x : s.points.position) height.push_back(x.x());
    Mpm3d flow(s);
    const double period = 4.0 * bar.length / bar.wave(), side = 4.0 * bar.length / static_cast<double>(setup.cells);
    double before = 0.0;
    Measurement m = run_body(flow, period, [&](const Mpm3d& now) {
        const double dt = now.status().time - before;
        before = now.status().time;
        for (Index p = 0; p < now.body().points.count(); ++p)
            mean[static_cast<std::size_t>(now.body().points.id[p])] += dt / period * now.stress(p).xx;
    });
    double worst = 0.0, sum = 0.0;
    for (std::size_t n = 0; n < mean.size(); ++n) {
        const double error = std::abs(mean[n] / weight + (1.0 - height[n] / bar.length));
        worst = std::max(worst, error), sum += error;
    }
    m.add("stress_error", sum / static_cast<double>(mean.size()));
    m.add("worst_point", worst);
    m.add("force_error", flow.body().impulse[0].x() / period / (weight * side * side) - 1.0);
    return m;
}

/// An elastic disc turning about its axis, one turn: with first moments, no turning motion is lost.
Measurement run_disc(const Setup& setup) {
    constexpr double kRadius = 1.0, kSpin = 2.0;  // [m], [1/s]
    const double cell = kRadius / static_cast<double>(setup.cells), side = 3.0 * cell;
    SolidScene s;
    s.gravity.setZero();
    s.law = solid::Elastic::of(1e5, 0.3);
    s.affine = Affine::apic;
    s.grid = grid_around({}, {-1.3, -1.3, 0}, {1.3, 1.3, side}, cell);
    for_each_part({-1, -1, 0}, {1, 1, side}, cell, setup.per_side, [&](const Vec3& x, double volume) {
        if (std::hypot(x.x(), x.y()) < kRadius) s.points.add(x, {-kSpin * x.y(), kSpin * x.x(), 0}, s.density * volume);
    });
    Mpm3d flow(s);
    flow.advance(1e-9);  // points learn the motion around them
    const Vec3 start = flow.angular_momentum();
    const double kinetic = flow.status().kinetic, learnt = flow.status().numerical();
    Measurement m = run_body(flow, 2.0 * constants::kPi / kSpin);
    m.add("angular_momentum_error", (flow.angular_momentum() - start).norm() / start.norm());
    m.add("kinetic_kept", flow.status().kinetic / kinetic);
    m.add("stored_share", flow.status().stored / kinetic);
    m.add("numerical_loss", (flow.status().numerical() - learnt) / kinetic);
    return m;
}

/// A bar and its wall lie in the grid so many degrees turned. stress_error: of the force on the wall, less rho c v,
/// until the wave is back. rebound: the speed afterwards over that before.
struct BarImpact {
    double stress_error, rebound;
    Measurement run;
};

BarImpact strike(const Setup& setup, double turn) {
    const Bar bar;
    const Frame3 frame = turned_about_y(turn);
    const Vec3 along = frame.at({1, 0, 0});
    const double side = 4.0 * bar.length / static_cast<double>(setup.cells), v0 = 1e-3 * bar.wave();
    SolidScene s = bar.scene(
        setup, [&](double) { return -v0; }, frame);
    s.surfaces.push_back(Surface::plane({0, 0, 0}, along));
    Mpm3d flow(s);
    const double back = 2.0 * bar.length / bar.wave();
    std::vector<std::pair<double, double>> wall_impulse;
    const Measurement m = run_body(flow, 1.5 * back, [&](const Mpm3d& now) {
        wall_impulse.emplace_back(now.status().time, now.body().impulse[0].dot(along));
    });
    const auto at = [&](double t) {
        const auto it = std::lower_bound(wall_impulse.begin(), wall_impulse.end(), std::make_pair(t, -1e300));
        return *it;
    };
    const auto a = at(0.2 * back), b = at(0.8 * back);
    const double force = (b.second - a.second) / (b.first - a.first) / (side * side);
    return {force / (bar.density * bar.wave() * v0) - 1.0,
            flow.status().momentum.dot(along) / (flow.status().mass * v0), m};
}

/// A bar strikes a wall with a thousandth of the wave speed, along the grid and askew.
Measurement run_bar_impact(const Setup& setup) {
    const BarImpact straight = strike(setup, 0.0), askew = strike(setup, 20.0);
    Measurement m = joined(straight.run, askew.run);
    m.add("stress_error", straight.stress_error);
    m.add("rebound", straight.rebound);
    m.add("stress_error_askew", askew.stress_error);
    m.add("rebound_askew", askew.rebound);
    return m;
}

/// A block of elastic material that slides down a plane which is turned in the grid. It rocks on its elastic base, and
/// more normal force brakes it more. v_along + mu v_across = v_0 + g (sin - mu cos) t at any time.
struct Slide3 {
    double speed_error;     ///< of v_along + mu v_across, over what is gained
    double weight_error;    ///< of the plane's normal force, over the weight
    double sunk;            ///< of the centre, across the plane [cells]
    double friction_error;  ///< of friction's work, over the normal force times the way
    double numerical_loss;  ///< over the energy turned over
    Measurement run;
};

Slide3 slide(const Setup& setup, double mu) {
    constexpr double kSlope = 30.0, kEnd = 0.5, kStart = 1.0;
    const double cell = 1.0 / static_cast<double>(setup.cells), side = 4.0 * cell;
    const Frame3 frame = turned_about_y(kSlope);
    const Vec3 along = frame.at({1, 0, 0}), across = frame.at({0, 0, 1});
    SolidScene s;
    s.gravity = {0, 0, -kGravity};
    s.law = solid::Elastic::of(1e6, 0.3);
    s.grid = grid_around(frame, {0, 0, 0}, {3.5, side, 0.6}, cell);
    s.surfaces = {Surface::plane({0, 0, 0}, across, Hold::free, mu)};
    for_each_part({0.3, 0, 0}, {1.3, side, 0.5}, cell, setup.per_side,
                  [&](const Vec3& x, double volume) { s.points.add(frame.at(x), kStart * along, s.density * volume); });
    Mpm3d flow(s);
    const Vec3 start = flow.status().centre;
    const double height = flow.status().potential;
    Slide3 result;
    // Friction takes mu times the normal force on the way in a step. It is the way of the centre, since the sole's is
    // nearly that.
    double work = 0.0, impulse_before = 0.0, before = kStart;
    result.run = run_body(flow, kEnd, [&](const Mpm3d& moved) {
        const double wall_impulse = moved.body().impulse[0].dot(across);
        const double speed = moved.status().momentum.dot(along) / moved.status().mass;
        work += mu * (wall_impulse - impulse_before) * 0.5 * (speed + before);
        impulse_before = wall_impulse, before = speed;
    });
    const SolidStatus& now = flow.status();
    const Vec3 v = now.momentum / now.mass;
    const double gained = kGravity * (std::sin(kSlope * kDegree) - mu * std::cos(kSlope * kDegree)) * kEnd;
    result.speed_error = (v.dot(along) + mu * v.dot(across) - kStart) / gained - 1.0;
    const double weight = now.mass * kGravity * std::cos(kSlope * kDegree) * kEnd;
    result.weight_error = flow.body().impulse[0].dot(across) / weight - 1.0;
    const double turned = height - now.potential;
    result.friction_error = (now.friction - work) / turned;
    result.numerical_loss = now.numerical() / turned;
    result.sunk = (now.centre - start).dot(across) / cell;
    return result;
}

Measurement run_sliding_block(const Setup& setup) {
    const Slide3 smooth = slide(setup, 0.0), rough = slide(setup, 0.3);
    Measurement m = joined(smooth.run, rough.run);
    const auto worse = [](double a, double b) { return std::abs(a) > std::abs(b) ? a : b; };
    m.add("speed_error", worse(smooth.speed_error, rough.speed_error));
    m.add("weight_error", worse(smooth.weight_error, rough.weight_error));
    m.add("friction_error", worse(smooth.friction_error, rough.friction_error));
    m.add("numerical_loss", worse(smooth.numerical_loss, rough.numerical_loss));
    m.add("sunk", worse(smooth.sunk, rough.sunk), "cells");
    return m;
}

}  // namespace

std::vector<Problem> body_problems() {
    const Gate closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem bar{"vibrating_bar", "a free elastic bar in its first mode: period 2 L / c", {16, 32, 64}, {}, run_bar};
    bar.order_of = "frequency_error";
    bar.gates = {{64, "frequency_error", 0.01, "what is asked of a 3D model here"},
                 {64, "numerical_loss", 0.005, "a bar that vibrates loses nothing; second order from 3 % at 16"},
                 {0, "material_loss", 1e-6, "nothing flows: third order in the step"},
                 closed};
    Problem column{"elastic_column",
                   "an elastic column under its own weight: mean stress over a period, rho g (L - z)",
                   {16, 32},
                   {},
                   run_elastic_column};
    column.order_of = "stress_error";
    column.gates = {
        {32, "stress_error", 0.01, "what is asked of a 3D model here"}, {32, "force_error", 0.01, "that"}, closed};
    Problem disc{"rotating_disc", "an elastic disc turns once: angular momentum stays", {8}, {}, run_disc};
    disc.order_of = "angular_momentum_error";
    disc.gates = {{0, "angular_momentum_error", 1e-10, "what is asked of a 3D model here"},
                  {0, "numerical_loss", 0.01, "what the disc does not hold by its spin and its stretch"},
                  closed};
    Problem impact{"bar_impact",
                   "an elastic bar strikes a wall, along the grid and turned by 20 degrees: stress rho c v",
                   {16, 32, 64},
                   {},
                   run_bar_impact};
    impact.order_of = "stress_error";
    impact.gates = {{0, "stress_error", 0.01, "as the bar's frequency"},
                    {0, "stress_error_askew", 0.01, "as the bar's frequency"},
                    closed};
    Problem block{
        "sliding_block", "an elastic block on a turned incline: a = g (sin - mu cos)", {8, 16}, {}, run_sliding_block};
    block.order_of = "speed_error";
    block.gates = {{0, "speed_error", 1e-3, "friction is solved exactly but where it holds"},
                   {0, "weight_error", 0.025, "rocking on its elastic base, 2 H / (pi c t) and its harmonics"},
                   {0, "friction_error", 0.03, "the sole rocks: its speed is not the centre's"},
                   {0, "numerical_loss", 0.02, "of the height that it lost"},
                   {0, "sunk", 0.25, "compression by its weight, and the points' own size"},
                   closed};
    for (Problem* problem : {&bar, &column, &disc, &impact, &block}) problem->in_3d = true;
    return {bar, column, disc, impact, block};
}

}  // namespace frana::verify
