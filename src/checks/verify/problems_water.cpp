// Free water on the grid: lakes over bed and confined mass, dam breaks, bowls.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_bowl.h"
#include "checks/verify/exact_dam_break.h"
#include "checks/verify/exact_radial_dam.h"
#include "checks/verify/lakes.h"
#include "checks/verify/library.h"
#include "checks/verify/water.h"

namespace frana::verify {
namespace {

constexpr double kWaterLength = 100.0, kWaterDam = 50.0, kWaterEnd = 6.0;
constexpr Index kWaterAcross = 3;  ///< cells of a one-dimensional problem

/// Bumps and a wall of confined mass, some of it higher than the water.
double heap(double x, double y) {
    const double bump = std::exp(-0.8 * ((x - 3) * (x - 3) + (y - 6) * (y - 6)));
    return 3.0 * bump + (x > 7.5 && x < 8.5 && y < 5.0 ? 11.0 : 0.0);
}

/// What a lake at rest does in 10 s.
struct Stillness {
    double speed = 0.0, surface = 0.0;
    Measurement run;
};
Stillness stillness(const Lake& lake, const Setup& setup, bool heaped, bool steep) {
    constexpr double kTime = 10.0, kWet = 1e-3;
    WaterScene scene;
    scene.grid = cells_over(setup.cells, setup.cells, lake.length / static_cast<double>(setup.cells));
    scene.bed = lake.bed, scene.steep = steep;
    if (heaped) scene.confined = heap;
    const auto ground = [&](double x, double y) { return lake.bed(x, y) + (heaped ? heap(x, y) : 0.0); };
    scene.start = [&](double x, double y) { return WaterState{std::max(0.0, lake.level - ground(x, y))}; };
    WaterFlow flow(scene);
    Stillness still;
    still.run = run_water(flow, kTime,
                          [&](const WaterFlow& now) { still.speed = std::max(still.speed, now.status().max_speed); });
    for (Index j = 0; j < scene.grid.ny; ++j)
        for (Index i = 0; i < scene.grid.nx; ++i)
            if (flow.at(i, j).depth > kWet)
                still.surface = std::max(still.surface, std::abs(flow.surface(i, j) - lake.level));
    return still;
}

Measurement run_still_water(const Setup& setup) {
    Measurement m;
    double speed = 0.0, surface = 0.0, mass = 0.0, wall = 0.0;
    std::vector<Extra> speeds;
    const std::pair<const char*, Lake> lakes[] = {{"bump", lake_z1()}, {"step", lake_z2()}, {"island", lake_island()}};
    for (const auto& [name, lake] : lakes)
        for (const bool heaped : {false, true}) {
            const Stillness still = stillness(lake, setup, heaped, heaped);
            speeds.push_back({std::string(name) + (heaped ? "_heaped" : ""), still.speed, "m/s"});
            speed = std::max(speed, still.speed), surface = std::max(surface, still.surface);
            mass = std::max(mass, still.run.mass_error), wall += still.run.wall_seconds;
            m.steps += still.run.steps, m.particles = still.run.particles;
        }
    m.mass_error = mass, m.wall_seconds = wall;
    m.extras = speeds;
    m.add("max_speed", speed, "m/s");
    m.add("surface_error", surface, "m");
    return m;
}

WaterScene channel(Index cells, const Function& depth) {
    WaterScene scene;
    scene.grid = cells_over(cells, kWaterAcross, kWaterLength / static_cast<double>(cells));
    scene.start = [depth](double x, double y) { return WaterState{depth(x, y)}; };
    return scene;
}

/// Sum of |h_{i+1} - h_i| along a row [m].
double total_variation(const WaterFlow& flow) {
    double sum = 0.0;
    for (Index i = 0; i + 1 < flow.body().grid.nx(); ++i)
        sum += std::abs(flow.at(i + 1, 1).depth - flow.at(i, 1).depth);
    return sum;
}

/// Where the depth of a row last falls through `level`, linear between nodes [m].
double last_contour(const WaterFlow& flow, double level) {
    const GridGeometry& g = flow.body().grid.geometry();
    for (Index i = g.nx - 2; i >= 0; --i) {
        const double here = flow.at(i, 1).depth, next = flow.at(i + 1, 1).depth;
        if (here >= level && next < level) return g.x(i) + g.cell * (here - level) / (here - next);
    }
    return kNone;
}

/// A dam break; `level` is the depth whose contour stands at `front` [m].
template <class Wave>
Measurement break_dam(const Wave& wave, double hl, double hr, double level, double front, const Setup& setup) {
    WaterFlow flow(channel(setup.cells, [&](double x, double) { return x < kWaterDam ? hl : hr; }));
    Measurement m = run_water(flow, kWaterEnd);
    const auto state = [&](double x) { return wave.at((x - kWaterDam) / kWaterEnd); };
    add_norms(flow,
              {[&](double x, double) { return state(x).depth; }, [&](double x, double) { return state(x).velocity; }},
              m);
    m.front_error = last_contour(flow, level) - (kWaterDam + kWaterEnd * front);
    m.add("total_variation", total_variation(flow), "m");
    return m;
}

Measurement run_ritter(const Setup& setup) {
    const Ritter wave{1.0};
    return break_dam(wave, 1.0, 0.0, 0.01, (2.0 - 0.3) * std::sqrt(wave.g),
                     setup);  // 0.01 hl: (2 c - s)^2 = 0.09 g hl
}

Measurement run_stoker(const Setup& setup) {
    const Stoker wave(1.0, 0.2);
    return break_dam(wave, wave.hl, wave.hr, 0.5 * (wave.hm + wave.hr), wave.shock, setup);
}

/// Three periods of a swing.
Measurement swing(const Bowl& bowl, const Setup& setup) {
    const double cell = bowl.width / static_cast<double>(setup.cells), end = 3.0 * bowl.period;
    WaterScene scene;
    scene.grid = cells_over(setup.cells, setup.cells, cell);
    scene.bed = bowl.bed, scene.steep = false;
    scene.start = [&](double x, double y) {
        const BowlState w = bowl.at(x, y, 0.0);
        return WaterState{std::max(0.0, w.depth), w.u, w.v};
    };
    WaterFlow flow(scene);
    const double start = energy_of(flow);
    Measurement m = run_water(flow, end);
    ExactWater exact{[&](double x, double y) { return std::max(0.0, bowl.at(x, y, end).depth); }};
    if (!bowl.round) {  // the round one turns then
        exact.u = [&](double x, double y) { return bowl.at(x, y, end).u; };
        exact.v = [&](double x, double y) { return bowl.at(x, y, end).v; };
    }
    add_norms(flow, exact, m);
    m.add("energy_drift", (energy_of(flow) - start) / bowl.swing);
    return m;
}

/// A quarter of the square around the column, cells counted along its whole side; walls are the symmetry.
Measurement run_radial_dam(const Setup& setup) {
    constexpr double kReach = 24.0, kLevel = 0.01;
    static const RadialDam reference(0.0);
    const Index half = setup.cells / 2;
    const double cell = kReach / static_cast<double>(half);
    const auto column = [](double x, double y) {
        return std::hypot(x, y) < RadialDam::kRadius ? RadialDam::kDepth : 0.0;
    };
    WaterScene scene;
    scene.grid = cells_over(half, half, cell);
    scene.start = [&](double x, double y) { return WaterState{cell_mean(column, x, y, cell)}; };
    WaterFlow flow(scene);
    Measurement m = run_water(flow, RadialDam::kEnd);
    const auto speed = [&](double x, double y) { return reference.at(std::hypot(x, y)).velocity / std::hypot(x, y); };
    add_norms(
        flow,
        {[&](double x, double y) { return reference.at(std::hypot(x, y)).depth; },
         [&](double x, double y) { return x * speed(x, y); }, [&](double x, double y) { return y * speed(x, y); }},
        m);
    double deep = 0.0;
    for (Index j = 0; j < half; ++j)
        for (Index i = 0; i < half; ++i) deep += flow.at(i, j).depth > kLevel;
    m.front_error = cell * std::sqrt(4.0 * deep / constants::kPi) - reference.contour(kLevel);
    return m;
}

}  // namespace

std::vector<Problem> water_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"}, closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem lake{"water_lake",
                 "lakes at rest over a bump, a step and around an island, confined mass in them or not",
                 {50},
                 {},
                 run_still_water};
    lake.gates = {{0, "max_speed", 1e-12, "round-off: nothing flows between level cells"},
                  {0, "surface_error", 1e-13, "round-off of 10 m"},
                  volume};
    const std::string own = "a fifth above its own figure: ";
    Problem ritter{
        "water_ritter", "V15: free water: dam break on a dry bed (Ritter 1892)", {100, 200, 400, 800}, {}, run_ritter};
    ritter.gates = {{400, "l1_depth", 2.1e-3, own + "1.7e-3; GeoClaw 3.6e-3"},
                    {800, "l1_depth", 1.05e-3, own + "8.6e-4"}};
    Problem stoker{"water_stoker",
                   "V15: free water: dam break onto shallow water (Stoker 1957)",
                   {100, 200, 400, 800},
                   {},
                   run_stoker};
    stoker.gates = {{400, "l1_depth", 1.9e-3, own + "1.5e-3; GeoClaw 2.0e-3"},
                    {800, "l1_depth", 9.7e-4, own + "8.0e-4"},
                    {0, "total_variation", 0.82, "exact 0.80 m: no overshoot"}};
    Problem planar{"water_thacker_p",
                   "free water: a tilted plane turns in a bowl, 3 periods (Thacker 1981)",
                   {50, 100, 200},
                   {},
                   [](const Setup& s) { return swing(planar_bowl(), s); }};
    planar.gates = {{100, "l1_depth", 2.1e-2, own + "1.75e-2"},
                    {200, "l1_depth", 8e-3, own + "6.7e-3"},
                    {200, "energy_drift", 6e-3, own + "-4.9e-3"}};
    Problem radial{"water_thacker_r",
                   "free water: a round mound falls and rises in a bowl, 3 periods (Thacker 1981)",
                   {50, 100, 200},
                   {},
                   [](const Setup& s) { return swing(radial_bowl(), s); }};
    radial.gates = {{100, "l1_depth", 1.4e-2, own + "1.17e-2"},
                    {200, "l1_depth", 5.5e-3, own + "4.6e-3"},
                    {200, "energy_drift", 3.2e-2, own + "-2.7e-2"}};
    Problem dam{"water_radial_dam", "free water: round dam break on a dry bed", {80, 160, 320}, {}, run_radial_dam};
    dam.gates = {{160, "l1_depth", 2.5e-2, own + "2.1e-2"}, {320, "l1_depth", 1.22e-2, own + "1.02e-2"}};
    std::vector<Problem> all = {lake, ritter, stoker, planar, radial, dam};
    for (Problem& problem : all) {
        problem.has_presets = false;
        if (problem.name != "water_lake") problem.gates.push_back(volume), problem.gates.push_back(closed);
    }
    return all;
}

}  // namespace frana::verify
