// Parts of the step on a few nodes and points, against what they should give.
#include "analytic_scene.h"
#include "catch.h"
#include "shallow/peaks.h"
#include "shallow/sides.h"

using namespace frana;
using namespace frana::test;

namespace {

/// Still water, 2 m deep between walls.
Scene basin(Index nx, Index ny) {
    Scene scene = scene_on(nx, ny, 1.0, [](double, double) { return 0.0; });
    scene.sides = Sides::wall;
    fill(scene, [](double, double) { return 2.0; });
    return scene;
}

Scene slope() {
    return scene_on(40, 40, 2.0, [](double x, double y) { return 0.3 * x - 0.2 * y; });
}

}  // namespace

TEST_CASE("Water between walls covers what lies inside of them", "[nodes]") {
    const DepthAveraged simulation(basin(21, 13));
    CHECK(simulation.status().covered_area == Approx(20.0 * 12.0).epsilon(1e-13));  // sums of halves and quarters
}

TEST_CASE("The last steps before a wanted time are of one length, not a long one and a crumb", "[nodes]") {
    DepthAveraged simulation(basin(21, 13));
    simulation.advance(1e9);
    const double longest = simulation.status().dt, end = simulation.status().time + 2.1 * longest;
    while (simulation.status().time < end) {
        simulation.advance(end);
        CHECK(simulation.status().dt > 0.5 * longest);  // 1, 0.55 and 0.55 of the longest
    }
}

TEST_CASE("A wall turns a point round like a mirror", "[nodes]") {
    Scene scene = slope();
    scene.sides = Sides::wall;
    Flow flow(scene);
    Particles& c = flow.particles;
    c.resize(1);
    c.x[0] = 39.25, c.y[0] = -0.5;
    c.vx[0] = 3.0, c.vy[0] = -2.0;
    c.cxx[0] = 0.1, c.cxy[0] = 0.2, c.cyx[0] = 0.3, c.cyy[0] = 0.4;
    c.r1x[0] = 0.5, c.r1y[0] = 0.1, c.r2x[0] = -0.2, c.r2y[0] = 0.6, c.mass[0] = 7.0;
    std::vector<std::uint8_t> gone(1);
    PointSums sums;
    meet_side<double>(flow, 0, 0.3, -0.2, gone, sums);
    CHECK(c.x[0] == 38.75);
    CHECK(c.y[0] == 0.5);
    CHECK(c.vx[0] == -3.0);
    CHECK(c.vy[0] == 2.0);
    CHECK(c.cxx[0] == 0.1);
    CHECK(c.cxy[0] == 0.2);  // turned twice
    CHECK(c.cyy[0] == 0.4);
    CHECK(c.r1x[0] == -0.5);
    CHECK(c.r1y[0] == -0.1);
    CHECK(c.r2x[0] == 0.2);
    CHECK(c.r2y[0] == -0.6);
    CHECK(gone[0] == 0);
    CHECK(c.mass[0] == 7.0);
}

TEST_CASE("Peaks hold the speed and the pressure along the bed, and when the flow came", "[nodes]") {
    Scene scene = slope();
    scene.density = 1500.0;
    Flow flow(scene);
    flow.particles.resize(1);
    flow.particles.x[0] = flow.particles.y[0] = 20.0;
    TileSorter().sort(flow.particles, flow.grid, {}, flow.active);
    reach_all(flow);
    const Index k = flow.grid.at(20, 20);
    flow.nodes.depth[k] = 2.0;
    flow.nodes.before[k] = {3.0, 4.0};
    Peaks peaks(flow.grid);
    // A node as deep beside it rests: half of the mass moves.
    flow.nodes.depth[k + 1] = 2.0;
    flow.nodes.mass[k] = flow.nodes.mass[k + 1] = 70.0;
    const FlowSpeeds speeds = update_peaks(flow, true, false, 2.5, 0.1, peaks);
    flow.nodes.depth[k] = 1.0;
    flow.nodes.before[k] = {0.0, 0.0};
    update_peaks(flow, true, false, 3.5, 0.1, peaks);
    const double rise = 0.3 * 3.0 - 0.2 * 4.0, speed2 = 25.0 + rise * rise;
    CHECK(speeds.fastest == Approx(std::sqrt(speed2)).epsilon(1e-12));
    CHECK(speeds.mean == Approx(0.5 * std::sqrt(speed2)).epsilon(1e-12));
    CHECK(peaks.depth[k] == 2.0);
    CHECK(peaks.arrival[k] == 2.5);
    CHECK(peaks.speed[k] == Approx(std::sqrt(speed2)).epsilon(1e-12));
    CHECK(peaks.dynamic_pressure[k] == Approx(1500.0 * speed2).epsilon(1e-12));
    CHECK(peaks.pressure[k] == Approx(1500.0 * scene.gravity * 2.0 / (1.0 + 0.09 + 0.04)).epsilon(1e-12));
}

TEST_CASE("Speeds are along the bed smoothed to the curvature's length, with and without curvature", "[nodes]") {
    const double turn = 0.9, cell = 5.0, length = 10.0, fall = 0.4, high = 2.0;  // a wave of 7 cells on a slope
    Scene scene =
        scene_on(90, 40, cell, [&](double x, double) { return fall * x + high * std::sin(turn * (x / cell - 45.0)); });
    scene.scheme.curvature_length = length;
    scene.curvature = GENERATE(Curvature::inertia, Curvature::none);
    Flow flow(scene);
    flow.particles.resize(1);
    flow.particles.x[0] = 45.0, flow.particles.y[0] = 20.0;
    TileSorter().sort(flow.particles, flow.grid, {}, flow.active);
    reach_all(flow);
    const Index k = flow.grid.at(45, 20);
    flow.nodes.depth[k] = 2.0;
    flow.nodes.before[k] = {20.0, 5.0};
    Peaks peaks(flow.grid);
    const double fastest = update_peaks(flow, true, scene.curvature != Curvature::none, 1.0, 0.1, peaks).fastest;
    const double average = (230.0 + 2.0 * 76.0 * std::cos(turn) + 2.0 * std::cos(2.0 * turn)) / 384.0;
    const double kept = std::pow(0.5 + 0.5 * std::cos(turn), 2.0 * length * length / (cell * cell));
    const double difference =
        (16.0 * std::sin(turn) - 2.0 * std::sin(2.0 * turn)) / (12.0 * cell);  // of a sine, 4th order
    const double rise = 20.0 * (fall + high * average * kept * difference);
    CHECK(peaks.speed[k] == Approx(std::sqrt(425.0 + rise * rise)).epsilon(1e-12));
    CHECK(fastest == peaks.speed[k]);
}

TEST_CASE("The bed's bend is taken after binomial passes of its smoothing length", "[nodes]") {
    const double turn = 0.3, cell = 5.0, length = 10.0;  // a wave of 21 cells; 2 (length / cell)^2 passes
    Scene scene = scene_on(90, 40, cell, [&](double x, double) { return std::cos(turn * (x / cell - 45.0)); });
    scene.scheme.curvature_length = length;
    const Flow flow(scene);
    // A wave passes each filter with the sum of its weights times cosines; first the average over the shape function.
    const double average = (230.0 + 2.0 * 76.0 * std::cos(turn) + 2.0 * std::cos(2.0 * turn)) / 384.0;
    const double kept = std::pow(0.5 + 0.5 * std::cos(turn), 2.0 * length * length / (cell * cell));
    const double exact = (2.0 * std::cos(turn) - 2.0) / (cell * cell) * average * kept;
    CHECK(flow.bed.hxx[flow.grid.at(45, 20)] == Approx(exact).epsilon(1e-12));
}
