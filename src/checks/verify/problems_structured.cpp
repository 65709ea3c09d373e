// Structured solids against closed forms. These are a block that spins, a bar that strikes a wall, and blocks that
// slide, stop and stand. Also grains behind a dam.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_dam_break.h"
#include "checks/verify/library.h"
#include "checks/verify/structured.h"

namespace frana::verify {
namespace {

using constants::kDegree, constants::kGravity;
constexpr double kUnbreakable = 1e12;  // cohesion [Pa]

/// No gravity: motion in the plane alone.
GroundGravity weightless(double, double) { return {0.0, 0.0, 0.0}; }

double larger(double a, double b) { return std::abs(a) > std::abs(b) ? a : b; }

/// An elastic block 1 m wide turns once about its centre.
Measurement run_spin(const Setup& setup) {
    constexpr double kSpin = 1.0;  // [1/s]
    StructuredScene s;
    s.ground = weightless;
    s.material.young = 1e6;
    s.grid = grid_over({-0.8, -0.8}, {0.8, 0.8}, 1.0 / static_cast<double>(setup.cells));
    add_block(s, {{-0.5, -0.5}, {0.5, 0.5}, 1.0, kUnbreakable, {0, 0}, 0.0, setup.per_side});
    for (std::size_t p = 0; p < s.points.x.size(); ++p)
        s.points.vx[p] = -kSpin * s.points.y[p], s.points.vy[p] = kSpin * s.points.x[p];
    const StructuredSeeds seeds = s.points;
    StructuredFlow flow(s);
    const StructuredPoints& q = flow.body().points;
    const auto spin = [&] {
        double sum = 0.0;
        for (Index p = 0; p < q.count(); ++p) {
            const Vec2 at = flow.position(p);
            sum += q.mass[p] * (at.x() * q.vy[p] - at.y() * q.vx[p]);
        }
        return sum;
    };
    const double given = spin();
    flow.advance(1e-9);  // particles learn the motion around them, and lose a little in doing so
    const double start = spin(), kinetic = flow.status().kinetic;
    Measurement m = run_structured(flow, 2.0 * constants::kPi / kSpin * given / start);
    double turned = 0.0, stretched = 0.0;
    for (Index p = 0; p < q.count(); ++p) {
        const Vec2 at = flow.position(p);
        const std::size_t seed = static_cast<std::size_t>(q.id[p]);
        turned += seeds.x[seed] * at.y() - seeds.y[seed] * at.x();
        stretched += seeds.x[seed] * at.x() + seeds.y[seed] * at.y();
    }
    m.add("spin_error", spin() / start - 1.0);
    m.add("kinetic_lost", 1.0 - flow.status().kinetic / kinetic);
    m.add("angle_error", std::atan2(turned, stretched), "rad");
    return m;
}

/// Between smooth walls a bar 1 m long strikes a wall at x = 0, at c / 1000, c its wave speed. The force rho c v
/// acts on it over 2 L / c, and it leaves as fast as it came.
Measurement run_structured_bar(const Setup& setup) {
    const double cell = 1.0 / static_cast<double>(setup.cells), side = 4.0 * cell;
    StructuredScene s;
    s.ground = weightless;
    s.density = 1000.0;
    s.material.young = 1e6;
    const double c = StructuredLaw(s.material).sound_speed(s.density), v = 1e-3 * c, back = 2.0 / c;
    s.grid = grid_over({0, 0}, {1.2, side}, cell);
    Obstacle wall;
    wall.high.x() = 0.0;
    add_channel(s, 0.0, side);
    s.obstacles.push_back(wall);
    add_block(s, {{0, 0}, {1, side}, 1.0, kUnbreakable, {-v, 0}, 0.0, setup.per_side});
    StructuredFlow flow(s);
    double first = 0.0, first_time = 0.0, last = 0.0, last_time = 0.0, contact = 0.0, before = 0.0;
    Measurement m = run_structured(flow, 1.5 * back, [&](const StructuredFlow& now) {
        const double impulse = now.status().impulse.obstacles.x(), t = now.status().time;
        if (t < 0.15 * back) first = impulse, first_time = t;
        if (t < 0.85 * back) last = impulse, last_time = t;
        if (impulse != before) contact = t;
        before = impulse;
    });
    const double stress = (last - first) / (last_time - first_time) / side;
    m.add("plateau_error", stress / (s.density * c * v) - 1.0);
    m.add("contact_error", contact / back - 1.0);
    m.add("rebound_error", flow.status().momentum.x() / (flow.status().mass * v) - 1.0);
    return m;
}

/// A block on a plane that falls along a direction of the map.
struct StructuredSlide {
    double slope_deg, bed_deg, turn_deg, speed, end;

