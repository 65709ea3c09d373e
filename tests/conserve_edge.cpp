// The edge between particles and 3D points: what is on one side feels what is on the other.
#include <map>

#include "analytic_scene.h"
#include "catch.h"
#include "coupling/staged_run.h"
#include "mpm/stencil.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kCell = 0.5;  // of the space [m]; of the terrain 1 m

/// Particles over a bed in a tank 4 m wide; from `from` on those east of 19.5 m are points.
Scene tank(Index length, const Function& bed, const Function& depth, double from) {
    Scene scene = scene_on(length + 1, 5, 1.0, bed);
    scene.particles = {};
    fill(scene, depth);
    scene.sides = Sides::wall;
    SolidStage stage;
    stage.from = from;
    stage.window = {20, 0, length, 4};
    stage.closed = {false, true, true, true};
    stage.cell = kCell;
    stage.spacing = 0.5 * kCell;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    return scene;
}

/// A sheet as deep everywhere that flows from the west over the edge, and out of the window in the east.
Scene sheet(double slope, double depth, double speed) {
    Scene scene = tank(
        60, [=](double x, double) { return slope * (60.0 - x); },
        [=](double x, double) { return x < 45.0 ? depth : 0.0; }, 0.2);
    scene.particles.vx.assign(scene.particles.x.size(), speed);
    scene.solid->closed[2] = false;
    return scene;
}

/// Sums of what particles and points have in rows of nodes, as particles deposit it.
struct Row {
    double mass = 0.0, points = 0.0, pressure = 0.0;  ///< [kg]; of points alone; times their pressure [kg Pa]
};
std::vector<Row> rows_of(const StagedRun& run, Index length) {
    std::vector<Row> rows(static_cast<std::size_t>(length + 3));
    const auto add = [&](double x, double mass, double points, double pressure) {
        const Quadratic s(x);
        for (int n = 0; n < 3; ++n) {
            if (s.base + n < 0 || s.base + n > length) continue;
            Row& row = rows[static_cast<std::size_t>(s.base + n)];
            row.mass += s.w[n] * mass, row.points += s.w[n] * points, row.pressure += s.w[n] * pressure;
        }
    };
    const Particles& c = run.particles().flow().particles;
    for (Index p = 0; p < c.count(); ++p) add(c.x[p], c.mass[p], 0.0, 0.0);
    const MaterialPoints& q = run.points()->body().points;
    for (Index p = 0; p < q.count(); ++p)
        add(run.points()->position(p).x(), q.mass[p], q.mass[p], -q.mass[p] * run.points()->stress(p).trace() / 3.0);
    return rows;
}

