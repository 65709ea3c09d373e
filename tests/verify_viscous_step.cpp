// No viscosity shortens the step: bed friction is implicit, the stress inside is capped (scheme.stress_cap).
#include "analytic_scene.h"
#include "catch.h"

using namespace frana;

TEST_CASE("A stiff Bingham slump takes the advective step and stays bounded", "[verify]") {
    const double viscosity = GENERATE(1.0, 1e3, 1e6, 1e9);
    CAPTURE(viscosity);
    constexpr double kCell = 0.1, kDepth = 0.5;
    Scene scene = verify::scene_on(60, 5, kCell, [](double x, double) { return -0.1 * x; });
    scene.density = 1500.0;
    scene.bed_law = bed::Bingham{viscosity, 50.0, 0.0};
    scene.rheology = rheology::Bingham{viscosity, 50.0};
    scene.sides = Sides::wall;
    verify::fill(scene, [&](double x, double) { return x < 2.0 ? kDepth : 0.0; }, {2});
    const double reach = scene.scheme.cfl * kCell, gravity = scene.gravity;
    DepthAveraged simulation(scene);
    const double energy = simulation.frame().status.potential;
    for (int step = 0; step < 200; ++step) {
        simulation.advance(1e9);
        const Status& status = simulation.status();
        // dt = 2 C dx / (S + sqrt(S^2 + 2 g C dx)) for the fastest signal there can be: twice that of the dry front of
        // a dam as deep, plus what the fall of the whole bed gives.
        const double signal = 4.0 * std::sqrt(gravity * kDepth) + std::sqrt(2.0 * gravity * 0.1 * 6.0);
        REQUIRE(status.dt >= 2.0 * reach / (signal + std::sqrt(signal * signal + 2.0 * gravity * reach)));
        REQUIRE(status.max_speed <= signal);
    }
    const Status end = simulation.frame().status;
    CHECK(end.kinetic + end.potential <= energy * (1.0 + 1e-12));
}
