// What a step does once, it does at a rate: shorter steps do less of it each, and as much in a second.
#include <cmath>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slab that glides to the east over level ground without friction or weight to speak of, 1 m/s, with a wave of four
/// cells across in its velocity, which no force holds up and which moves no mass.
Scene gliding(double cfl, Transfer transfer) {
    Scene scene = scene_on(61, 41, 1.0, [](double, double) { return 0.0; });
    fill(scene, [](double x, double y) { return x > 8 && x < 32 && y > 8 && y < 32 ? 1.0 : 0.0; });
    for (std::size_t p = 0; p < scene.particles.x.size(); ++p) {
        scene.particles.vx[p] = 1.0 + 0.01 * std::sin(0.5 * constants::kPi * scene.particles.y[p]);
        scene.particles.vy[p] = 0.0;
    }
    scene.bed_law = bed::None{};
    scene.gravity = 1e-9;
    scene.scheme.transfer = transfer;
    scene.scheme.cfl = cfl;
    scene.scheme.viscosity_linear = scene.scheme.viscosity_quadratic = 0.0;
    return scene;
}

/// Amplitude of the wave in the slab's middle after `end` [m/s].
double wave_after(const Scene& scene, double end) {
    const auto run = make_simulation(scene);
    run_to(*run, end);
    const Frame frame = run->frame();
    const Field &position = *frame.particle("position"), &velocity = *frame.particle("velocity");
    double sum = 0.0, squares = 0.0;
    for (Index p = 0; p < position.count; ++p) {
        const double y = position.data[3 * p + 1], wave = std::sin(0.5 * constants::kPi * y);
        if (std::abs(y - 20.0) > 6.0) continue;  // three waves
        sum += velocity.data[3 * p] * wave, squares += wave * wave;
    }
    return sum / squares;
}

}  // namespace

TEST_CASE("What the nodes cannot hold of a motion is lost by time and not by the number of steps", "[conserve]") {
    const Transfer transfer = GENERATE(Transfer::tpic, Transfer::apic);
    constexpr double kEnd = 10.0, kOrdinary = 20.0;  // [s], steps of half a cell in this time
    const double start = wave_after(gliding(0.5, transfer), 0.0), usual = wave_after(gliding(0.5, transfer), kEnd);
    CHECK(start > 0.005);        // a frame shows what the nodes hold: about half of a wave of four cells
    CHECK(usual < 0.5 * start);  // it is a loss that matters
    // An ordinary step leaves k, one of a share a of it 1 - a (1 - k). The first and last steps are not ordinary: 2 of 20.
    const double left = std::pow(usual / start, 1.0 / kOrdinary);
    for (const double part : {0.5, 0.25, 0.1}) {
        const double expected = start * std::pow(1.0 - part * (1.0 - left), kOrdinary / part);
        const double found = wave_after(gliding(0.5 * part, transfer), kEnd);
        CAPTURE(part, start, usual, expected);
        CHECK(std::log(found / start) == Approx(std::log(expected / start)).epsilon(0.1));
    }
}
