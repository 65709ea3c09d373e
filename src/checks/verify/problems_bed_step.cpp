// A stream runs up a step in the bed. It is shorter than the length over which the bed's curvature is taken. Behind
// the step it is steady, faster than its waves, and has the energy it came with. u^2/2 + g (h + z) and u h stay as they
// were.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kStepSpeed = 12.0, kStepDepth = 0.5;  ///< of the stream [m/s], [m]
constexpr double kFoot = 220.0, kStepLength = 300.0;   ///< of the step; of the track [m]
constexpr double kStepFirst = 10.0, kLast = 210.0;     ///< ends of the stream at the start [m]
constexpr double kStepRise = 3.0, kStepEnd = 10.0;     ///< [m], [s]
using constants::kGravity;

/// What Bernoulli's equation says about the stream on top, [m/s]: the faster root of u^2/2 + g q/u = head.
double speed_on_top() {
    const double head = 0.5 * kStepSpeed * kStepSpeed + kGravity * (kStepDepth - kStepRise),
                 flux = kStepSpeed * kStepDepth;
    double u = kStepSpeed;
    for (int n = 0; n < 100; ++n) u = std::sqrt(2.0 * (head - kGravity * flux / u));
    return u;
}

std::vector<Residual> residuals() {
    const double u = speed_on_top(), h = kStepSpeed * kStepDepth / u;
    return {{"head kept", 0.5 * (u * u - kStepSpeed * kStepSpeed) + kGravity * (h + kStepRise - kStepDepth),
             1e-12 * kStepSpeed * kStepSpeed},
            {"faster than waves: gravity times depth over speed squared, below 1", kGravity * h / (u * u), 1.0}};
}

struct OnTop {
    double speed = 0.0, depth = 0.0;
};

/// Means over 10 m, 20 to 30 m behind the top of the step, relative to the exact values.
OnTop errors(const Frame& frame, double top) {
    const double *h = frame.node("depth")->data, *v = frame.node("velocity")->data;
    OnTop mean;
    double nodes = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            if (std::abs(frame.grid.x(i) - top - 25.0) > 5.0) continue;
            const Index k = j * frame.grid.nx + i;
            mean.speed += v[3 * k], mean.depth += h[k], nodes += 1.0;
        }
    const double u = speed_on_top();
    return {mean.speed / nodes / u - 1.0, mean.depth / nodes / (kStepSpeed * kStepDepth / u) - 1.0};
}

/// Cells are counted along 100 m.
Measurement run_bed_steps(const Setup& setup) {
    const double cell = 100.0 / static_cast<double>(setup.cells);
    const Index length = static_cast<Index>(std::lround(kStepLength / cell));
    Measurement m;
    const std::array<std::pair<const char*, double>, 3> bed_steps{
        {{"steep", 2.0}, {"bank_4m", 4.0}, {"bank_16m", 16.0}}};
    for (const auto& [name, width] : bed_steps) {
        const double wide = width;
        Scene scene = scene_on(length + 1, 9, cell, [wide](double x, double) {
            return kStepRise * std::clamp((x - kFoot) / wide, 0.0, 1.0);
        });
        scene.sides = Sides::wall;
        fill(scene, [](double x, double) { return x > kStepFirst && x < kLast ? kStepDepth : 0.0; }, {setup.per_side});
        scene.particles.vx.assign(scene.particles.vx.size(), kStepSpeed);
        Trial trial(std::move(scene), setup);
        trial.run_to(kStepEnd);
        const OnTop error = errors(trial.simulation().frame(), kFoot + wide);
        if (m.steps == 0) m = trial.measure();
        m.add(std::string(name) + "_speed", error.speed);
        m.add(std::string(name) + "_depth", error.depth);
    }
    return m;
}

}  // namespace

std::vector<Problem> bed_step_problems() {
    Problem problem{"bank",
                    "a stream of 12 m/s climbs 3 m within 2, 4 and 16 m: head and flux are kept",
                    {50, 100, 200},
                    residuals,
                    run_bed_steps};
    problem.order_of = "steep_speed";
    for (const char* quantity : {"steep_speed", "bank_4m_speed", "bank_16m_speed"})
        for (const Index cells : {100, 200})
            problem.gates.push_back(
                {cells, quantity, 0.01, "a sixteenth of what is missed where the bank turns nothing"});
    problem.gates.push_back({0, "mass_error", 1e-13, "round-off"});
    return {problem};
}

}  // namespace frana::verify
