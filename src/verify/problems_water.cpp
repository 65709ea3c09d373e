// Free water on the grid: lakes over bed and confined mass, dam breaks, bowls, flow down slopes.
#include <algorithm>
#include <cmath>

#include "verify/exact_bowl.h"
#include "verify/exact_dam_break.h"
#include "verify/exact_radial_dam.h"
#include "verify/lakes.h"
#include "verify/library.h"
#include "verify/water.h"

namespace frana::verify {
namespace {

constexpr double kLength = 100.0, kDam = 50.0, kEnd = 6.0;
constexpr Index kAcross = 3;  ///< cells of a one-dimensional problem

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
    still.run = run_water(flow, kTime, [&](const WaterFlow& now) {
        still.speed = std::max(still.speed, now.status().max_speed);
    });
    for (Index j = 0; j < scene.grid.ny; ++j)
        for (Index i = 0; i < scene.grid.nx; ++i)
            if (flow.at(i, j).depth > kWet)
                still.surface = std::max(still.surface, std::abs(flow.surface(i, j) - lake.level));
    return still;
}

Measurement run_lake(const Setup& setup) {
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
    scene.grid = cells_over(cells, kAcross, kLength / static_cast<double>(cells));
    scene.start = [depth](double x, double y) { return WaterState{depth(x, y)}; };
    return scene;
}

/// Sum of |h_{i+1} - h_i| along a row [m].
double total_variation(const WaterFlow& flow) {
    double sum = 0.0;
    for (Index i = 0; i + 1 < flow.body().grid.nx(); ++i) sum += std::abs(flow.at(i + 1, 1).depth - flow.at(i, 1).depth);
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
    WaterFlow flow(channel(setup.cells, [&](double x, double) { return x < kDam ? hl : hr; }));
    Measurement m = run_water(flow, kEnd);
    const auto state = [&](double x) { return wave.at((x - kDam) / kEnd); };
    add_norms(flow, {[&](double x, double) { return state(x).depth; }, [&](double x, double) { return state(x).velocity; }}, m);
    m.front_error = last_contour(flow, level) - (kDam + kEnd * front);
    m.add("total_variation", total_variation(flow), "m");
    return m;
}

Measurement run_ritter(const Setup& setup) {
    const Ritter wave{1.0};
    return break_dam(wave, 1.0, 0.0, 0.01, (2.0 - 0.3) * std::sqrt(wave.g), setup);  // 0.01 hl: (2 c - s)^2 = 0.09 g hl
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
    const auto column = [](double x, double y) { return std::hypot(x, y) < RadialDam::kRadius ? RadialDam::kDepth : 0.0; };
    WaterScene scene;
    scene.grid = cells_over(half, half, cell);
    scene.start = [&](double x, double y) { return WaterState{cell_mean(column, x, y, cell)}; };
    WaterFlow flow(scene);
    Measurement m = run_water(flow, RadialDam::kEnd);
    const auto speed = [&](double x, double y) { return reference.at(std::hypot(x, y)).velocity / std::hypot(x, y); };
    add_norms(flow, {[&](double x, double y) { return reference.at(std::hypot(x, y)).depth; },
                     [&](double x, double y) { return x * speed(x, y); }, [&](double x, double y) { return y * speed(x, y); }}, m);
    double deep = 0.0;
    for (Index j = 0; j < half; ++j)
        for (Index i = 0; i < half; ++i) deep += flow.at(i, j).depth > kLevel;
    m.front_error = cell * std::sqrt(4.0 * deep / M_PI) - reference.contour(kLevel);
    return m;
}

/// A sheet of 1 m starts from rest down a plane under friction: away from the ends its speed is
/// u = u_n tanh(a t / u_n), u_n the normal flow's (Manning's h^(2/3) sqrt(S) / n for small slopes).
double normal_flow_error(double slope, bool steep, const WaterFriction& friction, Index cells, double& residual, Measurement& m) {
    constexpr double kPlane = 4000.0, kTime = 60.0, kDepth = 1.0;
    WaterScene scene;
    scene.grid = cells_over(cells, kAcross, kPlane / static_cast<double>(cells));
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
    const double pull = g * slope * cosine * cosine;  // horizontally
    const double normal = std::sqrt(pull / cosine / k) * cosine;
    return flow.at(cells / 2, 1).u / (normal * std::tanh(pull * kTime / normal)) - 1.0;
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
    constexpr double kSlope = 0.05, kManning = 0.03, kRain = 2e-5, kTime = 1200.0;
    WaterScene scene = channel(setup.cells, [](double, double) { return 0.0; });
    scene.bed = [](double x, double) { return kSlope * (kLength - x); };
    scene.rain = [](double, double) { return kRain; };
    scene.sides[1] = WaterSide::open;
    scene.friction = {WaterFriction::Law::manning, kManning};
    scene.steep = false;
    WaterFlow flow(scene);
    double before = 0.0, after = 0.0;  // what has left, at the last step and the one before it
    Measurement m = run_water(flow, kTime, [&](const WaterFlow& now) { before = after, after = now.status().ledger.left; });
    const double width = static_cast<double>(kAcross) * scene.grid.cell;
    add_norms(flow, {[&](double x, double) { return std::pow(kManning * kRain * x / std::sqrt(kSlope), 0.6); },
                     [&](double x, double) {
                         return kRain * x / std::pow(kManning * kRain * x / std::sqrt(kSlope), 0.6);
                     }}, m);
    m.add("outflow_error", (after - before) / flow.status().dt / (kRain * kLength * width) - 1.0);
    return m;
}

}  // namespace

std::vector<Problem> water_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"}, closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem lake{"water_lake", "lakes at rest over a bump, a step and around an island, confined mass in them or not",
                 {50}, {}, run_lake};
    lake.gates = {{0, "max_speed", 1e-12, "round-off: nothing flows between level cells"},
                  {0, "surface_error", 1e-13, "round-off of 10 m"}, volume};
    Problem ritter{"water_ritter", "free water: dam break on a dry bed (Ritter 1892)", {100, 200, 400, 800}, {}, run_ritter};
    Problem stoker{"water_stoker", "free water: dam break onto shallow water (Stoker 1957)", {100, 200, 400, 800}, {}, run_stoker};
    Problem planar{"water_thacker_p", "free water: a tilted plane turns in a bowl, 3 periods (Thacker 1981)", {50, 100, 200}, {},
                   [](const Setup& s) { return swing(planar_bowl(), s); }};
    Problem radial{"water_thacker_r", "free water: a round mound falls and rises in a bowl, 3 periods (Thacker 1981)",
                   {50, 100, 200}, {}, [](const Setup& s) { return swing(radial_bowl(), s); }};
    Problem dam{"water_radial_dam", "free water: round dam break on a dry bed", {80, 160, 320}, {}, run_radial_dam};
    Problem normal{"water_normal", "free water: down a plane to the normal flow of Manning, and of Darcy and Weisbach", {100}, {}, run_normal};
    Problem rain{"water_rain", "free water: rain on a plane until it runs off as fast (kinematic wave)", {50, 100}, {}, run_rain};
    std::vector<Problem> all = {lake, ritter, stoker, planar, radial, dam, normal, rain};
    for (Problem& problem : all) {
        problem.has_presets = false;
        if (problem.name != "water_lake") problem.gates.push_back(volume), problem.gates.push_back(closed);
    }
    return all;
}

}  // namespace frana::verify
