// Dam breaks and a sliding cap on planes with Coulomb friction, in one dimension: strips between walls.
#include <algorithm>
#include <cmath>

#include "verify/exact_slope_flow.h"
#include "verify/library.h"
#include "verify/trial.h"

namespace frana::verify {
namespace {

/// A strip of six cells' width from x0 to x1 on a plane that falls along x.
Scene strip(double cell, double x0, double x1, double slope, double mu) {
    const Index nx = static_cast<Index>(std::lround((x1 - x0) / cell)) + 1;
    Scene scene = scene_on(nx, 7, cell, [slope](double x, double) { return -slope * x; }, x0);
    scene.sides = Sides::wall;
    scene.bed_law = bed::Coulomb{mu};
    return scene;
}

/// Shallow form, tan 0.4 / mu 0.2, 1 m behind the dam at x = 0 to the wall at x = -50 m; 6 s. The void that opens at
/// that wall is felt up to -50 + c t + a t^2/2 = 4.1 m; the front stands at 72.9 m.
Measurement run_coulomb_slope(const Setup& setup) {
    constexpr double kSlope = 0.4, kMu = 0.2, kEnd = 6.0;
    const SlopeDam dam{1.0, 9.81, 9.81 * (kSlope - kMu)};
    Scene scene = strip(100.0 / static_cast<double>(setup.cells), -50.0, 90.0, kSlope, kMu);
    scene.terrain = TerrainModel::shallow;
    fill(scene, [](double x, double) { return x < 0.0 ? 1.0 : 0.0; }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kEnd);
    return trial.measure({[&](double x, double) { return dam.at(x, kEnd).depth; },
                          [&](double x, double) { return dam.at(x, kEnd).velocity; },
                          {},
                          [](double x, double) { return x > 10.0; }});
}

/// AvaFrame's dam break on steep terrain: its lengths run along the slope and normal to it, X = x / cos, h = h_v cos,
/// U = u / cos. Window x >= -73.21 m, before the middle of the reservoir's own rear wave (AvaFrame's xMiddle).
Measurement run_slope_dam_on(const Setup& setup, TerrainModel terrain) {
    constexpr double kSlope = 22 * M_PI / 180, kEnd = 5.0;
    const SlopeDam dam = SlopeDam::avaframe();
    const double cosine = std::cos(kSlope);
    const double cell = 100.0 / static_cast<double>(setup.cells);
    Scene scene = strip(cell, -160.0, 40.0, std::tan(kSlope), std::tan(21 * M_PI / 180));
    scene.terrain = terrain;
    fill(scene, [&](double x, double) { return x > -120.0 && x < 0.0 ? dam.depth / cosine : 0.0; }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kEnd);
    return trial.measure({[&](double x, double) { return dam.at(x / cosine, kEnd).depth / cosine; },
                          [&](double x, double) { return dam.at(x / cosine, kEnd).velocity * cosine; },
                          {},
                          [](double x, double) { return x >= -73.21; }});
}

/// The steep form, and beside it the theory's own linearisation in the depth gradient.
Measurement run_slope_dam(const Setup& setup) {
    Measurement m = run_slope_dam_on(setup, TerrainModel::steep);
    const Measurement linear = run_slope_dam_on(setup, TerrainModel::linearised);
    m.add("linear_l2_depth", linear.l2_depth);
    m.add("linear_l2_momentum", linear.l2_momentum);
    return m;
}

/// Shallow form, tan 0.6 / mu 0.3: the cap moves 147 m in 10 s and grows from 40 m to 132 m.
const SlidingCap kCap{2.0, 20.0, 9.81, 9.81 * (0.6 - 0.3)};

Measurement run_sliding_cap(const Setup& setup) {
    constexpr double kStart = 60.0, kEnd = 10.0;
    Scene scene = strip(400.0 / static_cast<double>(setup.cells), 0.0, 400.0, 0.6, 0.3);
    scene.terrain = TerrainModel::shallow;
    fill_cut(scene, [&](double x, double) { return kCap.at(x - kStart, 0.0).depth; }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    const auto centre = [&] { return trial.point_mean([](double x, double) { return x; }); };
    const double start = centre(), fall = 0.5 * kCap.drive * kEnd * kEnd;
    trial.run_to(kEnd);
    const auto state = [&, l = kCap.stretch(kEnd)](double x) { return kCap.at(x - kStart, kEnd, l); };
    Measurement m = trial.measure(
        {[&](double x, double) { return state(x).depth; }, [&](double x, double) { return state(x).velocity; }});
    m.add("centre_error", (centre() - start - fall) / fall);
    return m;
}

std::vector<Residual> joined(std::vector<Residual> list, const std::vector<Residual>& more) {
    list.insert(list.end(), more.begin(), more.end());
    return list;
}

}  // namespace

std::vector<Problem> slope_flow_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"};
    Problem slope{"coulomb_slope",
                  "dry dam break on a slope of 0.4 with friction 0.2, shallow form (Mangeney et al. 2000)",
                  {100, 200, 400, 800}, [] { return SlopeDam{1.0, 9.81, 9.81 * 0.2}.residuals(); }, run_coulomb_slope};
    slope.gates = {{200, "l1_depth", 3.3e-2, "issue gate; prototype 2.7e-2"},
                   {800, "l1_depth", 9e-3, "issue gate; prototype 7.4e-3"},
                   volume};
    Problem dam{"slope_dam", "dam break on 22 degrees, friction 21 degrees, steep terrain (Mangeney et al. 2000)",
                {25, 50, 100, 200},
                [] { return joined(SlopeDam::avaframe().residuals(), SlopeDam::published()); }, run_slope_dam};
    dam.order_of = "l2_depth";
    dam.gates = {{100, "l2_depth", 1.5e-2, "issue gate; AvaFrame 1.6e-2, D-Claw 2.6e-2, prototype 1.6e-2"},
                 {100, "l2_momentum", 3e-2, "issue gate; AvaFrame 5.5e-2, D-Claw 3.2e-2"},
                 volume};
    Problem cap{"sliding_cap",
                "cap that slides and spreads on a slope of 0.6, friction 0.3, shallow form (Savage and Hutter 1989)",
                {100, 200, 400, 800}, [] { return kCap.residuals(); }, run_sliding_cap};
    cap.gates = {{200, "l1_depth", 6e-3, "issue gate; prototype 3.9e-3"},
                 {800, "l1_depth", 1.5e-3, "issue gate; prototype 9.2e-4; order 1 from the gate at 200"},
                 {200, "centre_error", 3e-4, "scheme study, goals; prototype 1.3e-4"},
                 {800, "centre_error", 3e-5, "scheme study, goals; prototype 1.2e-5"},
                 volume};
    return {slope, dam, cap};
}

}  // namespace frana::verify
