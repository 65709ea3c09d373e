// Dam breaks and a sliding cap on planes with Coulomb friction, in one dimension: strips between walls.
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/constants.h"
#include "checks/verify/exact_slope_flow.h"
#include "checks/verify/library.h"
#include "checks/verify/reference_steep_dam.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

/// A strip of six cells' width from x0 to x1 on a plane that falls along x.
Scene strip(double cell, double x0, double x1, double slope, double mu) {
    const Index nx = static_cast<Index>(std::lround((x1 - x0) / cell)) + 1;
    Scene scene = scene_on(
        nx, 7, cell, [slope](double x, double) { return -slope * x; }, x0);
    scene.sides = Sides::wall;
    scene.bed_law = bed::Coulomb{mu};
    return scene;
}

/// Shallow form, tan 0.4 / mu 0.2, 1 m behind the dam at x = 0 to the wall at x = -50 m; 6 s. The void that opens at
/// that wall is felt up to -50 + c t + a t^2/2 = 4.1 m. The front stands at 72.9 m.
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
constexpr double kDamSlope = 22 * constants::kPi / 180.0, kDamEnd = 5.0;

Trial slope_dam_trial(const Setup& setup, TerrainModel terrain) {
    const double cosine = std::cos(kDamSlope), depth = SlopeDam::avaframe().depth / cosine;
    const double cell = 100.0 / static_cast<double>(setup.cells);
    Scene scene = strip(cell, -160.0, 40.0, std::tan(kDamSlope), std::tan(21 * constants::kPi / 180.0));
    scene.terrain = terrain;
    fill(scene, [&](double x, double) { return x > -120.0 && x < 0.0 ? depth : 0.0; }, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kDamEnd);
    return trial;
}

bool before_rear_wave(double x, double) { return x >= -73.21; }

/// The theory of Mangeney et al., which is linearised in the depth gradient.
Exact linearised_dam() {
    const SlopeDam dam = SlopeDam::avaframe();
    const double cosine = std::cos(kDamSlope);
    return {[=](double x, double) { return dam.at(x / cosine, kDamEnd).depth / cosine; },
            [=](double x, double) { return dam.at(x / cosine, kDamEnd).velocity * cosine; },
            {},
            before_rear_wave};
}

/// The same dam by the steep equations themselves.
Exact steep_dam() {
    constexpr double kBehind = 120.0;  // [m]; parcels of 1.2 cm change the depths by less than 3e-4
    const SteepDam::Plane plane{std::tan(kDamSlope), std::tan(21 * constants::kPi / 180.0), 1.0 / std::cos(kDamSlope),
                                9.81};
    const auto dam = std::make_shared<const SteepDam>(plane, kBehind, kDamEnd, 10000);
    return {[dam](double x, double) { return dam->depth_at(x); },
            [dam](double x, double) { return dam->velocity_at(x); },
            {},
            before_rear_wave};
}

/// The steep form against the linearised theory and against its own equations, and the linearised form against the theory.
Measurement run_slope_dam(const Setup& setup) {
    Trial steep = slope_dam_trial(setup, TerrainModel::steep);
    Measurement m = steep.measure(linearised_dam());
    const Measurement full = steep.measure(steep_dam());
    const Measurement linear = slope_dam_trial(setup, TerrainModel::linearised).measure(linearised_dam());
    m.add("linear_l2_depth", linear.l2_depth);
    m.add("linear_l2_momentum", linear.l2_momentum);
    m.add("full_l2_depth", full.l2_depth);
    m.add("full_l2_momentum", full.l2_momentum);
    return m;
}

/// Shallow form, tan 0.6 / mu 0.3. The cap moves 147 m in 10 s and grows from 40 m to 132 m.
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

}  // namespace

std::vector<Problem> slope_flow_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"};
    Problem slope{"coulomb_slope",
                  "dry dam break on a slope of 0.4 with friction 0.2, shallow form (Mangeney et al. 2000)",
                  {100, 200, 400, 800},
                  [] {
                      return SlopeDam{1.0, 9.81, 9.81 * 0.2}.residuals();
                  },
                  run_coulomb_slope};
    slope.gates = {{200, "l1_depth", 3.3e-2, "goal; an earlier code 2.7e-2"},
                   {800, "l1_depth", 9e-3, "goal; an earlier code 7.4e-3"},
                   volume};
    Problem dam{
        "slope_dam",
        "dam break on 22 degrees, friction 21 degrees, steep terrain (Mangeney et al. 2000)",
        {25, 50, 100, 200},
        [] { return joined(joined(SlopeDam::avaframe().residuals(), SlopeDam::published()), steep_dam_residuals()); },
        run_slope_dam};
    dam.order_of = "l2_depth";
    dam.gates = {{100, "l2_depth", 1.5e-2, "goal; AvaFrame 1.6e-2, D-Claw 2.6e-2, an earlier code 1.6e-2"},
                 {100, "l2_momentum", 3e-2, "goal; AvaFrame 5.5e-2, D-Claw 3.2e-2"},
                 {200, "full_l2_depth", 7.6e-3, "where the error against the linearised theory stays on any grid"},
                 {200, "full_l2_momentum", 2.5e-2, "where the error against the linearised theory stays on any grid"},
                 volume};
    Problem cap{"sliding_cap",
                "cap that slides and spreads on a slope of 0.6, friction 0.3, shallow form (Savage and Hutter 1989)",
                {100, 200, 400, 800},
                [] { return kCap.residuals(); },
                run_sliding_cap};
    cap.gates = {{200, "l1_depth", 6e-3, "goal; an earlier code 3.9e-3"},
                 {800, "l1_depth", 1.5e-3, "goal; an earlier code 9.2e-4; order 1 from the gate at 200"},
                 {200, "centre_error", 3e-4, "goal; an earlier code 1.3e-4"},
                 {800, "centre_error", 3e-5, "goal; an earlier code 1.2e-5"},
                 volume};
    return {slope, dam, cap};
}

}  // namespace frana::verify