    /// Means of the block: way and speed along the fall on the map. Also the largest way of a particle across it.
    struct End {
        double along, speed, across;
        Measurement run;
    };
    End run(const Setup& setup) const {
        const double cell = 1.0 / static_cast<double>(setup.cells), t = std::tan(slope_deg * kDegree);
        const Vec2 fall(std::cos(turn_deg * kDegree), std::sin(turn_deg * kDegree)), side(-fall.y(), fall.x());
        StructuredScene s;
        s.ground = terrain_ground([=](double, double) { return Vec2(-t * fall); });
        s.bed_law = bed::Coulomb{std::tan(bed_deg * kDegree)};
        s.grid = grid_over({-0.2, -0.2}, {2.0, 2.0}, cell);
        add_block(s, {{0, 0}, {1, 1}, 0.2, kUnbreakable, speed * fall, 0.0, setup.per_side});
        const StructuredSeeds seeds = s.points;
        StructuredFlow flow(s);
        End result{0.0, 0.0, 0.0, run_structured(flow, end)};
        const StructuredPoints& q = flow.body().points;
        for (Index p = 0; p < q.count(); ++p) {
            const std::size_t seed = static_cast<std::size_t>(q.id[p]);
            const Vec2 way = flow.position(p) - Vec2(seeds.x[seed], seeds.y[seed]);
            result.along += way.dot(fall), result.speed += Vec2(q.vx[p], q.vy[p]).dot(fall);
            result.across = std::max(result.across, std::abs(way.dot(side)));
        }
        result.along /= static_cast<double>(q.count()), result.speed /= static_cast<double>(q.count());
        return result;
    }
};

/// Slides from rest at 40 degrees with 25 degrees of friction, stands at 20, and stops on level ground.
Measurement run_structured_slide(const Setup& setup) {
    constexpr double kBed = 25.0, kEnd = 0.4;
    const double th = 40.0 * kDegree, mu = std::tan(kBed * kDegree);
    const double a = kGravity * std::cos(th) * (std::sin(th) - mu * std::cos(th));  // on the map
    Measurement m;
    double way = 0.0, speed = 0.0, across = 0.0;
    for (const double turn : {0.0, 45.0}) {
        const auto end = StructuredSlide{40.0, kBed, turn, 0.0, kEnd}.run(setup);
        way = larger(way, end.along / (0.5 * a * kEnd * kEnd) - 1.0),
        speed = larger(speed, end.speed / (a * kEnd) - 1.0);
        across = std::max(across, end.across);
        m = end.run;
    }
    const auto held = StructuredSlide{20.0, kBed, 45.0, 0.0, kEnd}.run(setup);
    const double v = 2.0, stop = v * v / (2.0 * kGravity * mu);
    const auto stopped = StructuredSlide{0.0, kBed, 0.0, v, 0.6}.run(setup);
    m.add("way_error", way);
    m.add("speed_error", speed);
    m.add("across", across, "m");
    m.add("held_moved", std::abs(held.along) + held.across, "m");
    m.add("stop_error", stopped.along / stop - 1.0);
    m.add("stop_speed", stopped.speed, "m/s");
    return m;
}

/// The flume's block on level ground. Intact it does not move at all. It stands where Bell's height 4 c / (rho g
/// sqrt(Ka)) is above its own. Where it is not, the block falls to grains.
Measurement run_structured_stand(const Setup& setup) {
    const auto block = [&](double cohesion, double bed_deg) {
        StructuredScene s;
        s.material.young = 5e6;
        s.material.friction = 28.0 * kDegree;
        s.material.critical_strain = critical_strain(0.07, 0.0125, 0.3 / static_cast<double>(setup.cells));
        s.bed_law = bed::Coulomb{std::tan(bed_deg * kDegree)};
        s.grid = grid_over({-0.6, -0.6}, {0.9, 0.9}, 0.3 / static_cast<double>(setup.cells));
        add_block(s, {{0, 0}, {0.3, 0.25}, 0.1, cohesion, {0, 0}, 0.0, setup.per_side});
        return s;
    };
    double moved = 0.0, residual = 0.0;
    Measurement m;
    Index steps = 0;
    const auto run = [&](StructuredFlow& flow) {
        m = run_structured(flow, 0.5);
        residual = std::max(residual, m.value("momentum_residual")), steps += m.steps;
    };
    for (const double cohesion : {26.7e3, 0.5e3, 0.3e3}) {  // heights 10.7, 0.20 and 0.12 m
        StructuredFlow flow(block(cohesion, 0.0));
        const double length = length_of(flow);
        run(flow);
        moved = std::max({moved, std::abs(length_of(flow) - length), flow.status().max_speed, flow.status().damage});
    }
    StructuredFlow weak(block(0.1e3, 5.0));  // 0.04 m
    const double length = length_of(weak);
    run(weak);
    m.steps = steps, m.extras.clear();
    m.add("momentum_residual", residual);
    m.add("moved", moved);
    m.add("whole", 1.0 - weak.status().damage);
    m.add("spread", length_of(weak) / length);
    return m;
}

/// Grains from the start, without friction at the bed: Ritter's dam break with Ka g.
Measurement run_structured_dam(const Setup& setup) {
    constexpr double kDepth = 1.0, kEnd = 0.8;
    const double cell = 10.0 / static_cast<double>(setup.cells), side = 4.0 * cell;
    StructuredScene s;
    s.material.young = 1e7;  // nothing is whole: it only sets the step, which grains need short
    s.material.friction = 30.0 * kDegree;
    s.grid = grid_over({-5, 0}, {5, side}, cell);
    add_channel(s, 0.0, side);
    Obstacle end;
    end.high.x() = -5.0;
    s.obstacles.push_back(end);
    add_block(s, {{-5, 0}, {0, side}, kDepth, 0.0, {0, 0}, 1.0, setup.per_side});
    StructuredFlow flow(s);
    const Ritter exact{kDepth, kGravity * flow.body().law.active()};
    Measurement m = run_structured(flow, kEnd);
    const StructuredBody& body = flow.body();
    double error = 0.0, all = 0.0, tip = -1e300;
    for (Index i = 0; i < body.grid.nx(); ++i) {
        const double x = body.grid.geometry().x(i);
        if (x < -5.0) continue;
        const auto j = static_cast<Index>(std::lround((0.5 * side - body.grid.geometry().y0) / cell));
        const Index k = body.grid.at(i, j);
        const double h = body.moved[k].depth, h_exact = exact.at(x / kEnd).depth;
        error += std::abs(h - h_exact), all += h_exact;
    }
    for (Index p = 0; p < body.points.count(); ++p) tip = std::max(tip, flow.position(p).x());
    m.l1_depth = error / all;
    m.front_error = tip - exact.front() * kEnd;
    return m;
}

}  // namespace

std::vector<Problem> structured_problems() {
    const Gate closed{0, "momentum_residual", 1e-12, "round-off"}, mass{0, "mass_error", 1e-14, "round-off"};
    Problem spin{"structured_spin", "V1: an elastic block turns once: spin, energy, angle", {12, 24}, {}, run_spin};
    spin.order_of = "kinetic_lost";
    spin.gates = {{24, "spin_error", 1e-3, "an earlier code 2e-5"},
                  {24, "kinetic_lost", 5e-3, "an earlier code 3.4e-3"},
                  {24, "angle_error", 0.03, "an earlier code 0.0135"},
                  closed,
                  mass};
    Problem bar{"structured_bar",
                "V9: a bar strikes a wall: stress rho c v, over 2 L / c",
                {50, 100, 200},
                {},
                run_structured_bar};
    bar.order_of = "plateau_error";
    bar.gates = {{100, "plateau_error", 0.07, "an earlier code 0.961 +- 0.03, first order"},
                 {100, "rebound_error", 0.05, "an earlier code 0.967"},
                 {100, "contact_error", 0.05, "an earlier code 1.019"},
                 closed,
                 mass};
    Problem slide{"structured_slide",
                  "V13: a block slides from rest, stands, and stops: Coulomb",
                  {8, 16, 32},
                  {},
                  run_structured_slide};
    slide.order_of = "way_error";
    slide.gates = {{0, "way_error", 0.05, "first order in the step, which is 1 / steps"},
                   {0, "speed_error", 1e-12, "round-off"},
                   {0, "across", 1e-12, "round-off"},
                   {0, "held_moved", 0.0, "static friction is a bound, not a force"},
                   {0, "stop_error", 0.05, "as the way"},
                   {0, "stop_speed", 0.0, "friction stops what it would turn around"},
                   closed,
                   mass};
    Problem stand{"structured_stand",
                  "V16: a block on the ground: whole it rests exactly, below Bell's height it stands",
                  {12, 24},
                  {},
                  run_structured_stand};
    stand.order_of = "spread";
    stand.gates = {{0, "moved", 0.0, "a free face carries no traction"},
                   {0, "whole", 0.01, "an earlier code: broken everywhere"},
                   closed,
                   mass};
    Problem dam{"structured_dam", "V16: grains behind a dam: Ritter with Ka g", {100, 200}, {}, run_structured_dam};
    dam.gates = {{100, "l1_depth", 2.4e-2, "a fifth above 1.98e-2; the form without it had 4.4e-2"},
                 {200, "l1_depth", 1.45e-2, "a fifth above 1.21e-2; the form without it had 4.3e-2"},
                 closed,
                 mass};
    std::vector<Problem> all = {spin, bar, slide, stand, dam};
    for (Problem& problem : all) problem.has_presets = false;
    return all;
}

}  // namespace frana::verify
