// Runs in stages: particles that become 3D points keep mass, momentum and energy, at once and as they
// flow in.
#include <omp.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "analytic_scene.h"
#include "base/error.h"
#include "catch.h"
#include "convert/flow_particles.h"
#include "coupling/bed_friction.h"
#include "coupling/stage_conversion.h"
#include "coupling/staged_run.h"
#include "fake_gis.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"
#include "terrain/holes.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slab that slides down a slope of 1 in 4 into a window whose upper edge it crosses, and out of it below.
Scene slide(double from = 0.4) {
    Scene scene = scene_on(41, 13, 1.0, [](double x, double) { return 20.0 - 0.25 * x; });
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 3 && x < 15 && y > 3 && y < 9 ? 1.5 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.end = 2.0;
    SolidStage stage;
    stage.from = from;
    stage.window = {12, 0, 30, 12};
    stage.cell = 0.5;
    stage.spacing = 0.25;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    return scene;
}

/// The same over loose ground that ends before the window.
Scene over_loose_ground() {
    Scene scene = slide();
    scene.erodible = ErodibleBed{};
    scene.erodible->law = erosion::Growth{0.05};
    scene.erodible->density = scene.density;
    scene.erodible->depth = sampled(scene.bed.geometry, [](double x, double) { return x < 7.5 ? 0.5 : 0.0; });
    return scene;
}

/// A smaller slab, of which all leaves a shorter window again.
Scene slide_through() {
    Scene scene = slide();
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 9 && x < 15 && y > 4 && y < 8 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.solid->window = {12, 0, 18, 12};
    return scene;
}

/// The largest distance from a place in [x0, x1] x [y0, y1] to the point that is nearest on the map [m].
double largest_gap(const Mpm3d& points, double x0, double x1, double y0, double y1) {
    double most = 0.0;
    constexpr double step = 0.1;
    for (double x = x0; x <= x1; x += step)
        for (double y = y0; y <= y1; y += step) {
            double least = 1e300;
            for (Index p = 0; p < points.body().points.count(); ++p)
                least = std::min(least, (points.position(p).head<2>() - Vec2(x, y)).norm());
            most = std::max(most, least);
        }
    return most;
}

double total(const Field* field, Index from, Index to) {
    double sum = 0.0;
    for (Index p = from; p < to; ++p) sum += field->data[p];
    return sum;
}

}  // namespace

TEST_CASE("Particles that become points conserve mass, momentum and energy, at once and later", "[stages]") {
    const Scene scene = slide();
    StagedRun run(scene);
    const double mass = run.status().mass, momentum = run.status().momentum[0];
    run_to(run, scene.solid->from);
    REQUIRE(run.points() != nullptr);
    REQUIRE(run.points()->status().points > 500);
    REQUIRE(run.particles().status().particles > 50);
    // The energies of particles and points differ by the bed: averaged over a cell, or bilinear; on a plane
    // they agree.
    const double round_off = 1e-12;
    const Status before = run.status();
    CHECK(mass_error(before, mass) < round_off);
    CHECK(std::abs(before.energy_left) < round_off * before.potential);
    double worst = 0.0;
    Index most = 0;
    while (run.status().time < scene.end) {
        run.advance(scene.end);
        const Status& now = run.status();
        worst = std::max(worst, std::abs(now.mass + now.mass_left - mass) / mass);
        const double left = now.momentum[0] + now.momentum_left[0] - momentum - now.impulse[0];
        worst = std::max(worst, std::abs(left) / (mass * now.max_speed));
        most = std::max(most, run.points()->status().points);
    }
    CHECK(worst < round_off);
    // Everything has flowed into the window, and some of it out again: as particles, and at the sides out of the
    // terrain.
    CHECK(run.particles().status().mass > 0.1 * mass);
    CHECK(run.status().mass_left > 0.1 * mass);
    CHECK(most > run.points()->status().points);
}

TEST_CASE("A sheet that is drawn out becomes points without gaps", "[stages]") {
    // Without friction on a bed z = -k x^2 / 2 each place moves as cosh(sqrt(g k) t): four times as long after 6.6 s.
    constexpr double k = 0.01;
    Scene scene = scene_on(81, 9, 1.0, [](double x, double) { return 30.0 - 0.5 * k * x * x; });
    scene.particles = {};
    fill(
        scene, [](double x, double) { return x > 5 && x < 15 ? 1.0 : 0.0; }, 8);
    scene.sides = Sides::wall;
    SolidStage stage;
    stage.from = std::acosh(4.0) / std::sqrt(scene.gravity * k);
    stage.window = {0, 0, 80, 8};
    stage.cell = 0.25;
    stage.spacing = 0.125;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    StagedRun run(scene);
    run_to(run, stage.from);
    REQUIRE(run.points() != nullptr);
    // On a square lattice 1.5 spacings wide no place is farther away than that.
    CHECK(largest_gap(*run.points(), 35.0, 45.0, 3.0, 5.0) < 1.5 * stage.spacing / std::sqrt(2.0));
    CHECK(run.points()->status().mass == Approx(run.status().mass).epsilon(1e-12));
}

