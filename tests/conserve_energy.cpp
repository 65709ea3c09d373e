// The energy ledger: what weight gives, motion has, or friction, rheology and bores have taken.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"

using namespace frana;
using namespace frana::test;

namespace {

/// What is missing in the ledger at the end, over what friction and stress took.
double gap(const Scene& scene, double until) {
    DepthAveraged simulation(scene);
    const auto total = [](const Status& s) { return s.kinetic + s.potential + s.dissipated + s.energy_left; };
    const double start = total(simulation.frame().status);
    run_to(simulation, until);
    const Status end = simulation.frame().status;
    CHECK(end.dissipated > 0.0);
    return std::abs(total(end) - start) / end.dissipated;
}

/// A parabolic cap slides down a plane, in the gentle model: the steep one's lighter pressure does not do the work that the
/// fall of the particles' centres yields, and leaves a few per cent open on any grid.
Scene sliding_cap(double cell) {
    const auto nodes = [&](double length) { return static_cast<Index>(length / cell) + 1; };
    Scene scene = scene_on(nodes(120), nodes(48), cell, [](double x, double) { return 80 - 0.6 * x; });
    scene.terrain = TerrainModel::shallow;
    scene.bed_law = bed::Coulomb{0.3};
    fill(scene, [](double x, double y) {
        return std::max(0.0, 2.0 * (1.0 - ((x - 28) * (x - 28) + (y - 24) * (y - 24)) / 196));
    });
    return scene;
}

/// A viscous cap spreads on level ground that does not brake it.
Scene viscous_cap(double cell) {
    const auto nodes = [&](double length) { return static_cast<Index>(length / cell) + 1; };
    Scene scene = scene_on(nodes(64), nodes(64), cell, [](double, double) { return 0.0; });
    scene.rheology = rheology::Newtonian{8000.0};
    fill(scene, [](double x, double y) {
        return std::max(0.0, 2.0 * (1.0 - ((x - 32) * (x - 32) + (y - 32) * (y - 32)) / 196));
    });
    return scene;
}

}  // namespace

TEST_CASE("The energy ledger closes to second order under friction, to first order with rheology", "[conserve]") {
    const double smooth[] = {gap(sliding_cap(2.0), 4.0), gap(sliding_cap(1.0), 4.0)};
    const double viscous[] = {gap(viscous_cap(2.0), 3.0), gap(viscous_cap(1.0), 3.0)};
    CAPTURE(smooth[0], smooth[1], viscous[0], viscous[1]);
    // Orders of the scheme (stress acts on margins, which are first order), a tenth of each left to coarse grids.
    CHECK(std::log2(smooth[0] / smooth[1]) >= 1.8);
    CHECK(std::log2(viscous[0] / viscous[1]) >= 0.9);
    CHECK(smooth[1] <= 0.005);  // a ledger without the one or the other is open by all of it, on any grid
    CHECK(viscous[1] <= 0.05);
}

// Without friction all of the fall becomes speed. Where the bed bends away faster than flight, a flow that kept its speed
// along the map won by every wave. It was at the far wall before 15 s. The scheme leaves 0.14 % open on either cell.
TEST_CASE("A fast flow wins no energy on a bed that it would leave", "[conserve]") {
    for (const double cell : {5.0, 2.5}) {
        const auto nodes = [&](double length) { return static_cast<Index>(length / cell) + 1; };
        Scene scene = scene_on(nodes(1500), nodes(60), cell, [](double x, double) {
            return 900 - 0.6 * x + 1.5 * std::sin(2.0 * constants::kPi * x / 60.0);
        });
        scene.sides = Sides::wall;
        scene.bed_law = bed::None{};
        fill(scene, [](double x, double) { return std::max(0.0, 1.0 - std::pow((x - 80) / 40, 2)); });
        std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), 40.0);
        DepthAveraged simulation(scene);
        const auto total = [](const Status& s) { return s.kinetic + s.potential + s.dissipated + s.energy_left; };
        const Status start = simulation.frame().status;
        run_to(simulation, 15.0);
        const Frame frame = simulation.frame();
        const Status& end = frame.status;
        CAPTURE(cell, end.mass_left / start.mass, end.max_speed,
                (total(end) - total(start)) / (end.kinetic - start.kinetic));
        CHECK(end.mass_left == 0.0);
        CHECK(std::abs(total(end) - total(start)) < 0.01 * (end.kinetic - start.kinetic));
    }
}

TEST_CASE("What is released with a velocity has its kinetic energy from the start", "[conserve]") {
    Scene scene = sliding_cap(2.0);
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), 3.0);
    std::fill(scene.particles.vy.begin(), scene.particles.vy.end(), -1.0);
    DepthAveraged simulation(scene);
    const Status start = simulation.status();
    CHECK(start.kinetic == simulation.frame().status.kinetic);
    CHECK(start.kinetic == Approx(0.5 * start.mass * 10.0).epsilon(1e-13));  // the gentle model has no speed upwards
}

// Its pressure stretches it. It is too light to split, and the cut of its domain makes it as high again. So its nodes went
// ever faster to all sides: after 300 steps these had six times the energy of the release.
TEST_CASE("Particles that are alone and may not split win no energy", "[conserve]") {
    Scene scene = scene_on(41, 41, 1.0, [](double, double) { return 0.0; });
    scene.bed_law = bed::None{};
    scene.scheme.split = false;
    fill(scene, [](double x, double y) { return std::max(std::abs(x - 20), std::abs(y - 20)) < 0.5 ? 0.25 : 0.0; });
    REQUIRE(scene.particles.count() == 4);  // they part, and are alone then
    for (const Shape shape : {Shape::quadratic, Shape::cubic}) {
        scene.scheme.shape = shape;
        DepthAveraged simulation(scene);
        const double mass = simulation.status().mass, release = 0.5 * mass * scene.gravity * 0.25;
        double most = 0.0;
        for (int step = 0; step < 300; ++step) {
            simulation.advance(1e9);
            const Status& now = simulation.status();
            most = std::max(most, now.kinetic + now.potential);
        }
        CAPTURE(shape, release, most);
        CHECK(most < release);
    }
}
