// Mass, momentum, bits: what every run keeps, whatever the scene.
#include <omp.h>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"

using namespace frana;
using namespace frana::test;

namespace {

/// Fois et al. 2024, section 4.2: mud on a slope with a bump, mirror-symmetric about y = 10.
Scene obstacle(double cell = 1.0) {
    const Index nx = static_cast<Index>(150 / cell) + 1, ny = static_cast<Index>(20 / cell) + 1;
    Scene scene = scene_on(nx, ny, cell, [](double x, double y) {
        return 60 - x / 3 + 15 * std::exp(-((x - 50) * (x - 50) + (y - 10) * (y - 10)) / 7);
    });
    scene.density = 1200;
    scene.bed_law = bed::Voellmy{std::tan(12 * constants::kPi / 180.0), 200};
    scene.rheology = rheology::Newtonian{10};
    scene.scheme.curvature_length = 0.0;
    fill(scene, [](double x, double y) { return x > 10 && x < 40 && y > 1.2 && y < 18.8 ? 2.0 : 0.0; });
    return scene;
}

}  // namespace

TEST_CASE("Points and nodes agree in mass and momentum to round-off at every step of the obstacle case", "[conserve]") {
    DepthAveraged simulation(obstacle());
    double mass = 0.0, momentum = 0.0;
    while (simulation.status().time < 3.0) {
        simulation.advance(3.0);
        mass = std::max(mass, simulation.status().p2g_mass_error);
        momentum = std::max(momentum, simulation.status().p2g_momentum_error);
    }
    CAPTURE(mass, momentum);
    CHECK(mass <= 1e-13);  // sums of 1e4 terms in different orders
    CHECK(momentum <= 1e-13);
}

TEST_CASE("A symmetric scene stays symmetric to round-off", "[conserve]") {
    DepthAveraged simulation(obstacle());
    run_to(simulation, 3.0);
    const Frame frame = simulation.frame();
    const Field& depth = *frame.node("depth");
    double worst = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i)
            worst = std::max(worst, std::abs(depth.data[j * frame.grid.nx + i] -
                                             depth.data[(frame.grid.ny - 1 - j) * frame.grid.nx + i]));
    CHECK(frame.status.max_depth > 0.5);
    CHECK(worst <= 1e-10);  // round-off of sums in another order, amplified by a 3 s chaotic splash
}

TEST_CASE("A viscous mass spreads along x as along y, to round-off", "[conserve]") {
    Scene scene = scene_on(41, 41, 1.0, [](double, double) { return 0.0; });
    scene.rheology = rheology::Newtonian{500.0};
    fill(scene, [](double x, double y) { return std::hypot(x - 20, y - 20) < 8 ? 2.0 : 0.0; });
    DepthAveraged simulation(scene);
    run_to(simulation, 1.0);
    const Particles& c = simulation.flow().particles;
    double along_x = 0.0, along_y = 0.0;
    for (Index p = 0; p < c.count(); ++p) {
        along_x += c.mass[p] * std::abs(c.vx[p]);
        along_y += c.mass[p] * std::abs(c.vy[p]);
    }
    CHECK(along_x > 0.1 * simulation.status().mass);
    CHECK(along_x == Approx(along_y).epsilon(1e-10));  // round-off of sums in another order, grown over 1 s
}

TEST_CASE("Mass in, mass left and mass gone out balance to round-off", "[conserve]") {
    Scene scene = scene_on(60, 40, 1.0, [](double x, double y) { return 40 - 0.8 * x + 0.1 * y; });
    scene.bed_law = bed::Voellmy{0.1, 500};
    fill(scene, [](double x, double y) { return std::hypot(x - 25, y - 20) < 8 ? 3.0 : 0.0; });
    DepthAveraged simulation(scene);
    const double mass = simulation.status().mass;
    run_to(simulation, 8.0);
    CHECK(simulation.status().mass_left > 0.5 * mass);
    CHECK(mass_error(simulation.status(), mass) <= 1e-13);
}

