// How far a step goes, and what friction may do to a point's own velocity.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A film of 1 mm at rest on the edge of a cliff of 60 cells, whose drive is its slope (shallow terrain).
Scene film_on_cliff() {
    Scene scene = scene_on(24, 12, 1.0, [](double x, double) { return x < 6.5 ? 60.0 : 0.0; });
    scene.terrain = TerrainModel::shallow;
    fill(scene, [](double x, double y) { return x > 3 && x < 6 && y > 4 && y < 8 ? 1e-3 : 0.0; });
    return scene;
}

/// Largest distance of a point from where it was [cells].
double farthest(const Particles& before, const Particles& now) {
    double most = 0.0;
    for (Index p = 0; p < before.count(); ++p)
        for (Index q = 0; q < now.count(); ++q)
            if (now.id[q] == before.id[p])
                most = std::max({most, std::abs(now.x[q] - before.x[p]), std::abs(now.y[q] - before.y[p])});
    return most;
}

}  // namespace

TEST_CASE("A film at rest on a cliff of many cells begins with a step that it can take", "[conserve][steps]") {
    const Scene scene = film_on_cliff();
    DepthAveraged simulation(scene);
    double fastest = 0.0, most = 0.0;
    while (simulation.status().step < 12) {
        const Particles before = simulation.flow().particles;
        REQUIRE_NOTHROW(simulation.advance(1e9));
        fastest = std::max(fastest, simulation.status().max_speed_on_map);
        if (simulation.status().step == 1) most = farthest(before, simulation.flow().particles);
    }
    CHECK(most > 0.1 * scene.scheme.cfl);  // it did begin to fall
    CHECK(most <= 2.0 * scene.scheme.cfl);
    CHECK(fastest > 10.0);
    CHECK(fastest <= 1.25 * std::sqrt(2 * scene.gravity * 60.0));  // of the fall; a quarter: checks/fuzz/invariants.h
}

TEST_CASE("Where nothing is driven far, a step follows from its signal", "[conserve][steps]") {
    Scene scene = scene_on(40, 12, 1.0, [](double, double) { return 0.0; });
    fill(scene, [](double x, double) { return x < 20 ? 2.0 : 0.0; });
    DepthAveraged simulation(scene);
    const double reach = scene.scheme.cfl * 1.0, c = std::sqrt(scene.gravity * simulation.status().max_depth);
    simulation.advance(1e9);
    CHECK(simulation.status().dt ==
          Approx(2 * reach / (c + std::sqrt(c * c + 2 * scene.gravity * reach))).epsilon(1e-14));
}

TEST_CASE("A step that is shortened ends at its time, and observing the run changes nothing", "[conserve][steps]") {
    DepthAveraged one(film_on_cliff()), other(film_on_cliff());
    run_to(one, 0.5);
    other.frame();
    run_to(other, 0.5);
    CHECK(one.status().time == 0.5);
    CHECK(one.flow().particles.x == other.flow().particles.x);
    CHECK(one.status().step == other.status().step);
}

TEST_CASE("Friction drives no point of flip: what it takes of the nodes' velocity it takes of the points'",
          "[conserve][flip]") {
    // A light film runs against a heavy block that the bed stops in a few steps.
    Scene scene = scene_on(24, 12, 1.0, [](double, double) { return 0.0; });
    scene.scheme.transfer = Transfer::flip;
    scene.scheme.flip_ratio = 1.0;
    scene.bed_law = bed::Voellmy{0.4, 1.0};
    fill(scene, [](double x, double y) {
        return y < 4 || y > 8 ? 0.0 : x > 6 && x < 9 ? 0.2 : x > 9 && x < 13 ? 2e-4 : 0.0;
    });
    for (Index p = 0; p < scene.particles.count(); ++p) scene.particles.vx[p] = scene.particles.x[p] < 9 ? 30.0 : -30.0;
    DepthAveraged simulation(scene);
    double fastest = 0.0;
    while (simulation.status().step < 20) {
        simulation.advance(1e9);
        for (const double v : simulation.flow().particles.vx) fastest = std::max(fastest, std::abs(v));
    }
    CHECK(fastest <= 31.5);  // 30, and a twentieth for the pressure of the block's 0.2 m
    const Status now = simulation.frame().status;
    const double change = now.momentum[0] + now.momentum_left[0] - now.impulse[0];
    double start = 0.0, size = 0.0;
    for (Index p = 0; p < scene.particles.count(); ++p) {
        const double m = scene.density * scene.particles.volume[p];
        start += m * scene.particles.vx[p], size += m * std::abs(scene.particles.vx[p]);
    }
    CHECK(std::abs(change - start) <= 1e-12 * size);  // sums of some hundred terms in twenty steps
}

TEST_CASE("Linear shapes, PIC and FLIP take no more viscosity in a step than is stable for them", "[conserve][steps]") {
    const auto [shape, transfer] =
        GENERATE(std::pair(Shape::linear, Transfer::tpic), std::pair(Shape::quadratic, Transfer::pic),
                 std::pair(Shape::quadratic, Transfer::flip));
    const auto run = [&, shape = shape, transfer = transfer](double cap) {
        Scene scene = scene_on(24, 24, 1.0, [](double, double) { return 0.0; });
        scene.scheme.shape = shape;
        scene.scheme.transfer = transfer;
        scene.scheme.stress_cap = cap;
        scene.rheology = rheology::Newtonian{1e7};
        fill(scene, [](double x, double y) { return std::hypot(x - 12, y - 12) < 6 ? 0.3 : 0.0; });
        DepthAveraged simulation(scene);
        while (simulation.status().step < 20) simulation.advance(1e9);
        return simulation.flow().particles.x;
    };
    CHECK(run(0.5) == run(0.25));
    CHECK(run(0.25) != run(0.1));
}