TEST_CASE("Particles of the paper preset, whose domains stay as they were, become points on squares of their volume",
          "[stages]") {
    Scene scene = slide();
    DepthAveraged particles(scene);
    const Particles& points = particles.flow().particles;
    CHECK(domains_of(points, 1.0, scene.scheme).size() == static_cast<std::size_t>(points.count()));
    scene.scheme.paper_pressure = true;
    const std::vector<Mat2> none = domains_of(points, 1.0, scene.scheme);
    CHECK(none.empty());
    const std::vector<std::uint8_t> all(static_cast<std::size_t>(scene.bed.geometry.size()), 1);
    const FlowParticles flat = particles_of(particles.frame(), none, scene.bed, all);
    REQUIRE(flat.count() == static_cast<std::size_t>(points.count()));
    const FlowParticles parts = in_parts(flat, 0.125, 1.0, scene.bed, {0.0, 0.0, 40.0, 12.0});
    const double width = std::sqrt(flat.volume[0] / flat.depth[0]);  // of a square, in parts of an eighth of a metre
    CHECK(parts.x[0] == Approx(flat.x[0] + width * (0.5 / std::round(width / 0.125) - 0.5)));
}

TEST_CASE("A slab that slides becomes 3D and particles again without a change of its way", "[stages]") {
    constexpr double slope = 0.5, mu = 0.3;
    Scene scene = scene_on(81, 21, 1.0, [](double x, double) { return 50.0 - slope * x; });
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 5 && x < 17 && y > 8 && y < 12 ? 1.5 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 6.0);
    scene.bed_law = GENERATE(BedLaw(bed::Coulomb{mu}), BedLaw(bed::Voellmy{mu, 200.0}),
                             BedLaw(bed::Pouliquen{mu, 0.6, 0.3, 0.05, 0.6}));
    const bool coulomb = std::holds_alternative<bed::Coulomb>(scene.bed_law);
    scene.end = 3.0;
    DepthAveraged particles(scene);
    SolidStage stage;
    stage.from = 0.5, stage.until = 2.0;
    stage.window = {0, 0, 80, 20};
    stage.cell = 0.5, stage.spacing = 0.25;
    stage.law = solid::DruckerPrager::of({}, std::atan(mu), 0.0);
    if (std::holds_alternative<bed::Pouliquen>(scene.bed_law))  // as the case has it
        stage.law = solid::MuI{{}, mu, 0.6, 0.3, 0.05, 0.6};
    stage.of_bed = true, stage.whole_bed_law = !coulomb;
    stage.transfer = Transfer::flip, stage.blending = std::sqrt(stage.cell / scene.gravity);
    stage.bed_friction = mu;
    scene.solid = stage;
    StagedRun run(scene);
    const auto middle = [](Simulation& simulation) {
        const Frame frame = simulation.frame();
        const Field *mass = frame.particle("mass"), *place = frame.particle("position");
        double sum = 0.0, moment = 0.0;
        for (Index p = 0; p < mass->count; ++p) sum += mass->data[p], moment += mass->data[p] * place->data[3 * p];
        return moment / sum;
    };
    const double before = middle(run);
    run_to(run, scene.end), run_to(particles, scene.end);
    const double way = middle(run) - before, alone = middle(particles) - before;
    CAPTURE(scene.bed_law.index(), way, alone);
    CHECK(alone > 10.0);
    // Under Coulomb's law the middle of the mass goes as a block does, however the slab spreads. Laws of the mean speed and the
    // depth are felt where the map has them, on cells of 1 m: to one of the stage's cells.
    CHECK(std::abs(way - alone) < (coulomb ? 0.005 * alone : stage.cell));
    if (!coulomb) {  // without what grows with speed it would be cells too far
        scene.solid->whole_bed_law = false;
        StagedRun fast(scene);
        run_to(fast, scene.end);
        CHECK(middle(fast) - before > alone + 2.0 * stage.cell);
    }
}

// A bed that holds mud on cells of half a metre drags far too much, and particles that feel no such drag drive it on.
// The front of a slide like this one came to 50 m/s in a second, where particles have 18 m/s.
TEST_CASE("Fast mud in 3D is as fast as in particles, and no point has more energy than the fall gives", "[stages]") {
    constexpr double slope = 0.5, depth = 1.0, speed = 12.0, end = 1.6;
    const bool window = GENERATE(false, true);
    CAPTURE(window);
    Scene scene = scene_on(81, 5, 0.5, [](double x, double) { return 50.0 - slope * x; });
    scene.particles = {};
    fill(scene, [](double x, double) { return x > 2 && x < 16 ? depth : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), speed);
    scene.sides = Sides::wall;
    scene.density = 1500.0;
    scene.bed_law = bed::Bingham{20.0, 500.0, 0.0};
    scene.end = end;
    DepthAveraged particles(scene);
    SolidStage stage;
    stage.from = 0.1;
    stage.window = {window ? 40 : 0, 0, 80, 4};
    stage.closed = {!window, true, true, true};
    stage.cell = 0.5, stage.spacing = 0.25;
    stage.law = solid::Bingham{0.0, 5e4, 20.0, 500.0};
    stage.stuck_where_resolved = stage.whole_bed_law = true;
    scene.solid = stage;
    StagedRun run(scene);
    run_to(run, end), run_to(particles, end);
    REQUIRE(run.points()->status().points > 100);
    // Particles have no layer that shears and no upright motion: to 5 % of their speed. (Particles on cells of half and
    // a quarter of these have 1 % more energy than here; points feel the thin front on two cells.)
    CHECK(run.status().kinetic == Approx(particles.status().kinetic).epsilon(0.1));
    const double head = 50.0 - slope * 2.0 + depth + 0.5 * speed * speed * (1.0 + slope * slope) / scene.gravity;
    for (Index p = 0; p < run.points()->body().points.count(); ++p)
        REQUIRE(run.points()->position(p).z() + 0.5 * run.points()->velocity(p).squaredNorm() / scene.gravity < head);
    const std::vector<std::string> remarks = run.remarks();
    CHECK(std::any_of(remarks.begin(), remarks.end(), [](const std::string& text) {
        return text.find("slide over the bed, which brakes them by material.bed") != std::string::npos;
    }));
}

