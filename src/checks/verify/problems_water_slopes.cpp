// Free water on the grid: down slopes under friction.
#include <algorithm>
#include <cmath>

#include "checks/verify/library.h"
#include "checks/verify/water.h"

namespace frana::verify {
namespace {

constexpr Index kSlopeAcross = 3;  ///< cells across

/// A sheet of 1 m starts from rest down a plane under friction. Away from the ends its speed is u = u_n tanh(a t /
/// u_n), u_n the normal flow's (Manning's h^(2/3) sqrt(S) / n for small slopes).
double normal_flow_error(double slope, bool steep, const WaterFriction& friction, Index cells, double& residual,
                         Measurement& m) {
    constexpr double kPlane = 4000.0, kTime = 60.0, kDepth = 1.0;
    WaterScene scene;
    scene.grid = cells_over(cells, kSlopeAcross, kPlane / static_cast<double>(cells));
    scene.bed = [=](double x, double) { return -slope * x; };
    scene.start = [](double, double) { return WaterState{kDepth}; };
    scene.sides[1] = WaterSide::open;
    scene.friction = friction, scene.steep = steep;
    WaterFlow flow(scene);
    const Measurement run = run_water(flow, kTime);
    m.steps += run.steps, m.wall_seconds += run.wall_seconds, m.particles = run.particles;
    m.mass_error = std::max(std::isnan(m.mass_error) ? 0.0 : m.mass_error, run.mass_error);
    residual = std::max(residual, run.value("momentum_residual"));
    // Along the bed: V^2 k = g sin(angle), T = h cos(angle); horizontally u = V cos(angle).
    const double cosine = steep ? 1.0 / std::sqrt(1.0 + slope * slope) : 1.0, thickness = kDepth * cosine;
    const double c = friction.coefficient, g = scene.gravity;
    const double k = friction.law == WaterFriction::Law::manning ? g * c * c / std::pow(thickness, 4.0 / 3.0)
                                                                 : c / (8.0 * thickness);
    const double drive = g * slope * cosine * cosine;  // horizontally
    const double normal = std::sqrt(drive / cosine / k) * cosine;
    return flow.at(cells / 2, 1).u / (normal * std::tanh(drive * kTime / normal)) - 1.0;
}

Measurement run_normal(const Setup& setup) {
    using Law = WaterFriction::Law;
    Measurement m;
    double residual = 0.0;
    m.add("speed_error", normal_flow_error(0.01, false, {Law::manning, 0.03}, setup.cells, residual, m));
    m.add("steep_error", normal_flow_error(0.8, true, {Law::manning, 0.1}, setup.cells, residual, m));
    m.add("darcy_error", normal_flow_error(0.01, true, {Law::darcy_weisbach, 0.07}, setup.cells, residual, m));
    m.add("momentum_residual", residual);
    return m;
}

/// Rain on a plane until it runs off as fast as it falls: h = (n R x / sqrt(S))^(3/5), the kinematic wave.
Measurement run_rain(const Setup& setup) {
    constexpr double kLength = 100.0, kSlope = 0.05, kManning = 0.03, kRain = 2e-5, kTime = 1200.0;
    WaterScene scene;
    scene.grid = cells_over(setup.cells, kSlopeAcross, kLength / static_cast<double>(setup.cells));
    scene.bed = [](double x, double) { return kSlope * (kLength - x); };
    scene.rain = [](double, double) { return kRain; };
    scene.sides[1] = WaterSide::open;
    scene.friction = {WaterFriction::Law::manning, kManning};
    scene.steep = false;
    WaterFlow flow(scene);
    double before = 0.0, after = 0.0;  // what has left, at the last step and the one before it
    Measurement m =
        run_water(flow, kTime, [&](const WaterFlow& now) { before = after, after = now.status().ledger.left; });
    const double width = static_cast<double>(kSlopeAcross) * scene.grid.cell;
    add_norms(flow,
              {[&](double x, double) { return std::pow(kManning * kRain * x / std::sqrt(kSlope), 0.6); },
               [&](double x, double) { return kRain * x / std::pow(kManning * kRain * x / std::sqrt(kSlope), 0.6); }},
              m);
    m.add("outflow_error", (after - before) / flow.status().dt / (kRain * kLength * width) - 1.0);
    return m;
}

}  // namespace

std::vector<Problem> water_slope_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"}, closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem normal{"water_normal",
                   "V15: free water: down a plane to the normal flow of Manning, and of Darcy and Weisbach",
                   {100},
                   {},
                   run_normal};
    normal.gates = {{0, "speed_error", 1e-13, "exact for a constant drive: round-off"},
                    {0, "steep_error", 1e-13, "exact for a constant drive: round-off"},
                    {0, "darcy_error", 1e-13, "exact for a constant drive: round-off"}};
    Problem rain{"water_rain",
                 "free water: rain on a plane until it runs off as fast (kinematic wave)",
                 {50, 100},
                 {},
                 run_rain};
    rain.gates = {
        {100, "l1_depth", 2.3e-3, "a fifth above its own figure; the kinematic wave leaves out h' of 7 mm in 100 m"},
        {0, "outflow_error", 1e-3, "what falls runs off; 0.2 per mille is still on its way"}};
    std::vector<Problem> all = {normal, rain};
    for (Problem& problem : all) {
        problem.has_presets = false;
        problem.gates.push_back(volume), problem.gates.push_back(closed);
    }
    return all;
}

}  // namespace frana::verify