TEST_CASE("The momentum of what is here and what left is the impulse of the forces", "[conserve]") {
    Scene scene = scene_on(60, 40, 1.0, [](double x, double y) { return 40 - 0.8 * x + 0.1 * y; });
    scene.bed_law = bed::Voellmy{0.1, 500};
    scene.rheology = rheology::Bingham{50, 200};
    fill(scene, [](double x, double y) { return std::hypot(x - 25, y - 20) < 8 ? 3.0 : 0.0; });
    DepthAveraged simulation(scene);
    run_to(simulation, 8.0);
    const Status& s = simulation.status();
    const double scale = std::abs(s.impulse[0]);
    CHECK(scale > 0.0);
    for (int axis = 0; axis < 2; ++axis)
        CHECK(std::abs(s.momentum[axis] + s.momentum_left[axis] - s.impulse[axis]) / scale <= 1e-12);
}

TEST_CASE("Material that reaches nodata leaves and is counted", "[conserve]") {
    Scene scene = scene_on(60, 40, 1.0, [](double x, double) { return x > 45 ? Raster::nodata : 40 - 0.6 * x; });
    fill(scene, [](double x, double y) { return std::hypot(x - 25, y - 20) < 8 ? 3.0 : 0.0; });
    DepthAveraged simulation(scene);
    const double mass = simulation.status().mass;
    run_to(simulation, 6.0);
    CHECK(simulation.status().mass_left > 0.5 * mass);
    CHECK(mass_error(simulation.status(), mass) <= 1e-13);
    for (const double x : simulation.flow().particles.x) CHECK(x < 46.0);
}

TEST_CASE("One, two and four threads give the same bits", "[conserve][threads]") {
    std::vector<Particles> ends;
    const int threads_before = omp_get_max_threads();
    for (const int threads : {1, 2, 4}) {
        omp_set_num_threads(threads);
        Scene scene = obstacle(0.5);
        scene.rheology = rheology::Bingham{10, 50};
        DepthAveraged simulation(scene);
        REQUIRE(simulation.flow().active.count() >= kTilesForThreads);  // or one thread does it all
        run_to(simulation, 2.0);
        ends.push_back(simulation.flow().particles);
    }
    omp_set_num_threads(threads_before);
    for (std::size_t run = 1; run < ends.size(); ++run) {
        CHECK(ends[run].x == ends[0].x);
        CHECK(ends[run].y == ends[0].y);
        CHECK(ends[run].vx == ends[0].vx);
        CHECK(ends[run].mass == ends[0].mass);
        CHECK(ends[run].id == ends[0].id);
    }
}

TEST_CASE("Looking at a run does not change it", "[conserve]") {
    DepthAveraged alone(obstacle()), watched(obstacle());
    for (int step = 0; step < 40; ++step) {
        alone.advance(3.0);
        watched.advance(3.0);
        watched.frame();
    }
    CHECK(alone.flow().particles.x == watched.flow().particles.x);
    CHECK(alone.flow().particles.vy == watched.flow().particles.vy);
}

TEST_CASE("Looking at a run between walls does not change it, and its momentum closes", "[conserve]") {
    Scene scene = scene_on(16, 40, 1.0, [](double x, double y) { return 10 + 0.3 * x + 0.2 * std::sin(y); });
    scene.sides = Sides::wall;
    scene.scheme.transfer = Transfer::flip;  // reads the nodes' old velocities, ghosts included
    fill(scene, [](double x, double y) { return x > 6 && y < 20 ? 3.0 : 0.0; });
    DepthAveraged alone(scene), watched(scene);
    for (int step = 0; step < 60; ++step) {
        alone.advance(1e9);
        watched.advance(1e9);
        const Status seen = watched.frame().status;
        for (int axis = 0; axis < 2; ++axis)
            REQUIRE(std::abs(seen.momentum[axis] + seen.momentum_left[axis] - seen.impulse[axis]) <=
                    1e-12 * seen.mass * (1.0 + seen.max_speed));
    }
    CHECK(alone.flow().particles.x == watched.flow().particles.x);
    CHECK(alone.flow().particles.vy == watched.flow().particles.vy);
}