TEST_CASE("Mud sticks to its bed where cells show the layer that shears there, or where it is told to", "[stages]") {
    constexpr double depth = 1.2, speed = 2.0, viscosity = 4000.0, yield_stress = 300.0, density = 1800.0;
    const solid::Bingham law{0.0, 3e4, viscosity, yield_stress};
    // 3/4 of a cell times the rate of shear is the shear velocity.
    const double rate = 3.0 * speed / depth, stress = yield_stress + viscosity * rate;
    const double cell = resolving_cell(law, density, depth, speed);
    CHECK(0.75 * cell * rate == Approx(std::sqrt(stress / density)));
    CHECK(resolving_cell(solid::HerschelBulkley{0.0, 3e4, viscosity, 1.0, yield_stress}, density, depth, speed) ==
          Approx(cell));
    CHECK(resolving_cell(solid::Fluid{0.0, viscosity}, density, depth, speed) < cell);
    CHECK(std::isinf(resolving_cell(law, density, depth, 0.0)));

    Scene scene = scene_on(11, 11, 1.0, [](double, double) { return 0.0; });
    scene.density = density;
    scene.bed_law = bed::Bingham{viscosity, yield_stress, 0.0};
    SolidStage stage;
    stage.window = {0, 0, 10, 10};
    stage.law = law;
    FlowParticles particles;
    particles.x = particles.y = {5.0}, particles.bed = {0.0}, particles.depth = {depth},
    particles.slope_x = particles.slope_y = {0.0};
    particles.vx = {0.0}, particles.vy = {0.0}, particles.mass = {density * depth}, particles.volume = {depth};
    particles.bed_pressure = {0.0}, particles.id = {0.0}, particles.domain = {Mat2::Identity()};
    // At rest it may come to what its weight drives it to, 21 kPa less 0.3 kPa of yield stress, or to a fall by its depth.
    constexpr double own = 2.0889, fall = 4.8522;
    const double held = resolving_cell(law, density, depth, own);
    const auto stuck = [&](double of_held, bool told, bool where_resolved) {
        stage.cell = of_held * held, stage.stuck = told, stage.stuck_where_resolved = where_resolved;
        scene.solid = stage;
        return choose_start(scene, particles).stuck;
    };
    CHECK(stuck(0.99, false, true));
    CHECK_FALSE(stuck(1.01, false, true));
    CHECK_FALSE(stuck(0.99, false, false));
    CHECK(stuck(1.01, true, false));
    CHECK(choose_start(scene, particles).speed == Approx(own).epsilon(1e-4));
    std::get<solid::Bingham>(scene.solid->law).viscosity = 400.0;
    CHECK(choose_start(scene, particles).speed == Approx(fall).epsilon(1e-4));
    particles.vx = {7.0};  // what it has, and the fall besides
    CHECK(choose_start(scene, particles).speed == Approx(std::hypot(7.0, fall)).epsilon(1e-4));
    std::get<solid::Bingham>(scene.solid->law).yield_stress = 22e3;  // more than its weight
    CHECK(choose_start(scene, particles).speed == Approx(7.0));
}

// A slope of 0.1 under half a metre: 880 Pa of 900.
TEST_CASE("Mud that slides by its bed law rests where its yield stress holds it", "[stages]") {
    Scene scene = scene_on(31, 5, 0.5, [](double x, double) { return 10.0 - 0.1 * x; });
    scene.particles = {};
    fill(scene, [](double, double) { return 0.5; });
    scene.sides = Sides::wall;
    scene.density = 1800.0;
    const double yield_stress = GENERATE(900.0, 500.0);
    scene.bed_law = bed::Bingham{20.0, yield_stress, 0.0};
    SolidStage stage;
    stage.window = {0, 0, 30, 4};
    stage.closed = {true, true, true, true};
    stage.cell = 0.25, stage.spacing = 0.125;
    stage.law = solid::Bingham{0.0, 1e5, 20.0, yield_stress};
    stage.whole_bed_law = true;
    scene.solid = stage;
    StagedRun run(scene);
    DepthAveraged particles(scene);
    run_to(run, 1.0), run_to(particles, 1.0);
    const double fall = scene.gravity * 0.1 * 1.0;  // speed in that time without a bed
    if (yield_stress > 880.0)
        CHECK(run.status().mean_speed < 0.01 * fall);
    else  // the walls at both ends disturb it alike
        CHECK(run.status().mean_speed == Approx(particles.status().mean_speed).epsilon(0.1));
}

