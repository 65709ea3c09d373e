// Dam breaks on flat ground between walls, 100 m long, dam in the middle, 6 s (scheme study, section 4).
#include <algorithm>
#include <cmath>

#include "checks/verify/exact_dam_break.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kDamLength = 100.0, kDamAt = 50.0, kDamEnd = 6.0;

Scene channel(Index cells, const Function& depth, const Setup& setup) {
    Scene scene = scene_on(cells + 1, 7, kDamLength / static_cast<double>(cells), [](double, double) { return 0.0; });
    scene.sides = Sides::wall;
    fill(scene, depth, {setup.per_side});
    return scene;
}

/// Sum of |h_{i+1} - h_i| along the middle row [m].
double total_variation(const Frame& frame) {
    const double* h = frame.node("depth")->data + frame.grid.ny / 2 * frame.grid.nx;
    double sum = 0.0;
    for (Index i = 0; i + 1 < frame.grid.nx; ++i) sum += std::abs(h[i + 1] - h[i]);
    return sum;
}

/// Where the depth of the middle row last falls through `level`, linear between nodes [m].
double last_contour(const Frame& frame, double level) {
    const double* h = frame.node("depth")->data + frame.grid.ny / 2 * frame.grid.nx;
    for (Index i = frame.grid.nx - 2; i >= 0; --i)
        if (h[i] >= level && h[i + 1] < level)
            return frame.grid.x(i) + frame.grid.cell * (h[i] - level) / (h[i] - h[i + 1]);
    return kNone;
}

template <class Wave>
Exact exact_of(const Wave& wave) {
    return {[wave](double x, double) { return wave.at((x - kDamAt) / kDamEnd).depth; },
            [wave](double x, double) { return wave.at((x - kDamAt) / kDamEnd).velocity; }};
}

Measurement run_ritter(const Setup& setup) {
    const Ritter wave{1.0};
    Trial trial(channel(
                    setup.cells, [](double x, double) { return x < kDamAt ? 1.0 : 0.0; }, setup),
                setup);
    trial.run_to(kDamEnd);
    Measurement m = trial.measure(exact_of(wave));
    // The tip is infinitely thin: the contour of a hundredth of hl stands where (2 c - s)^2 = 0.09 g hl.
    const double s = (2.0 - 0.3) * std::sqrt(wave.g);
    m.front_error = last_contour(trial.simulation().frame(), 0.01) - (kDamAt + kDamEnd * s);
    m.add("total_variation", total_variation(trial.simulation().frame()), "m");
    return m;
}

Measurement run_stoker(const Setup& setup, double hl, double hr, double end_scale) {
    const Stoker wave(hl, hr);
    const double end = kDamEnd * end_scale;
    Trial trial(channel(
                    setup.cells, [&](double x, double) { return x < kDamAt ? hl : hr; }, setup),
                setup);
    trial.run_to(end);
    const auto state = [&](double x) { return wave.at((x - kDamAt) / end); };
    Measurement m = trial.measure(
        {[&](double x, double) { return state(x).depth; }, [&](double x, double) { return state(x).velocity; }});
    const Frame frame = trial.simulation().frame();
    m.front_error = last_contour(frame, 0.5 * (wave.hm + wave.hr)) - (kDamAt + end * wave.shock);
    m.add("total_variation", total_variation(frame), "m");
    return m;
}

std::vector<Residual> ritter_residuals() {
    const Ritter wave{1.0};
    const double c = std::sqrt(wave.g), t = 6.0;
    double volume = 0.0, momentum = 0.0, riemann = 0.0;
    constexpr int parts = 30000;
    for (int k = 0; k < parts; ++k) {  // midpoints of the fan from -c to 2 c
        const double s = -c + 3 * c * (k + 0.5) / parts;
        const WaveState w = wave.at(s);
        volume += w.depth * t * 3 * c / parts;
        momentum += w.depth * w.velocity * t * 3 * c / parts;
        riemann = std::max(riemann, std::abs(w.velocity + 2 * std::sqrt(wave.g * w.depth) - 2 * c));
    }
    return {{"volume of the fan / (hl c t) - 1", volume / (c * t) - 1, 1e-8},  // midpoint rule: 1/parts^2
            {"momentum of the fan / (g hl^2 t / 2) - 1", momentum / (0.5 * wave.g * t) - 1, 1e-8},
            {"Riemann invariant u + 2 c / (2 c_l) - 1", riemann / (2 * c), 1e-14}};
}

}  // namespace

std::vector<Problem> dam_break_problems() {
    Problem ritter{"ritter",
                   "dam break on a dry bed, exact fan (Ritter 1892)",
                   {100, 200, 400, 800},
                   ritter_residuals,
                   run_ritter};
    ritter.gates = {{200, "l1_depth", 8e-3, "goal; an earlier code 6.7e-3"},
                    {800, "l1_depth", 2.3e-3, "goal; an earlier code 1.8e-3"},
                    {400, "l1_depth", 4e-3, "GeoClaw 3.6e-3 at 400"},
                    {0, "mass_error", 1e-13, "round-off"}};
    Problem stoker{"stoker",
                   "dam break onto shallow water, 1 m on 0.2 m: fan and shock (Stoker 1957)",
                   {100, 200, 400, 800},
                   [] { return Stoker(1.0, 0.2).residuals(); },
                   [](const Setup& s) { return run_stoker(s, 1.0, 0.2, 1.0); }};
    stoker.gates = {{200, "l1_depth", 7.2e-3, "goal"},
                    {800, "l1_depth", 2e-3, "goal"},
                    {400, "l1_depth", 4e-3, "GeoClaw 2.0e-3 at 400, goal 4e-3"},
                    {200, "total_variation", 1.15, "goal; exact 0.80 m"},
                    {0, "mass_error", 1e-13, "round-off"}};
    Problem deep{"stoker_deep",
                 "dam break 10 m on 1 m: a strong shock (Stoker 1957)",
                 {100, 200, 400},
                 [] { return Stoker(10.0, 1.0).residuals(); },
                 [](const Setup& s) { return run_stoker(s, 10.0, 1.0, 0.3); }};
    deep.gates = {{0, "mass_error", 1e-13, "round-off"}};
    return {ritter, stoker, deep};
}

}  // namespace frana::verify