TEST_CASE("A plane between walls has no curvature", "[conserve]") {
    Scene scene = scene_on(40, 30, 5.0, [](double x, double y) { return 500 - 0.6 * x + 0.2 * y; });
    scene.sides = Sides::wall;
    fill(scene, [](double x, double) { return x < 50 ? 1.0 : 0.0; });
    const DepthAveraged simulation(scene);
    const Flow& flow = simulation.flow();
    double largest = 0.0;
    for (Index j = 0; j < 30; ++j)
        for (Index i = 0; i < 40; ++i) largest = std::max(largest, std::abs(flow.bed.hxx[flow.grid.at(i, j)]));
    CHECK(largest <= 1e-12);  // round-off of 500 m over 25 m^2
}

TEST_CASE("Stress at the edge of a stencil drives no node away from its points", "[conserve]") {
    for (const Rheology& law : {Rheology{rheology::Bingham{2000, 50}}, Rheology{rheology::Newtonian{1e6}}}) {
        Scene scene = scene_on(80, 40, 2.0, [](double x, double) { return 100 - 0.5 * x; });
        scene.rheology = law;
        scene.bed_law = bed::Coulomb{0.2};
        fill(scene, [](double x, double y) { return std::hypot(x - 40, y - 40) < 20 ? 3.0 : 0.0; });
        DepthAveraged simulation(scene);
        for (int step = 0; step < 150; ++step) {
            simulation.advance(1e9);
            const double points = simulation.status().max_speed_on_map;
            double nodes = 0.0;
            for (const Index tile : simulation.flow().active.work)
                for_each_node_of(simulation.flow().grid, tile, simulation.flow().in_reach[tile],
                                 [&](Index k, Index, Index) {
                                     const Motion& m = simulation.flow().nodes.motions()[k];
                                     nodes = std::max(nodes, std::hypot(m.vx, m.vy));
                                 });
            CAPTURE(step, points, nodes, law.index());
            REQUIRE(nodes <= 3.0 * points);  // a rim node extrapolates its points' velocity gradient
        }
    }
}

TEST_CASE("Splitting follows scheme.split_length also beyond one cell", "[conserve]") {
    Index last = 0;
    for (const double length : {1.2, 1.0, 0.8}) {
        Scene scene = scene_on(60, 60, 1.0, [](double, double) { return 0.0; });
        scene.scheme.split_length = length;
        fill(
            scene, [](double x, double y) { return std::hypot(x - 30, y - 30) < 6 ? 2.0 : 0.0; }, 1);
        DepthAveraged simulation(scene);
        run_to(simulation, 2.0);
        CHECK(simulation.status().particles > 2 * scene.particles.count());
        CHECK(simulation.status().particles >= last);
        last = simulation.status().particles;
    }
}

TEST_CASE("What leaves a steep slope takes its whole kinetic energy along", "[conserve]") {
    Scene scene = scene_on(60, 30, 2.0, [](double x, double) { return 200 - x; });  // 45 degrees, no friction
    fill(scene, [](double x, double y) { return std::hypot(x - 60, y - 29) < 10 ? 1.0 : 0.0; });
    DepthAveraged simulation(scene);
    const double start = simulation.status().potential;
    while (simulation.status().mass > 0.0 && simulation.status().time < 30.0) simulation.advance(30.0);
    CHECK(simulation.status().mass == 0.0);
    const double released = start - simulation.status().energy_left;
    CAPTURE(released / start);
    CHECK(std::abs(released) <= 0.01 * start);  // the vertical half alone would be 15 % of the start's potential
}

TEST_CASE("Frames come at their time exactly", "[conserve]") {
    DepthAveraged simulation(obstacle());
    for (int k = 1; k <= 10; ++k) {
        run_to(simulation, 0.1 * k);
        CHECK(simulation.status().time == 0.1 * k);
    }
}
