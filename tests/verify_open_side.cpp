// Material that runs out at an open side, and material in the corners of the grid.
#include "analytic_scene.h"
#include "catch.h"

using namespace frana;

namespace {

/// Runs and returns the largest error of the mass that nodes hold beside the mass of the points.
double worst_p2g(const Scene& scene, int steps) {
    DepthAveraged simulation(scene);
    double worst = 0.0;
    for (int step = 0; step < steps; ++step) {
        simulation.advance(1e9);
        worst = std::max(worst, simulation.status().p2g_mass_error);
    }
    return worst;
}

}  // namespace

// Surges that leave one after the other empty tiles that a later one enters again: these are clean by then.
TEST_CASE("Surges that leave at an open side bring no mass back", "[verify]") {
    const Index nx = GENERATE(301, 303, 305, 307);
    CAPTURE(nx);
    Scene scene = verify::scene_on(nx, 60, 2.0, [](double x, double) { return -0.5 * x; });
    scene.sides = Sides::open;
    scene.density = 1500.0;
    scene.bed_law = bed::Voellmy{0.1, 2000.0};
    const double end = 2.0 * static_cast<double>(nx - 1);
    verify::fill(scene,
                 [&](double x, double y) {
                     const bool surge = y > 20 && y < 50 && x > end - 260 && std::fmod(end - x, 80.0) < 30.0;
                     const bool stream = y > 70 && y < 100 && x > end - 300;
                     return surge || stream ? 1.0 : 0.0;
                 },
                 {2});
    CHECK(worst_p2g(scene, 150) <= 1e-12);  // sums of 1e4 numbers, each right to 1e-16
}

TEST_CASE("Material in every corner of a small grid conserves its mass", "[verify]") {
    const Sides sides = GENERATE(Sides::open, Sides::wall);
    Scene scene = verify::scene_on(29, 29, 1.0, [](double x, double y) { return 0.1 * std::sin(x) + 0.05 * y; });
    scene.sides = sides;
    scene.density = 1500.0;
    scene.rheology = rheology::Bingham{10.0, 20.0};
    verify::fill(scene, [](double x, double y) { return std::abs(x - 14) > 8 && std::abs(y - 14) > 8 ? 1.0 : 0.0; },
                 {2});
    CHECK(worst_p2g(scene, 60) <= 1e-12);
}
