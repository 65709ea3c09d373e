// Drag between neighbouring material of different velocity.
#include "analytic_scene.h"
#include "catch.h"
#include "shallow/lateral.h"

using namespace frana;
using namespace frana::test;

namespace {

/// Level material 2 m deep that streams along x, the faster the farther from its middle: dvx/dy = shear [1/s].
Scene stream(double shear, double drag) {
    Scene scene = scene_on(41, 41, 1.0, [](double, double) { return 0.0; });
    scene.bed_law = bed::None{};
    scene.scheme.lateral_drag = drag;
    fill(scene, [](double x, double y) { return x > 12 && x < 28 && y > 12 && y < 28 ? 2.0 : 0.0; });
    for (Index p = 0; p < scene.particles.count(); ++p)
        scene.particles.vx[p] = shear * std::abs(scene.particles.y[p] - 20.0);
    return scene;
}

}  // namespace

TEST_CASE("The lateral drag at a node is its faces', and takes momentum from one side to the other", "[lateral]") {
    const double drag = 0.7, dt = 0.05, cell = 2.0;
    Scene scene = scene_on(41, 41, cell, [](double, double) { return 0.0; });
    scene.scheme.lateral_drag = drag;
    Flow flow(scene);
    flow.particles.resize(1);
    flow.particles.x[0] = flow.particles.y[0] = 20.0;
    TileSorter().sort(flow.particles, flow.grid, {}, flow.active);
    reach_all(flow);
    const auto each = [&](auto&& body) {
        for (Index j = 12; j <= 28; ++j)
            for (Index i = 12; i <= 28; ++i) body(flow.grid.at(i, j), static_cast<double>(i), static_cast<double>(j));
    };
    each([&](Index k, double i, double j) {
        flow.nodes.mass[k] = 1.0 + 0.1 * i;
        flow.nodes.before[k] = {3.0 * std::abs(j - 20.0), 0.5 * i};
        flow.nodes.flags[k] = kWet | kMoving;
    });
    lateral_pass(flow, dt);
    const Index k = flow.grid.at(20, 20), up = flow.grid.stride();
    // Beside the ridge both neighbours are faster by 3 m/s along x; those before and behind differ by 0.5 m/s along y.
    const auto part = [&](Index n, double size, double component) {
        const double f = drag * size * dt / (2.0 * cell);
        return 2.0 * flow.nodes.mass[n] / (flow.nodes.mass[n] + flow.nodes.mass[k]) * f / (1.0 + 8.0 * f) * component /
               dt;
    };
    CHECK(flow.nodes.lateral[k].x == Approx(part(k - up, 3.0, 3.0) + part(k + up, 3.0, 3.0)).epsilon(1e-13));
    CHECK(flow.nodes.lateral[k].y == Approx(part(k + 1, 0.5, 0.5) + part(k - 1, 0.5, -0.5)).epsilon(1e-13));
    double sum_x = 0.0, sum_y = 0.0, size = 0.0, work = 0.0;
    each([&](Index n, double, double) {
        const Pair a = flow.nodes.lateral[n], v = flow.nodes.before[n];
        const double m = flow.nodes.mass[n];
        sum_x += m * a.x, sum_y += m * a.y, size += m * (std::abs(a.x) + std::abs(a.y)),
            work += m * (a.x * v.x + a.y * v.y);
    });
    CHECK(std::abs(sum_x) < 1e-14 * size);
    CHECK(std::abs(sum_y) < 1e-14 * size);
    CHECK(work < 0.0);
}

TEST_CASE("Lateral drag of any strength slows a shear stably and records the energy that it takes",
          "[lateral][conserve]") {
    for (const double drag : {0.3, 1e6}) {
        DepthAveraged free(stream(1.0, 0.0)), held(stream(1.0, drag));  // nothing comes to the sides in 0.3 s
        const auto shear_energy = [](DepthAveraged& run) {
            while (run.status().time < 0.3) run.advance(0.3);
            return run.frame().status;
        };
        const Status start = held.frame().status, a = shear_energy(free), b = shear_energy(held);
        CAPTURE(drag, a.kinetic, b.kinetic, b.dissipated);
        CHECK(std::abs(b.momentum[0] - start.momentum[0] - b.impulse[0]) < 1e-12 * start.momentum[0]);
        CHECK(b.kinetic < a.kinetic);
        CHECK(b.dissipated > a.dissipated);
        CHECK(b.mass_left == 0.0);
        // What is gone from motion and height has been recorded; the scheme's own share is that of the run without
        // drag.
        const auto open = [&](const Status& s) {
            return s.kinetic + s.potential + s.dissipated - start.kinetic - start.potential;
        };
        CHECK(open(b) <= std::max(open(a), 0.0) + 0.01 * b.dissipated);
    }
}