TEST_CASE("Sand by the bed law is as strong inside as the flow needs, whatever a film at its margin does", "[stages]") {
    constexpr double mu = 0.1, slope = 0.2;
    Scene scene = scene_on(11, 11, 1.0, [](double x, double) { return 50.0 - slope * x; });
    scene.bed_law = bed::Voellmy{mu, 500.0};
    SolidStage stage;
    stage.window = {0, 0, 10, 10};
    stage.of_bed = stage.whole_bed_law = true;
    stage.bed_friction = mu;
    scene.solid = stage;
    const auto add = [&](FlowParticles& particles, double depth, double speed) {
        FlowParticles one;
        one.x = one.y = {5.0}, one.bed = {49.0}, one.depth = {depth}, one.slope_x = {-slope}, one.slope_y = {0.0};
        one.vx = {speed}, one.vy = {0.0}, one.mass = {1000.0 * depth}, one.volume = {depth}, one.bed_pressure = {0.0};
        one.id = {0.0}, one.domain = {Mat2::Identity()};
        particles.take(one, 0);
    };
    FlowParticles still;
    add(still, 2.0, 0.0);
    const double cosine = 1.0 / std::hypot(1.0, slope), fall = 49.0 + 2.0 - 48.0;  // to the window's eastern edge
    CHECK(choose_start(scene, still).friction ==
          Approx(mu + 2.0 * scene.gravity * fall / (500.0 * 2.0 * cosine * cosine)).epsilon(1e-3));
    scene.bed_law = bed::Voellmy{mu, 200.0};  // on a way that is long enough, what the slope gives
    CHECK(choose_start(scene, still).friction == Approx(slope));
    scene.bed_law = bed::Voellmy{mu, 1e9};  // in the end Coulomb's
    CHECK(choose_start(scene, still).friction == Approx(mu));
    scene.bed_law = bed::Voellmy{mu, 500.0};
    FlowParticles fast;
    add(fast, 2.0, 20.0);
    // Voellmy: mu + v^2 / (xi h cos), v along the bed and h across it.
    const double along = 20.0 / cosine;
    const double of_bulk = mu + along * along / (500.0 * 2.0 * cosine * cosine);
    REQUIRE(of_bulk > 0.4);
    CHECK(choose_start(scene, fast).friction ==
          Approx(of_bulk).epsilon(1e-3));  // to the step that finds a deceleration
    add(fast, 0.01, 25.0);
    CHECK(choose_start(scene, fast).friction < 1.01 * of_bulk);
    scene.solid->whole_bed_law = false, scene.solid->bed_friction = 0.8;
    CHECK(choose_start(scene, fast).friction == 0.8);
    scene.solid->bed_friction = 0.0;
    CHECK(choose_start(scene, fast).friction == mu);
}

// At an open edge half of what a node holds is particles. Without them the flow would seem half as deep there.
TEST_CASE("The flow that a bed law sees at the edge of points has the particles beyond it", "[stages]") {
    constexpr double slope = 0.2, depth = 2.0, speed = 5.0, spacing = 0.5;
    Scene scene = scene_on(21, 11, 1.0, [](double x, double) { return 50.0 - slope * x; });
    scene.density = 1000.0;
    FlowMap map(scene);
    SolidScene space;
    space.density = scene.density;
    space.law = solid::Fluid{1e6, 0.0};
    space.grid = {Vec3(-1, -1, 40), 0.5, {47, 27, 40}};
    FlowParticles particles;
    for (double x = 0.25; x < 20.0; x += spacing)
        for (double y = 0.25; y < 10.0; y += spacing) {
            const double mass = scene.density * depth * spacing * spacing, bed = 50.0 - slope * x;
            if (x < 10.0) {
                FlowParticles one;
                one.x = {x}, one.y = {y}, one.bed = {bed}, one.depth = {depth}, one.slope_x = {-slope},
                one.slope_y = {0.0};
                one.vx = {speed}, one.vy = {0.0}, one.mass = {mass}, one.volume = {mass / scene.density};
                one.bed_pressure = {0.0}, one.id = {0.0}, one.domain = {Mat2::Identity()};
                particles.take(one, 0);
            } else {
                space.points.add({x, y, bed + 1.0}, Vec3(speed, 0.0, -slope * speed), mass, 0.0);
            }
        }
    const Mpm3d points(space);
    map.sample(points, 0.0);
    const FlowMap::Mean half = map.mean_at({10.0, 5.0});
    for (int told = 0; told < 2; ++told) {  // the second time in place of the first
        map.set_adjacent(particles);
        for (const double x : {5.0, 9.5, 10.0, 10.5, 15.0}) {
            const FlowMap::Mean here = map.mean_at({x, 5.0});
            CHECK(here.depth == Approx(depth).epsilon(1e-12));
            CHECK(here.speed == Approx(speed * std::hypot(1.0, slope)).epsilon(1e-12));
        }
    }
    CHECK(half.depth == Approx(0.5 * depth));
    CHECK(map.at({10.0, 5.0}).depth == Approx(0.5 * depth));  // the points' own, as before
}