TEST_CASE("Viscosity gives lone particles of any transfer no energy", "[conserve][steps]") {
    const auto transfer = GENERATE(Transfer::pic, Transfer::flip, Transfer::tpic, Transfer::apic);
    const double at = GENERATE(0.0, 0.2, 0.5);
    CAPTURE(static_cast<int>(transfer), at);
    Scene scene = scene_on(24, 24, 1.0, [](double, double) { return 0.0; });
    scene.scheme.transfer = transfer;
    scene.scheme.flip_ratio = 1.0;
    scene.scheme.stress_cap = 0.5;
    scene.rheology = rheology::Newtonian{1e7};
    fill(
        scene, [](double x, double y) { return std::abs(x - 12) < 1 && std::abs(y - 12) < 1 ? 1e-3 : 0.0; }, 1, at, at);
    for (Index p = 0; p < scene.particles.count(); ++p) {
        scene.particles.vx[p] = scene.particles.y[p] > 12 ? 1.0 : -1.0;
        scene.particles.vy[p] = scene.particles.x[p] > 12 ? 1.0 : -1.0;
    }
    DepthAveraged simulation(scene);
    simulation.advance(1e9);
    const double start = simulation.status().kinetic + simulation.status().potential;
    while (simulation.status().step < 40) {
        simulation.advance(1e9);
        // A tenth as in checks/fuzz/invariants.h; what is unstable grows by the step.
        REQUIRE(simulation.status().kinetic <= 1.1 * start);
    }
}

TEST_CASE("Between nodes the flow is what it is on them, linearly; the outer half pixel shows its edge",
          "[conserve][steps]") {
    // A sheet that falls with the bed: depth and velocity are the same on all its nodes.
    Scene scene = scene_on(24, 16, 2.0, [](double x, double y) { return 3.0 + 0.25 * x - 0.5 * y; });
    scene.bed_law = bed::Coulomb{2.0};
    fill(scene, [](double, double) { return 0.5; });
    const DepthAveraged simulation(scene);
    const GridGeometry& g = simulation.flow().grid.geometry();
    for (const Vec2& place : {Vec2{10.25, 9.0}, Vec2{11.0, 10.75}, Vec2{12.625, 13.375}}) {
        const Sample sample = simulation.at(place);
        CHECK(sample.elevation == Approx(3.0 + 0.25 * place.x() - 0.5 * place.y()).epsilon(1e-14));
        CHECK(sample.depth == Approx(0.5).epsilon(1e-12));
        CHECK(sample.velocity == Vec2(0.0, 0.0));
    }
    CHECK(simulation.at({g.x0 - 1.0, g.y0 + 5.0}).elevation == simulation.at({g.x0, g.y0 + 5.0}).elevation);
}

TEST_CASE("A stop by gravity and friction together lets no difference of flip's points grow", "[conserve][flip]") {
    // Uphill at the speed that gravity takes away in the first grid update, found by repetition; points' own velocities
    // differ.
    const double slope = 0.3, own = 0.01;
    double uphill = 0.0, fastest = 0.0;
    for (int trial = 0; trial < 40; ++trial) {
        Scene scene = scene_on(24, 24, 1.0, [&](double x, double) { return slope * x; });
        scene.scheme.transfer = Transfer::flip;
        scene.scheme.flip_ratio = 1.0;
        scene.bed_law = bed::Coulomb{0.6};
        fill(scene, [](double x, double y) { return std::abs(x - 12) < 1 && std::abs(y - 12) < 1 ? 1e-3 : 0.0; });
        for (Index p = 0; p < scene.particles.count(); ++p) scene.particles.vx[p] = uphill + (p % 2 == 0 ? own : -own);
        DepthAveraged simulation(scene);
        simulation.advance(1e9);
        for (const double v : simulation.flow().particles.vx) fastest = std::max(fastest, std::abs(v) - uphill - own);
        uphill = 0.5 * simulation.status().dt * scene.gravity * slope / (1.0 + slope * slope);
    }
    REQUIRE(uphill > own);
    CHECK(fastest <= 0.01 * own);  // the thin depth's pressure
}

TEST_CASE("Points of flip that lie on opposite walls stay mirrored", "[conserve][flip]") {
    const double cell = 1.0 / 3.0, top = 28 * cell;  // top + 1e-19 is top, and 1e-19 is not zero
    Scene scene = scene_on(24, 29, cell, [](double, double) { return 0.0; });
    scene.sides = Sides::wall;
    scene.scheme.transfer = Transfer::flip;
    scene.scheme.flip_ratio = 1.0;
    fill(scene, [&](double x, double y) { return x < 3.0 && std::min(y, top - y) < 2.0 ? 1.0 : 0.0; });
    const Index last = scene.particles.count() - 1;
    for (const Index p : {Index{0}, last}) {
        scene.particles.y[p] = p == 0 ? 1e-19 : top;
        scene.particles.vy[p] = p == 0 ? -1.0 : 1.0;
    }
    scene.particles.x[last] = scene.particles.x[0];
    DepthAveraged simulation(scene);
    while (simulation.status().step < 7) {
        simulation.advance(1e9);
        const Particles& c = simulation.flow().particles;
        int on_walls = 0;
        for (Index p = 0; p < c.count(); ++p)
            if (c.id[p] == 0 || c.id[p] == last) {
                CAPTURE(simulation.status().step, c.id[p], c.y[p]);
                CHECK(c.vy[p] == 0.0);
                CHECK((c.y[p] == 0.0 || c.y[p] == 28.0));
                ++on_walls;
            }
        REQUIRE(on_walls == 2);
    }
}