/// Largest momentum that no impulse explains, in each step up to `end`, over mass times speed.
double worst_momentum(StagedRun& run, double end, double start, double speed) {
    double worst = 0.0;
    while (run.status().time < end) {
        run.advance(end);
        const Status& now = run.status();
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const double left =
                now.momentum[axis] + now.momentum_left[axis] - now.impulse[axis] - (axis == 0 ? start : 0.0);
            worst = std::max(worst, std::abs(left) / ((now.mass + now.mass_left) * speed));
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("A lake at rest that reaches across the window's edge creeps by less than 0.02 cells in 1 s", "[stages]") {
    // Flat, and over a bed that rises by a tenth; without what both sides show each other 0.38 and 0.57 cells; with it
    // 0.0007 and 0.0074.
    const double slope = GENERATE(0.0, 0.1);
    CAPTURE(slope);
    const Scene scene = tank(
        40, [=](double x, double) { return slope * (40.0 - x); },
        [=](double x, double) { return (slope > 0.0 ? 5.0 : 1.5) - slope * (40.0 - x); }, 0.1);
    StagedRun run(scene);
    run_to(run, 0.1);
    std::map<std::int64_t, Vec3> start;
    const MaterialPoints& q = run.points()->body().points;
    for (Index p = 0; p < q.count(); ++p) start[q.id[p]] = run.points()->position(p);
    const double wave = std::sqrt(9.81 * 1.5);  // what momenta are held against: nothing moves
    CHECK(worst_momentum(run, 1.1, 0.0, wave) < 1e-12);
    double sum = 0.0;
    for (Index p = 0; p < q.count(); ++p) sum += (run.points()->position(p) - start.at(q.id[p])).squaredNorm();
    CHECK(std::sqrt(sum / static_cast<double>(q.count())) < 0.02 * kCell);
    CHECK(start.size() == static_cast<std::size_t>(q.count()));  // none came in, none left
    CHECK(run.status().mass_left == 0.0);
    // The ledger is not empty: what is beside the points holds their pressure on the whole edge.
    const double depth = slope > 0.0 ? 5.0 - slope * 20.5 : 1.5;
    const double force = 0.5 * scene.density * scene.gravity * depth * depth * 4.0;
    CHECK(run.points()->status().ghost_impulse.x() == Approx(1.0 * force).epsilon(0.02));
    CHECK(run.points()->momentum_residual().norm() < 1e-12 * force);
}

TEST_CASE("A window in the middle of a lake rests between the particles around it, corners too", "[stages]") {
    Scene scene = scene_on(19, 19, 1.0, [](double, double) { return 0.0; });
    scene.particles = {};
    fill(scene, [](double, double) { return 1.0; });
    scene.sides = Sides::wall;
    SolidStage stage;
    stage.from = 0.05;
    stage.window = {6, 7, 12, 11};
    stage.cell = kCell;
    stage.spacing = 0.5 * kCell;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    StagedRun run(scene);
    run_to(run, 0.05);
    const MaterialPoints& q = run.points()->body().points;
    REQUIRE(q.count() == 28 * 20 * 4);
    std::map<std::int64_t, Vec3> start;
    for (Index p = 0; p < q.count(); ++p) start[q.id[p]] = run.points()->position(p);
    run_to(run, 1.05);
    REQUIRE(q.count() == 28 * 20 * 4);
    double worst = 0.0;
    for (Index p = 0; p < q.count(); ++p)
        worst = std::max(worst, (run.points()->position(p) - start.at(q.id[p])).norm());
    CHECK(worst < 0.02 * kCell);  // 1.5 cells without what both sides show each other
}

TEST_CASE("A uniform flow crosses the window's edge within 2 % of its depth", "[stages]") {
    // Level, where nothing changes, and down 1 in 5 without friction, where it stays as deep and speeds up. What is left
    // is the lattice of the points, seen through the particles' shape functions. (Rows before the 16th feel the sheet's
    // end, whose waves have come 12 m by then.) Without what both sides show each other: 28 and 20 %.
    const double slope = GENERATE(0.0, 0.2);
    CAPTURE(slope);
    const Scene scene = sheet(slope, 1.0, 4.0);
    StagedRun run(scene);
    const double start = run.status().momentum[0], full = scene.density * 4.0;
    double worst = 0.0, momentum = 0.0;
    for (double time = 0.4; time < 1.45; time += 0.2) {
        momentum = std::max(momentum, worst_momentum(run, time, start, 4.0));
        const std::vector<Row> rows = rows_of(run, 60);
        for (Index k = 16; k <= 26; ++k)
            worst = std::max(worst, std::abs(rows[static_cast<std::size_t>(k)].mass / full - 1.0));
    }
    CHECK(worst < 0.02);
    CHECK(momentum < 1e-12);
    CHECK(run.status().mass_left == 0.0);
}

TEST_CASE("Particles that flow in have their pressure at the bed within 5 % right behind the edge", "[stages]") {
    // Of points that came in during the run, up to four cells behind the edge, mean of four times. Level to 1 %; down 1 in
    // 5 pressures of single cells swing by a tenth, for speeds that differ by a thousandth of sound. Without what both
    // sides show each other: 0.78 and 0.62 of it.
    const double slope = GENERATE(0.0, 0.2);
    CAPTURE(slope);
    const Scene scene = sheet(slope, 1.0, 4.0);
    StagedRun run(scene);
    const double whole = 0.5 * scene.density * scene.gravity / (1.0 + slope * slope);  // mean over a depth of 1 m
    double pressure = 0.0, points = 0.0;
    for (const double time : {1.2, 1.35, 1.5, 1.65}) {
        run_to(run, time);
        const std::vector<Row> rows = rows_of(run, 60);
        for (std::size_t k = 21; k <= 24; ++k) pressure += rows[k].pressure, points += rows[k].points;
    }
    CHECK(pressure / (points * whole) == Approx(1.0).epsilon(slope > 0.0 ? 0.05 : 0.01));
}

TEST_CASE("Momentum closes to round-off at an edge with a barrier across it, with every transfer, and for sand",
          "[stages]") {
    Scene scene = sheet(0.2, 1.0, 4.0);
    Barrier post;
    post.outline.parts.emplace_back();
    post.outline.parts[0].rings.push_back({{18.0, 1.5}, {22.0, 1.5}, {22.0, 2.5}, {18.0, 2.5}});
    post.height = 3.0;
    post.friction = 0.3;
    scene.barriers.push_back(post);
    scene.solid->bed_friction = 0.2;
    const auto law = GENERATE(0, 1, 2, 3);
    scene.sides = law == 0 ? Sides::open : Sides::wall;  // between walls the particles' impulse is what they gained
    CAPTURE(law);
    scene.solid->transfer = law == 0 ? Transfer::tpic : law == 1 ? Transfer::apic : Transfer::flip;
    scene.solid->blending = 0.2;
    if (law == 3) scene.solid->law = solid::DruckerPrager::of(solid::Elastic::of(2e6, 0.3), 0.5, 0.0);
    StagedRun run(scene);
    const double start = run.status().momentum[0];
    CHECK(worst_momentum(run, 0.5, start, 4.0) < 1e-12);
    const SolidStatus& points = run.points()->status();
    CHECK(points.ghost_impulse.norm() > 0.001 * points.momentum.norm());
    CHECK(run.points()->momentum_residual().norm() < 1e-12 * points.momentum.norm());
    Vec3 on_post{0, 0, 0};
    for (const FaceLoad& face : run.loads()->barriers.at(0).faces) on_post += face.impulse;
    CHECK(on_post.x() > 0.001 * points.momentum.norm());
}

namespace {

/// A slab on a plane that falls by 1 in 5 to the east, without friction: points from the start in a window of 20 m,
/// particles below it.
Scene slab(Index cells_of_flow, std::optional<double> until) {
    const double slope = 0.2;
    Scene scene = scene_on(80, 5, 1.0, [=](double x, double) { return slope * (80.0 - x); });
    scene.particles = {};
    fill(scene, [](double x, double) { return x > 6.0 && x < 16.0 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 5.0);
    scene.sides = Sides::wall;
    SolidStage stage;
    stage.window = {0, 0, 20, 4};
    stage.closed = {true, true, false, true};
    stage.cell = 1.0 / static_cast<double>(cells_of_flow);
    stage.spacing = 0.5 * stage.cell;
    stage.law = solid::Fluid{};
    stage.until = until;
    scene.solid = stage;
    return scene;
}

/// Centre of mass along x of particles and points [m].
double centre_of(const StagedRun& run) {
    double moment = 0.0, mass = 0.0;
    const Particles& c = run.particles().flow().particles;
    for (Index p = 0; p < c.count(); ++p) moment += c.mass[p] * c.x[p], mass += c.mass[p];
    const MaterialPoints& q = run.points()->body().points;
    for (Index p = 0; p < q.count(); ++p) moment += q.mass[p] * run.points()->position(p).x(), mass += q.mass[p];
    return moment / mass;
}

}  // namespace

TEST_CASE("Points that leave the window go on as particles, with their mass and momentum", "[stages]") {
    // Forces inside the slab are its own: its centre of mass falls by g sin cos, whatever it is made of. Of the 1 % 0.2 are
    // lost before the first point leaves. With new particles that do not carry on the points' gradient the slab gains 5
    // %.
    const Scene scene = slab(2, {});
    StagedRun run(scene);
    const double mass = run.status().mass, start = run.status().momentum[0];
    const double x0 = centre_of(run), energy = run.status().kinetic + run.status().potential;
    const Index seeds = run.points()->status().points;
    CHECK(worst_momentum(run, 3.0, start, 5.0) < 1e-12);
    const Status& now = run.status();
    CHECK(run.points()->status().points <= seeds / 20);
    CHECK(run.particles().status().mass >= 0.95 * mass);
    CHECK(now.mass_left == Approx(0.0).margin(1e-12 * mass));
    CHECK(now.mass == Approx(mass).epsilon(1e-13));
    const double g = 9.81 * 0.2 / (1.0 + 0.04);
    CHECK(centre_of(run) - x0 == Approx(5.0 * now.time + 0.5 * g * now.time * now.time).epsilon(0.01));
    CHECK(now.momentum[0] / mass == Approx(5.0 + g * now.time).epsilon(0.01));
    CHECK(now.kinetic + now.potential + now.energy_left < energy);
    CHECK(now.energy_left == Approx(0.0).margin(1e-12 * energy));
}

TEST_CASE("A 3D stage ends: all points become particles, which go on", "[stages]") {
    const Scene scene = slab(2, 0.7);
    StagedRun run(scene);
    const double mass = run.status().mass, start = run.status().momentum[0], x0 = centre_of(run);
    const double energy = run.status().kinetic + run.status().potential;
    CHECK(worst_momentum(run, 0.7, start, 5.0) < 1e-12);
    CHECK(run.status().time == 0.7);
    CHECK(run.points()->status().points == 0);
    CHECK(run.particles().status().mass == Approx(mass).epsilon(1e-13));
    const double here = centre_of(run);
    Frame frame = run.frame();
    for (Index p = 0; p < frame.particle("model")->count; ++p) REQUIRE(frame.particle("model")->data[p] == 0.0);
    CHECK(worst_momentum(run, 3.0, start, 5.0) < 1e-12);
    CHECK(centre_of(run) > here + 10.0);
    const double g = 9.81 * 0.2 / (1.0 + 0.04), t = run.status().time;
    CHECK(t == 3.0);
    CHECK(centre_of(run) - x0 == Approx(5.0 * t + 0.5 * g * t * t).epsilon(0.01));
    CHECK(run.status().mass == Approx(mass).epsilon(1e-13));
    CHECK(run.status().mass_left == Approx(0.0).margin(1e-12 * mass));
    // Every joule is somewhere, but for what particles lose by their scheme.
    const Status& now = run.status();
    const double residual = energy - now.kinetic - now.potential - now.stored - now.dissipated - now.energy_left;
    CHECK(std::abs(residual) < 0.01 * now.kinetic);
}

TEST_CASE("Where a 3D stage ends while adjacent particles go on, no force acts on any of them", "[stages]") {
    // With velocities half a step apart the momentum of a frame would jump by a hundredth.
    const Scene scene = slab(2, 1.6);
    StagedRun run(scene);
    const double before = 1.599, g = 9.81 * 0.2 / (1.0 + 0.04);
    run_to(run, before);
    REQUIRE(run.particles().status().mass > 0.2 * run.status().mass);
    REQUIRE(run.points()->status().mass > 0.2 * run.status().mass);
    const double then = run.frame().status.momentum[0], mass = run.status().mass;
    run_to(run, 1.6);
    REQUIRE(run.points()->status().points == 0);
    CHECK(run.frame().status.momentum[0] == Approx(then + mass * g * (1.6 - before)).epsilon(1e-3));
    run_to(run, 1.7);
    CHECK(run.frame().status.momentum[0] == Approx(then + mass * g * (1.7 - before)).epsilon(2e-3));
}

TEST_CASE("Points that lie against a barrier when their stage ends become particles no higher, and gain no energy",
          "[stages]") {
    Scene scene = tank(
        40, [](double, double) { return 0.0; }, [](double x, double) { return x > 8.0 && x < 18.0 ? 1.0 : 0.0; }, 0.0);
    scene.particles.vx.assign(scene.particles.x.size(), 6.0);
    scene.solid->window = {0, 0, 40, 4};
    scene.solid->closed = {true, true, true, true};
    scene.solid->until = 1.2;
    Barrier wall;
    wall.outline.parts.emplace_back();
    wall.outline.parts[0].rings.push_back({{20.3, -1.0}, {22.3, -1.0}, {22.3, 5.0}, {20.3, 5.0}});
    wall.height = 8.0;
    scene.barriers.push_back(wall);
    StagedRun run(scene);
    const double mass = run.status().mass;
    run_to(run, 1.19);
    const Status before = run.status();
    Index touching = 0;
    // The wall raises the particles' filtered ground by 80, 20 and 0.3 % of its 8 m at 20, 19 and 18 m.
    const double levels[2] = {0.1 * 8.0, 0.5 * 8.0};
    double points_above[2] = {}, particles_above[2] = {};
    for (Index p = 0; p < run.points()->status().points; ++p) {
        touching += run.points()->position(p).x() > 20.0;
        for (int n = 0; n < 2; ++n)
            if (run.points()->position(p).z() > levels[n]) points_above[n] += run.points()->body().points.mass[p];
    }
    REQUIRE(touching > 100);
    run_to(run, 1.2);
    const Status now = run.status();
    CHECK(now.kinetic + now.potential < before.kinetic + before.potential + before.stored);
    const Particles& c = run.particles().flow().particles;
    double there = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        const double ground = run.particles().flow().bed.z[run.particles().flow().grid.nearest(c.x[p], c.y[p])];
        for (int n = 0; n < 2; ++n)
            if (ground > levels[n]) particles_above[n] += c.mass[p];
        there += c.mass[p];
    }
    for (int n = 0; n < 2; ++n) CHECK(particles_above[n] <= points_above[n]);  // what stands on the ramp was above it
    CHECK(there == Approx(mass).epsilon(1e-13));
    run_to(run, 2.0);
    CHECK(run.status().mass_left == Approx(0.0).margin(1e-12 * mass));
    CHECK(run.status().kinetic + run.status().potential < before.kinetic + before.potential + before.stored);
}

// The ramp takes the room of a cell of the lake. Moved to the cells before it, that is a wave of 4 % of the depth. It
// meets itself at the ends of the tank: half again, and what particles rock on the ramp.
TEST_CASE("A lake that stands at a barrier when its 3D stage ends is not heaped before it", "[stages][barrier]") {
    const double face = GENERATE(30.0, 30.3, 29.7);
    Scene scene = tank(
        40, [](double, double) { return 0.0; }, [=](double x, double) { return x < face ? 2.0 : 0.0; }, 0.0);
    scene.solid->window = {0, 0, 40, 4};
    scene.solid->closed = {true, true, true, true};
    scene.solid->until = 0.3;
    Barrier wall;
    wall.outline.parts.emplace_back();
    wall.outline.parts[0].rings.push_back({{face, -1.0}, {face + 3.0, -1.0}, {face + 3.0, 5.0}, {face, 5.0}});
    wall.height = 5.0;
    scene.barriers.push_back(wall);
    StagedRun run(scene);
    const double mass = run.status().mass;
    run_to(run, 0.3);
    CHECK(run.particles().status().mass == Approx(mass).epsilon(1e-13));
    double deepest = 0.0;
    while (run.status().time < 2.0) {
        const Frame frame = run.frame();
        const Field& depth = *frame.node("depth");
        for (Index n = 0; n < depth.count; ++n) deepest = std::max(deepest, depth.data[n]);
        run.advance(2.0);
    }
    CAPTURE(face);
    CHECK(deepest < 1.08 * 2.0);
}

TEST_CASE("A 3D stage that ends before anything has come to its window says so", "[stages]") {
    Scene scene = tank(
        40, [](double, double) { return 0.0; }, [](double x, double) { return x < 5.0 ? 1.0 : 0.0; }, 0.1);
    scene.solid->until = 0.3;
    const auto said = [](const StagedRun& run) {
        for (const std::string& remark : run.remarks())
            if (remark.find("before anything came to its window") != std::string::npos) return true;
        return false;
    };
    StagedRun run(scene);
    run_to(run, 0.2);
    CHECK_FALSE(said(run));
    run_to(run, 0.4);
    CHECK(said(run));
    scene.solid->window = {2, 0, 40, 4};
    StagedRun reached(scene);
    run_to(reached, 0.4);
    CHECK_FALSE(said(reached));
}