// On Frank's slope points that had come apart had friction coefficients of hundreds by Voellmy's law, since the mean depth
// around them was millimetres. Others ran into those that stood, and points shot out with 1455 m/s.
TEST_CASE("Points that lie apart have the friction of a flow as thick as they are", "[stages]") {
    constexpr double mu = 0.15, xi = 500.0, speed = 30.0, spacing = 0.5;
    Scene scene = scene_on(21, 11, 1.0, [](double, double) { return 0.0; });
    scene.density = 1000.0, scene.bed_law = bed::Voellmy{mu, xi};
    FlowMap map(scene);  // of all the terrain, since no window is given
    scene.solid.emplace();
    scene.solid->spacing = spacing;
    SolidScene space;
    space.density = scene.density;
    space.law = solid::Fluid{1e6, 0.0};
    space.grid = {Vec3(-1, -1, -1), 0.5, {47, 27, 20}};
    const auto coefficient = [&](double mass) {
        SolidScene one = space;
        one.points.add({10.0, 5.0, 0.25}, Vec3(speed, 0.0, 0.0), mass, 0.0);
        map.sample(Mpm3d(one), 0.0);
        return BedFriction(scene, map).coefficient({10.0, 5.0, 0.0});
    };
    // To the step that finds a deceleration.
    CHECK(coefficient(1.0) == Approx(mu + speed * speed / (xi * spacing)).epsilon(1e-3));
    const double deep = 2.0 * scene.density;  // on a node of 1 m
    CHECK(coefficient(deep) == Approx(mu + speed * speed / (xi * 2.0)).epsilon(1e-3));
}

TEST_CASE("Where the window's edge lies at a break of slope, the ground gives no energy", "[stages]") {
    // Down 31 degrees onto a flat: what comes to the edge must not be pressed into the ground behind it.
    Scene scene = scene_on(71, 9, 1.0, [](double x, double) { return std::max(0.0, 0.6 * (40.0 - x)); });
    scene.particles = {};
    fill(scene, [](double x, double) { return x > 5 && x < 20 ? 3.0 : 0.0; });
    scene.sides = Sides::wall;
    SolidStage stage;
    const double break_at = GENERATE(39, 40, 41);
    stage.window = {static_cast<Index>(break_at), 0, 70, 8};
    stage.cell = 1.0;
    stage.spacing = 0.5;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    StagedRun run(scene);
    const auto energy = [&] {
        const Status& now = run.status();
        return now.kinetic + now.potential + now.stored + now.energy_left;
    };
    const double before = energy();
    double most = 0.0;
    while (run.status().time < 5.0) run.advance(5.0), most = std::max(most, energy());
    CAPTURE(break_at);
    REQUIRE(run.points()->status().points > 500);
    CHECK(most / before < 1.03);  // 1.22, 1.57, 1.04 with the slope at the place itself
}

TEST_CASE("Ground that is not known ahead leaves particles their own slope", "[stages]") {
    constexpr double kSlope = -0.6, kEdge = 10.0;
    Raster bed = scene_on(21, 5, 1.0, [](double x, double) { return kSlope * x; }).bed;
    const GridGeometry& g = bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (g.x(i) > kEdge) bed.at(i, j) = std::numeric_limits<double>::quiet_NaN();
    FlowParticles particles;
    particles.x = {kEdge - 0.75}, particles.y = {g.y(2)}, particles.vx = {3.0}, particles.vy = {0.0};
    take_slopes(particles, bed);
    look_ahead(particles, bed, 2.0);
    CHECK(particles.slope_x[0] == Approx(kSlope));  // 0, as of a flat, when the unknown counted
}

TEST_CASE("Points meet particles by steps of equal length", "[stages]") {
    const Scene scene = slide();
    StagedRun run(scene);
    while (!run.points()) run.advance(scene.end);
    double before = 0.0;
    Index meetings = 0, shorter = 0;
    while (run.status().time < scene.end) {
        const double meeting = run.particles().status().time;
        run.advance(scene.end);
        const double dt = run.points()->status().dt;
        // The same n steps lead to a meeting, unless the longest step changes by 1 / n.
        if (run.particles().status().time > meeting)
            ++meetings;
        else
            shorter += dt < 0.99 * before;
        before = dt;
    }
    CAPTURE(meetings, shorter);
    REQUIRE(meetings > 20);
    CHECK(shorter < meetings / 4);  // one a meeting was
}

TEST_CASE("A 3D frame has the mass of both models on its particles and on its nodes", "[stages]") {
    const Scene scene = slide();
    StagedRun run(scene);
    run_to(run, 0.6);
    Frame frame = run.frame();
    const Field *mass = frame.particle("mass"), *model = frame.particle("model"), *depth = frame.node("depth");
    REQUIRE(mass->count == frame.status.particles);
    const double points = total(model, 0, model->count);
    CHECK(points == static_cast<double>(run.points()->status().points));
    CHECK(total(mass, 0, mass->count) == Approx(frame.status.mass).epsilon(1e-12));
    // Nodes hold all that lies between them; at open sides nothing is yet.
    const double on_nodes = scene.density * total(depth, 0, depth->count);
    CHECK(on_nodes == Approx(frame.status.mass).epsilon(1e-12));
    CHECK(frame.particle("stress")->components == 6);
    const Sample probe = run.at({16.3, 6.1});
    CHECK(probe.depth > 0.5);
    CHECK(probe.velocity.x() > 6.0);
}

TEST_CASE("A window that nothing has reached yet waits with sound and room for what comes", "[stages]") {
    Scene scene = slide();
    scene.solid->window = {24, 0, 36, 12};
    StagedRun run(scene);
    const double mass = run.status().mass;
    run_to(run, scene.solid->from);
    CHECK(run.points()->status().points == 0);
    CHECK(run.points()->body().grid.geometry().nodes[2] > 20);
    run_to(run, 2.0);
    CHECK(run.points()->status().points > 1000);
    CHECK(mass_error(run.status(), mass) < 1e-12);
    // Sound is ten times as fast as the 8 m/s and more of the particles: points of water stay nearly as dense.
    CHECK(run.points()->status().volume == Approx(run.points()->status().mass / scene.density).epsilon(0.02));
}

