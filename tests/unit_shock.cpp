// The artificial viscosity of one step: it takes energy, whatever the velocities and depths.
#include <random>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/shock.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr Index kFirst = 12, kLast = 28;

/// Nodes with depths over four decades and velocities of either sign.
Flow rough_flow(const Scene& scene, unsigned seed) {
    Flow flow(scene);
    flow.particles.resize(1);
    flow.particles.x[0] = flow.particles.y[0] = 20.0;
    TileSorter().sort(flow.particles, flow.grid, {}, flow.active);
    reach_all(flow);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> decades(-3.0, 1.0), speed(-30.0, 30.0);
    for (Index j = kFirst; j <= kLast; ++j)
        for (Index i = kFirst; i <= kLast; ++i) {
            const Index k = flow.grid.at(i, j);
            flow.nodes.depth[k] = std::pow(10.0, decades(random));
            flow.nodes.before[k] = {speed(random), speed(random)};
            flow.nodes.flags[k] = kWet | kMoving;
        }
    return flow;
}

/// Kinetic energy over density and area, before and after what the fluxes alone do in a step.
std::pair<double, double> energies(const Flow& flow, double velocity_dt) {
    const Index up = flow.grid.stride();
    double before = 0.0, after = 0.0;
    for (Index j = kFirst; j <= kLast; ++j)
        for (Index i = kFirst; i <= kLast; ++i) {
            const Index k = flow.grid.at(i, j);
            const double h = flow.nodes.depth[k], gain = velocity_dt / (flow.cell * h);
            const Pair v = flow.nodes.before[k], *flux = &flow.nodes.viscous_flux[k];
            const double x = v.x + gain * (flux[-1].x - flux[0].x), y = v.y + gain * (flux[-up].y - flux[0].y);
            before += 0.5 * h * (v.x * v.x + v.y * v.y), after += 0.5 * h * (x * x + y * y);
        }
    return {before, after};
}

}  // namespace

// An explicit step that took more than half of what makes two nodes' velocities equal gave energy: a film that met a wall
// at 22 m/s left it at 85 m/s.
TEST_CASE("Artificial viscosity takes energy in steps of any length", "[shock]") {
    Scene scene = scene_on(41, 41, 2.0, [](double, double) { return 0.0; });
    for (const double quadratic : {1.0, 2.0})
        for (const double velocity_dt : {0.01, 0.1, 1.0}) {
            scene.scheme.viscosity_quadratic = quadratic;
            for (unsigned seed = 0; seed < 20; ++seed) {
                Flow flow = rough_flow(scene, seed);
                shock_pass(flow, velocity_dt);
                const auto [before, after] = energies(flow, velocity_dt);
                CAPTURE(quadratic, velocity_dt, seed);
                CHECK(after < before);
            }
        }
}

TEST_CASE("Short steps have the viscosity that the scheme asks for", "[shock]") {
    const Scene scene = scene_on(41, 41, 2.0, [](double, double) { return 0.0; });
    Flow bounded = rough_flow(scene, 3), free = rough_flow(scene, 3);
    shock_pass(bounded, 1e-3), shock_pass(free, 0.0);
    for (Index j = kFirst; j <= kLast; ++j)
        for (Index i = kFirst; i <= kLast; ++i) {
            const Index k = free.grid.at(i, j);
            CHECK(bounded.nodes.viscous_flux[k].x == free.nodes.viscous_flux[k].x);
        }
}
