// A viscous sheet on a slope: no wave of two cells grows in it.
#include <algorithm>
#include <cmath>
#include <random>

#include "catch.h"
#include "checks/verify/trial.h"

using namespace frana;
using namespace frana::verify;

namespace {

constexpr double kGravity = 9.81, kDepth = 0.05, kNoise = 0.02, kCell = 0.25;

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
    const double fall = std::tan(20.0 * M_PI / 180.0), cosine = std::cos(std::atan(fall)), nu = 1e-2;
    Scene scene = scene_on(801, 5, kCell, [&](double x, double) { return -fall * x; });
    scene.bed_law = bed::Bingham{nu * scene.density, 0.0, 0.0};
    scene.rheology = rheology::Newtonian{nu * scene.density};
    scene.sides = Sides::wall;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-kNoise, kNoise);
    std::vector<double> along(700);
    for (double& n : along) n = noise(random);
    fill(scene, [&](double x, double) {
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