TEST_CASE("Points that have more energy than the release could give are remarked upon, with what the others did",
          "[stages]") {
    Scene scene = slide(0.0);
    StagedRun within(scene);
    run_to(within, 0.2);
    for (const std::string& remark : within.remarks()) CHECK(remark.find("highest head") == std::string::npos);
    // What the release is said to have is less than it has: as if its points had gained energy. 8 m/s on the map, on a
    // slope of 1 in 4.
    Spray less([&] {
        Scene low = scene;
        low.particles.vx.assign(low.particles.x.size(), 0.0);
        return low;
    }());
    less.sample(*within.points());
    CHECK(less.available() ==
          Approx(Spray(scene).available() - 8.0 * 8.0 * (1.0 + 0.25 * 0.25) / (2.0 * scene.gravity)));
    CHECK(less.most_share() > 0.0);
    REQUIRE(less.remark());
    CHECK(less.remark()->find("more energy than a fall from the release's highest head") != std::string::npos);
}

TEST_CASE("A 3D stage from the start takes the release as it is", "[stages]") {
    Scene scene = slide(0.0);
    scene.solid->window = {0, 0, 40, 12};
    StagedRun run(scene);
    const SolidStatus& points = run.points()->status();
    CHECK(run.particles().status().particles == 0);
    CHECK(points.mass == Approx(scene.density * 12 * 6 * 1.5).epsilon(1e-12));
    CHECK(points.points == 48 * 24 * 6);
    CHECK(points.momentum.x() == Approx(8.0 * points.mass).epsilon(1e-12));
    // Along the bed: the vertical velocity is the slope's.
    CHECK(points.momentum.z() == Approx(-2.0 * points.mass).epsilon(1e-12));
}

TEST_CASE("Sand starts pressed from all sides by its column's weight, as fluids do", "[stages]") {
    Scene scene = slide(0.0);
    std::fill(scene.bed.values.begin(), scene.bed.values.end(), 20.0);
    scene.solid->window = {0, 0, 40, 12};
    const double phi = 0.5, young = 2e6;
    for (const SolidLaw& law : {SolidLaw(solid::Fluid{}), SolidLaw(solid::Elastic::of(young, 0.3)),
                                SolidLaw(solid::DruckerPrager::of(solid::Elastic::of(young, 0.3), phi, 0.0))}) {
        scene.solid->law = law;
        const StagedRun run(scene);
        const Mpm3d& points = *run.points();
        double worst = 0.0;
        for (Index p = 0; p < points.body().points.count(); ++p) {
            const double weight = scene.density * scene.gravity * (21.5 - points.position(p).z());
            const Sym3 s = points.stress(p);
            for (const double part : {s.xx + weight, s.yy + weight, s.zz + weight, s.xy, s.yz, s.xz})
                worst = std::max(worst, std::abs(part));
        }
        CHECK(worst < 1e-9 * young);  // round-off of strains, times the stiffness
        CHECK(points.status().stored > 0.0);
    }
}

TEST_CASE("Points do not cross a closed side that particles still flow in over", "[stages]") {
    Scene scene = slide(0.05);
    std::fill(scene.bed.values.begin(), scene.bed.values.end(), 20.0);
    scene.particles.vx.assign(scene.particles.x.size(), 0.0);  // slower than its waves
    const auto left_of = [&](Index first, bool closed) {
        scene.solid->window[0] = first;
        scene.solid->closed = {closed, true, true, true};
        StagedRun run(scene);
        run_to(run, 0.8);
        CHECK(mass_error(run.status(), scene.density * 12 * 6 * 1.5) < 1e-12);
        CHECK(run.points()->status().mass > 0.1 * run.status().mass);
        return run.points()->status().mass_left;
    };
    CHECK(left_of(12, true) == 0.0);
    CHECK(left_of(12, false) == 0.0);  // what stands beyond the edge holds them
    CHECK(left_of(3, true) == 0.0);
    CHECK(left_of(3, false) > 0.0);  // nothing does
}

namespace {

/// Runs to `end`, and again from what was kept at each stop, with other numbers of threads.
void take_up_again(const Scene& scene, const std::vector<double>& stops, double end, bool some_return) {
    const int threads = omp_get_max_threads();
    StagedRun straight(scene);
    std::vector<MemoryArchive> kept(stops.size());
    bool returning = false;
    for (std::size_t n = 0; n < stops.size(); ++n) {
        while (straight.status().time < stops[n]) straight.advance(end);
        straight.serialize(kept[n]);
        returning = returning || !kept[n].entries().at("returning").bytes.empty();
    }
    CHECK(returning == some_return);
    run_to(straight, end);
    CHECK((straight.points()->status().points == 0) == scene.solid->until.has_value());
    const auto expected = state_bits(straight);
    for (const int other : {1, 2, 4}) {
        omp_set_num_threads(other);
        for (std::size_t n = 0; n < stops.size(); ++n) {
            StagedRun resumed(scene, Start::resumed);
            resumed.serialize(kept[n].rewind());
            run_to(resumed, end);
            const auto found = state_bits(resumed);
            REQUIRE(found.size() == expected.size());
            for (const auto& [name, entry] : expected) {
                INFO(name << " with " << other << " threads, from " << stops[n] << " s");
                CHECK((found.at(name) == entry));
            }
        }
    }
    omp_set_num_threads(threads);
}

}  // namespace

