// Fois et al. 2024, section 4.2: mud runs onto a bump, splits into two lobes and joins again behind it.
#include "analytic_scene.h"
#include "catch.h"

using namespace frana;
using namespace frana::test;

namespace {

/// Mirror-symmetric about y = 10; release as in cases/obstacle, between walls as the paper's domain ends.
Scene obstacle() {
    Scene scene = scene_on(151, 21, 1.0, [](double x, double y) {
        return 60 - x / 3 + 15 * std::exp(-((x - 50) * (x - 50) + (y - 10) * (y - 10)) / 7);
    });
    scene.density = 1200;
    scene.terrain = TerrainModel::shallow;
    scene.sides = Sides::wall;
    scene.bed_law = bed::Voellmy{std::tan(12 * M_PI / 180), 200};
    scene.rheology = rheology::Newtonian{10};
    fill(scene, [](double x, double y) { return x > 5 && x < 42.5 && y > 3 && y < 17 ? 10.0 : 0.0; });
    return scene;
}

double depth_at(const Frame& frame, Index i, Index j) { return frame.node("depth")->data[j * frame.grid.nx + i]; }

}  // namespace

TEST_CASE("The mud splits into two lobes around the bump, which rejoin behind it", "[obstacle]") {
    const Scene scene = obstacle();
    CHECK(scene.particles.count() == 2100);  // the paper's number
    DepthAveraged simulation(scene);
    const double mass = simulation.status().mass;
    double mass_gap = 0.0, momentum_gap = 0.0;
    while (simulation.status().time < 3.0) {
        simulation.advance(3.0);
        mass_gap = std::max(mass_gap, simulation.status().p2g_mass_error);
        momentum_gap = std::max(momentum_gap, simulation.status().p2g_momentum_error);
    }
    const Frame frame = simulation.frame();
    CHECK(depth_at(frame, 54, 10) == 0.0);  // the lee of the bump, its foot is at x = 55
    for (const Index side : {4, 16}) CHECK(depth_at(frame, 54, side) > 0.5);
    CHECK(depth_at(frame, 63, 10) > 0.1);  // together again
    CHECK(mass_error(frame.status, mass) <= 1e-13);
    CHECK(mass_gap <= 1e-13);  // round-off of sums over some 1e4 points
    CHECK(momentum_gap <= 1e-13);

    double worst = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i)
            worst = std::max(worst, std::abs(depth_at(frame, i, j) - depth_at(frame, i, frame.grid.ny - 1 - j)));
    CAPTURE(worst, frame.status.max_depth);
    CHECK(worst <= 1e-9 * frame.status.max_depth);  // round-off of mirrored sums, grown through 3 s of splashing
}
