// The slope of the free surface that drives a node, at margins.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/depth_averaged.h"
#include "shallow/surface_gradient.h"
#include "shallow/two_cell_wave.h"

using namespace frana;

TEST_CASE("A film has its bed's slope everywhere, margins too, where the bed bends more than the film is deep",
          "[solver][surface]") {
    // A tenth of a millimetre on a bed that bends by 0.86 m a cell, up or down, and rises by 3.5 m or more; at rest or not.
    const double cell = 24.0, depth = 1e-4, bend = GENERATE(7.5e-4, -7.5e-4), speed = GENERATE(0.0, 1.0);
    const bool along_x = GENERATE(true, false);
    Scene scene = verify::scene_on(30, 30, cell, [&](double x, double y) {
        const double along = along_x ? x : y;
        return bend * along * along;
    });
    verify::fill(scene, [&](double x, double y) { return x > 120 && x < 360 && y > 120 && y < 360 ? depth : 0.0; },
                 {1});
    scene.particles.vx.assign(scene.particles.x.size(), along_x ? speed : 0.0);
    scene.particles.vy.assign(scene.particles.x.size(), along_x ? 0.0 : speed);
    scene.scheme.cfl = 0.5;  // a step that leaves each particle on its own nodes
    DepthAveraged simulation(scene);
    simulation.advance(1e9);  // keeps the surface that drove the step
    const Flow& flow = simulation.flow();
    double worst = 0.0;
    int margins = 0;
    for (Index j = 2; j < 28; ++j)
        for (Index i = 2; i < 28; ++i) {
            const Index k = flow.grid.at(i, j);
            const std::uint8_t flags = flow.nodes.flags[k];
            if (!(flags & kWet)) continue;
            margins += (flags & kMargin) != 0;
            const double of_bed = along_x ? flow.bed.slope_x[k] : flow.bed.slope_y[k];
            const double slope = along_x ? surface_gradient(flow, k, 1, flags & kWideX, of_bed)
                                         : surface_gradient(flow, k, flow.grid.stride(), flags & kWideY, of_bed);
            worst = std::max(worst, std::abs(slope - of_bed));
        }
    CAPTURE(bend, speed, along_x, worst);
    CHECK(margins == 13 * 13 - 9 * 9);  // two layers
    CHECK(worst <= depth / cell);       // its own depth may fall over a cell
}

TEST_CASE("Friction sees the depth without its waves along x, along y and of both", "[solver][surface]") {
    Scene scene = verify::scene_on(30, 30, 2.0, [](double x, double) { return 0.1 * x; });
    verify::fill(scene, [](double x, double y) {
        const bool inside = x > 8 && x < 50 && y > 8 && y < 50;
        return inside ? 1.0 + 0.4 * std::sin(2.9 * x / 2.0) * std::cos(3.0 * y / 2.0) + 0.2 * std::sin(1.5 * y) : 0.0;
    });
    DepthAveraged simulation(scene);
    simulation.advance(1e9);
    const Flow& flow = simulation.flow();
    const double strength = flow.scheme.filter;
    double of_both = 0.0;
    for (Index j = 10; j < 20; ++j)
        for (Index i = 10; i < 20; ++i) {
            const Index k = flow.grid.at(i, j), up = flow.grid.stride();
            const double* h = &flow.nodes.depth[k];
            const double both = wave_along_both<double>(h, up);
            const double wave = wave_along<double>(h, 1) + wave_along<double>(h, up) - strength * both;
            CHECK(flow.nodes.law_depth[k] ==
                  Approx(*h - strength * wave).epsilon(1e-14));  // a few sums of numbers near 1
            of_both = std::max(of_both, std::abs(both));
        }
    CHECK(of_both > 0.01);
}

TEST_CASE("Friction sees a front as deep as the flow behind it, and other edges as thin as they are",
          "[solver][surface]") {
    // Two metres deep between straight edges, all of it on its way to the east.
    const double speed = 3.0;
    Scene scene = verify::scene_on(40, 40, 2.0, [](double x, double) { return 0.1 * x; });
    verify::fill(scene, [](double x, double y) { return y > 20 && y < 60 && x > 10 && x < 43 ? 2.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), speed);
    scene.particles.vy.assign(scene.particles.x.size(), 0.0);
    DepthAveraged simulation(scene);
    simulation.advance(1e-6);  // too short to turn a velocity
    const Flow& flow = simulation.flow();
    double thin = 2.0, least = 2.0, deepest = 0.0;
    for (Index k = 0; k < flow.grid.size(); ++k) deepest = std::max(deepest, flow.nodes.depth[k]);
    for (Index j = 2; j < 38; ++j)
        for (Index i = 2; i < 38; ++i) {
            const Index k = flow.grid.at(i, j);
            const double h = flow.nodes.depth[k], seen = flow.nodes.law_depth[k];
            if (!(flow.nodes.flags[k] & kMargin)) continue;
            CAPTURE(i, j, h);
            CHECK(seen >= h);
            CHECK(seen <= deepest);
            const bool front = i > 17 && j > 14 && j < 26;
            const bool lateral = i > 8 && i < 16;
            if (front) thin = std::min(thin, h), least = std::min(least, seen);
            if (i < 4) CHECK(seen == h);
            if (lateral) CHECK(seen <= 1.02 * h);  // what lies behind is as thin, but for noise of the lattice
        }
    // Half a cell beyond the edge a node has an eighth of the depth, and the one behind it seven: of the mass of both that is
    // 25 / 32 of the depth. Sub-points spread a little more.
    CHECK(thin < 0.2 * 2.0);
    CHECK(least > 0.9 * 25.0 / 32.0 * 2.0);
}

TEST_CASE("A margin that only round-off moves has no direction, and its own depth", "[solver][surface]") {
    for (const double speed : {1e-17, 1e-3}) {
        Scene scene = verify::scene_on(40, 40, 2.0, [](double, double) { return 0.0; });
        verify::fill(scene, [](double x, double y) { return y > 20 && y < 60 && x > 10 && x < 43 ? 2.0 : 0.0; });
        scene.particles.vx.assign(scene.particles.x.size(), speed);
        scene.particles.vy.assign(scene.particles.x.size(), 0.0);
        const DepthAveraged simulation(scene);
        const Nodes& nodes = simulation.flow().nodes;
        double most = 0.0;  // seen over its own
        for (Index k = 0; k < simulation.flow().grid.size(); ++k)
            if (nodes.flags[k] & kMargin) most = std::max(most, nodes.law_depth[k] / nodes.depth[k]);
        CAPTURE(speed);
        // (1e-17 / 1e-8 sqrt(g h))^2 of the mass behind is nothing. What creeps has all of it.
        if (speed < 1e-9)
            CHECK(most == Approx(1.0).epsilon(1e-14));
        else
            CHECK(most > 2.0);
    }
}