TEST_CASE("Runs in stages have the same bits for any number of threads, and when taken up again", "[stages][threads]") {
    take_up_again(slide(), {0.3, 0.55}, 0.7, false);
}

TEST_CASE("So have runs whose particles take up their bed before the window", "[stages][threads][erosion]") {
    take_up_again(over_loose_ground(), {0.3, 0.55}, 0.7, false);
}

TEST_CASE("Particles take up their bed before and beside a 3D stage, and the bed in its window stays",
          "[stages][erosion]") {
    const Scene scene = over_loose_ground();
    StagedRun run(scene);
    const Frame start = run.frame();
    const Status first = start.status;
    const std::vector<double> ground(start.node("elevation")->data, start.node("elevation")->data + start.grid.size());
    double before = 0.0;
    while (run.status().time < scene.end) {
        run.advance(scene.end);
        CHECK(std::abs(budget(first, run.status()).mass_error) <= 1e-13);
        if (!run.points()) before = run.status().bed.eroded;
    }
    CHECK(before > 0.02 * first.mass);
    CHECK(run.status().bed.eroded > before);  // the tail goes on
    CHECK(run.points()->status().points > 1000);
    const Frame frame = run.frame();
    const Field& elevation = *frame.node("elevation");
    const std::array<Index, 4>& w = scene.solid->window;
    double deepest = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const Index k = j * frame.grid.nx + i;
            const double sunk = ground[static_cast<std::size_t>(k)] - elevation.data[k];
            deepest = std::max(deepest, sunk);
            // A plane: the particles' bed, a mean of nodes around, is the points' ground to round-off.
            if (i >= w[0] - 2) CHECK(sunk == Approx(0.0).margin(i >= w[0] ? 1e-13 : 0.0));
        }
    CHECK(deepest > 0.05);
}

TEST_CASE("So have runs whose ground brakes points by the whole bed law", "[stages][threads]") {
    Scene scene = slide();
    scene.bed_law = bed::Voellmy{0.1, 200.0};
    scene.solid->law = solid::DruckerPrager::of({}, std::atan(0.1), 0.0);
    scene.solid->of_bed = scene.solid->whole_bed_law = true;
    scene.solid->transfer = Transfer::flip, scene.solid->blending = 0.2;
    take_up_again(scene, {0.3, 0.55}, 0.7, false);
}

// Those that came in last lie at the edge, where the bed law would go on to count the particles that they were.
TEST_CASE("So have runs whose particles have all become points", "[stages][threads]") {
    Scene scene = slide_through();
    scene.solid->window = {12, 0, 30, 12};
    scene.bed_law = bed::Voellmy{0.1, 200.0};
    scene.solid->law = solid::DruckerPrager::of({}, std::atan(0.1), 0.0);
    scene.solid->of_bed = scene.solid->whole_bed_law = true;
    scene.solid->transfer = Transfer::flip, scene.solid->blending = 0.2;
    scene.solid->closed = {false, true, true, true};
    StagedRun run(scene);
    while ((!run.points() || run.particles().status().particles > 0) && run.status().time < scene.end)
        run.advance(scene.end);
    const double gone = run.status().time + 0.01;
    REQUIRE(gone < 1.5);
    take_up_again(scene, {gone}, gone + 0.15, false);
}

TEST_CASE("So have runs whose points become particles, on their way when it stops, and whose 3D stage ends",
          "[stages]") {
    Scene scene = slide_through();
    scene.solid->until = 0.95;
    take_up_again(scene, {0.85, 0.9, 0.97}, 1.0, true);
}

TEST_CASE("3D points begin with the same bits whatever the time between the frames before", "[stages]") {
    const Scene scene = slide();
    const auto begun = [&](double every) {
        StagedRun staged(scene);
        Observers nobody;
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        const RunSummary summary = run(staged, {scene.solid->from, every, false}, nobody, Interrupt(), progress);
        CHECK(summary.frames == 1 + static_cast<Index>(std::ceil(scene.solid->from / every)));
        REQUIRE(staged.points() != nullptr);
        return state_bits(staged);
    };
    const auto seldom = begun(1000.0);
    for (const double every : {0.0031, 0.07}) CHECK((begun(every) == seldom));
}

TEST_CASE("A conversion refused on the way ends the run as refused, with the last frame of its step", "[stages]") {
    // Thin in front; what follows stands 3 m high, above the top over the window's edge at 17.1 m.
    Scene scene = slide();
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 3 && x < 13 && y > 3 && y < 9 ? (x < 7 ? 3.0 : 0.5) : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.solid->top = 18.5;
    StagedRun alone(scene);
    const double mass = alone.status().mass;
    Index steps = 0;
    const auto to_the_refusal = [&] {
        while (alone.status().time < scene.end) ++steps, alone.advance(scene.end);
    };
    CHECK_THROWS_AS(to_the_refusal(), UserError);
    REQUIRE(alone.points() != nullptr);
    REQUIRE(alone.points()->status().time > scene.solid->from);

    StagedRun staged(scene);
    Observers nobody;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    const RunSummary summary = run(staged, {scene.end, 1000.0, false}, nobody, Interrupt(), progress);
    CHECK(summary.reason == "refused");
    REQUIRE(summary.failure);
    CHECK_THROWS_AS(std::rethrow_exception(summary.failure), UserError);
    CHECK(summary.failure_text.rfind("stage.top: found 18.5 m; expected more than ", 0) == 0);
    CHECK(summary.frames == 2);
    CHECK(summary.steps == steps);
    CHECK(summary.last.step == steps);
    CHECK(summary.last.time == alone.points()->status().time);
    CHECK(staged.status().time == summary.last.time);
    CHECK(mass_error(summary.last, mass) < 1e-12);
}

