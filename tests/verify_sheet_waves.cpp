// A viscous sheet on a slope: no wave of two cells grows in it. One that is there goes as the sheet goes on.
#include <algorithm>
#include <cmath>
#include <random>

#include "base/constants.h"
#include "catch.h"
#include "checks/verify/trial.h"

using namespace frana;
using namespace frana::verify;

namespace {

using constants::kGravity;

constexpr double kDepth = 0.05, kNoise = 0.02, kCell = 0.25;

/// The largest two-cell wave over the depth, in a window well inside the sheet.
double wave_in(const Frame& frame, double from, double to) {
    const double* depth = frame.node("depth")->data + frame.grid.ny / 2 * frame.grid.nx;
    double largest = 0.0;
    for (Index i = std::lround(from / kCell); i < std::lround(to / kCell); ++i)
        largest = std::max(
            largest,
            std::abs(depth[i - 2] - 4.0 * depth[i - 1] + 6.0 * depth[i] - 4.0 * depth[i + 1] + depth[i + 2]) / 16.0);
    return largest / kDepth;
}

}  // namespace

// Laminar drag falls with the square of the depth. Given it node by node, a node 1 % deeper would be 2 % faster.
// What then piles up no gradient of the surface sees. Kinematic waves run at three times the speed u. A sheet is stable
// where that is less than u + sqrt(g h). So what is there at the start bounds what is there later.
// In the time that the sheet takes for 20 m they come from its rear at 10 m to 70 m.
TEST_CASE("A viscous sheet on a slope grows no wave of two cells", "[verify][sheet_waves]") {
    const double fall = std::tan(20.0 * constants::kPi / 180.0), cosine = std::cos(std::atan(fall)), nu = 1e-2;
    Scene scene = scene_on(801, 5, kCell, [&](double x, double) { return -fall * x; });
    scene.bed_law = bed::Bingham{nu * scene.density, 0.0, 0.0};
    scene.rheology = rheology::Newtonian{nu * scene.density};
    scene.sides = Sides::wall;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-kNoise, kNoise);
    std::vector<double> along(700);
    for (double& n : along) n = noise(random);
    verify::fill(scene, [&](double x, double) {
        const auto at = static_cast<std::size_t>(x / kCell);
        return x > 10.0 && x < 130.0 ? kDepth * (1.0 + along[at]) : 0.0;
    });
    const double thickness = kDepth * cosine;
    const double speed = kGravity * std::sin(std::atan(fall)) * thickness * thickness / (3.0 * nu);  // along the slope
    for (double& v : scene.particles.vx) v = speed * cosine;
    REQUIRE(2.0 * speed < std::sqrt(kGravity * cosine * thickness));
    Trial trial(std::move(scene), Setup{});
    const double start = wave_in(trial.simulation().frame(), 80.0, 125.0), time = 20.0 / (speed * cosine);
    trial.run_to(time);
    const double end = wave_in(trial.simulation().frame(), 80.0, 125.0);
    CAPTURE(speed, time, start, end);
    REQUIRE(start > 0.0);
    CHECK(end < start);
}

// Between nodes a particle sees the slope of a wave that no node sees (THEORY (50)). By linear theory a wave a on nodes has
// the slope 16 a / pi^2 a cell there, in its first harmonic. Particles that carry a wave of 0.1 give nodes at its crests one
// of 0.0243. Half a cell on, nodes have none. So the wave falls by exp(-0.5 * 16 / pi * 0.243) a cell, by exp(-2.5) in four.
// Steps of half a cell leave some of that out. Pressure does nothing: it sees no slope, and the sheet is faster than its
// surface waves.
TEST_CASE("A sheet that slides on levels its waves of two cells, in one that lies they stay", "[verify][sheet_waves]") {
    const double speed = GENERATE(0.0, 2.0), strength = GENERATE(0.0, 1.0);
    CAPTURE(speed, strength);
    Scene scene = scene_on(201, 5, kCell, [](double, double) { return 0.0; });
    scene.scheme.wave_shift = strength;
    scene.bed_law = speed > 0.0 ? BedLaw{bed::None{}} : BedLaw{bed::Coulomb{0.4}};
    scene.sides = Sides::wall;
    verify::fill(scene, [&](double x, double) {
        return x > 5.0 && x < 40.0 ? kDepth * (1.0 + 0.1 * std::cos(constants::kPi * x / kCell)) : 0.0;
    });
    for (double& v : scene.particles.vx) v = speed;
    Trial trial(std::move(scene), Setup{});
    const double start = wave_in(trial.simulation().frame(), 15.0, 30.0), way = 4.0 * kCell;
    trial.run_to(way / 2.0);
    const double end = wave_in(trial.simulation().frame(), 15.0 + 0.5 * speed * way, 30.0 + 0.5 * speed * way);
    CAPTURE(start, end);
    REQUIRE(start > 0.02);
    if (speed == 0.0) CHECK(end == start);
    if (speed > 0.0 && strength > 0.0) CHECK(end < start * std::exp(-0.6 * 2.5));
    if (speed > 0.0 && strength == 0.0) CHECK(end > 0.5 * start);
}