TEST_CASE("Points that leave their window onto a wall in a hole become particles before it", "[stages][holes]") {
    Scene scene = slide_through();
    for (const Index i : {19, 20})
        for (const Index j : {5, 6, 7}) scene.bed.at(i, j) = Raster::nodata;
    scene.holes = holes_of(scene.bed);
    scene.hole_top = 3.0;
    scene.sides = Sides::wall;
    StagedRun run(scene);
    const double mass = run.status().mass;
    double behind = 0.0;
    Index points = 0;
    while (run.status().time < 1.6) {
        run.advance(1.6);
        if (run.points()) points = std::max(points, run.points()->status().points);
        const Status& now = run.status();
        REQUIRE(std::abs(now.mass + now.mass_left - mass) < 1e-12 * mass);
        REQUIRE(now.mass_left < 1e-12 * mass);
        const Particles& c = run.particles().flow().particles;
        for (Index p = 0; p < c.count(); ++p)
            if (c.x[p] > 20.5) behind = std::max(behind, c.mass[p]);
    }
    CHECK(points > 100);
    CHECK(behind > 0.0);  // some went round it
}

TEST_CASE("Points that leave their window onto the wall of a hole as wide as the window are remarked upon",
          "[stages][holes]") {
    Scene scene = slide();
    scene.solid->window = {12, 0, 18, 12};
    for (Index i = 19; i <= 28; ++i)
        for (Index j = 1; j <= 11; ++j) scene.bed.at(i, j) = Raster::nodata;
    scene.holes = holes_of(scene.bed);
    scene.hole_top = 3.0;
    scene.sides = Sides::wall;
    StagedRun run(scene);
    const double mass = run.status().mass;
    run_to(run, 0.8);
    CHECK(mass_error(run.status(), mass) < 1e-12);
    const std::vector<std::string> remarks = run.remarks();
    CHECK(std::any_of(remarks.begin(), remarks.end(), [](const std::string& remark) {
        return remark.find("m3 became particles on ground that barriers or walls in holes raise") != std::string::npos;
    }));
}

TEST_CASE("Points that become particles are as deep as what is there, and at least as all that is new", "[stages]") {
    Scene scene = slide();  // cells of 1 m: quarters of 0.25 m2
    scene.density = 2000.0;
    const auto point = [](double x, double y, double mass) {
        DepartedPoint p{};
        p.time = 1.0, p.position = {x, y, 0.0}, p.mass = mass;
        return p;
    };
    // Two on one quarter, one on another.
    const std::vector<DepartedPoint> points = {point(20.1, 5.1, 30.0), point(20.3, 5.2, 70.0), point(22.6, 5.1, 100.0)};
    const ParticlesAt at{1.0, [](const DepartedPoint&, const Vec2& to) { return to; },
                         [](const Vec2& x) { return x.x() < 21.0 ? 0.05 : 0.7; }};
    const Seeds seeds = particles_of(points, scene, at).seeds;
    REQUIRE(seeds.count() == 2);
    CHECK(seeds.depth[0] == Approx(100.0 / 2000.0 / 0.25).epsilon(1e-14));  // new material stands higher than 0.05 m
    CHECK(seeds.depth[1] == 0.7);
    CHECK(seeds.volume[0] == Approx(0.05).epsilon(1e-14));
    CHECK(seeds.x[0] == Approx(0.3 * 20.1 + 0.7 * 20.3).epsilon(1e-14));
}

TEST_CASE("The map of points follows whenever they may have moved by a quarter of its cell", "[stages]") {
    const Scene scene = slide(0.0);
    StagedRun run(scene);
    REQUIRE(run.points() != nullptr);
    const auto seen = [&] {
        std::vector<double> depths;
        for (double x = 12.0; x <= 30.0; x += 1.0)
            depths.push_back(run.at({x, 6.0}).depth - run.particles().at({x, 6.0}).depth);
        return depths;
    };
    std::vector<double> before = seen();
    const double quarter = 0.25 * scene.bed.geometry.cell;
    double way = 0.0;
    int looks = 0, steps = 0;
    while (run.status().time < 0.3) {
        run.advance(1e9);  // no time of output
        const SolidStatus& now = run.points()->status();
        way += now.max_speed * now.dt, ++steps;
        const std::vector<double> after = seen();
        if (after != before) way = 0.0, ++looks, before = after;
        REQUIRE(way < quarter);
    }
    // Not in every step either: a step goes a small part of that way. 8 m/s and more, for 0.3 s.
    CHECK(looks >= 8);
    CAPTURE(steps);
    CHECK(looks < steps / 2);
}
