// Free water that is viscous: laminar films on a plane, and shear that decays.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/library.h"
#include "checks/verify/water.h"

namespace frana::verify {
namespace {

constexpr Index kViscousAcross = 3;  ///< cells across
constexpr double kNu = 1e-4;         ///< [m^2/s]

/// What is measured of a film, and of all of them together.
struct Film {
    double error = 0.0, residual = 0.0;
    void add(const Measurement& run, Measurement& m) {
        m.steps += run.steps, m.wall_seconds += run.wall_seconds, m.particles = run.particles;
        m.mass_error = std::max(std::isnan(m.mass_error) ? 0.0 : m.mass_error, run.mass_error);
        residual = std::max(residual, run.value("momentum_residual"));
    }
};

/// A film of even depth that starts from rest down a plane. With T its thickness across the bed the mean speed along it
/// tends to Nusselt's (1916), g sin(angle) T^2 / (3 nu). It does so as 1 - exp(-3 nu t / T^2) as long as the profile is
/// a parabola. With Manning's friction besides, it tends to the speed at which both hold the weight.
Film even_film(double slope, bool steep, const WaterFriction& friction, double time, Measurement& m) {
    constexpr double kPlane = 120.0, kDepth = 0.02;
    constexpr Index kCells = 200;  // whatever the grid: so many that the ends are not felt in the middle
    WaterScene scene;
    scene.grid = cells_over(kCells, kViscousAcross, kPlane / static_cast<double>(kCells));
    scene.bed = [=](double x, double) { return -slope * x; };
    scene.start = [](double, double) { return WaterState{kDepth}; };
    scene.sides[1] = WaterSide::open;
    scene.viscosity.kinematic = kNu, scene.friction = friction, scene.steep = steep;
    WaterFlow flow(scene);
    Film film;
    film.add(run_water(flow, time), m);
    const double cosine = steep ? 1.0 / std::sqrt(1.0 + slope * slope) : 1.0, t = kDepth * cosine;
    const double drive =
        scene.gravity * slope * cosine;  // along the bed; without steep slopes their sine is the tangent
    const double nusselt = drive * t * t / (3.0 * kNu), rate = 3.0 * kNu / (t * t);
    double exact = nusselt * -std::expm1(-rate * time);
    if (friction.law == WaterFriction::Law::manning) {  // of 0 = drive - rate V - k V^2, by the end of the run
        const double k = scene.gravity * friction.coefficient * friction.coefficient / std::pow(t, 4.0 / 3.0);
        exact = 2.0 * drive / (rate + std::sqrt(rate * rate + 4.0 * k * drive));
    }
    film.error = flow.at(kCells / 2, 1).u / (exact * cosine) - 1.0;
    return film;
}

/// Rain on a plane until it runs off as fast as it falls: h = (3 nu R x / (g S))^(1/3). It is the kinematic wave of a
/// film.
void rain_fed_film(const Setup& setup, Measurement& m) {
    constexpr double kLength = 20.0, kSlope = 0.05, kRain = 2e-5, kTime = 900.0;
    WaterScene scene;
    scene.grid = cells_over(setup.cells, kViscousAcross, kLength / static_cast<double>(setup.cells));
    scene.bed = [](double x, double) { return kSlope * (kLength - x); };
    scene.rain = [](double, double) { return kRain; };
    scene.sides[1] = WaterSide::open;
    scene.viscosity.kinematic = kNu, scene.steep = false;
    WaterFlow flow(scene);
    Film film;
    film.add(run_water(flow, kTime), m);
    const auto depth = [&](double x) { return std::cbrt(3.0 * kNu * kRain * x / (scene.gravity * kSlope)); };
    add_norms(flow,
              {[&](double x, double) { return depth(x); }, [&](double x, double) { return kRain * x / depth(x); }}, m);
}

Measurement run_film(const Setup& setup) {
    Measurement m;
    constexpr double kTime = 2.0;  // comparable with T^2 / (3 nu), 1.3 s
    const Film gentle = even_film(0.02, false, {}, kTime, m), steep = even_film(0.8, true, {}, kTime, m);
    const Film rough = even_film(0.02, false, {WaterFriction::Law::manning, 0.02}, 30.0, m);
    rain_fed_film(setup, m);
    m.add("speed_error", gentle.error);
    m.add("steep_error", steep.error);
    m.add("rough_error", rough.error);
    m.add("momentum_residual", std::max({gentle.residual, steep.residual, rough.residual}));
    return m;
}

/// u = u_0 sin(k y), here a cosine between walls that water slides along, dies at the rate nu (k^2 + chi / h^2). Nearly no
/// gravity. The ends of the channel, which stop the flow, are too far to be felt in the middle.
Measurement run_shear(const Setup& setup) {
    constexpr double kWidth = 2.0, kWave = constants::kPi, kDepth = 1.5, kSpeed = 1e-3, kTime = 1.0, kThick = 0.1;
    WaterScene scene;
    scene.grid = cells_over(3 * setup.cells, setup.cells, kWidth / static_cast<double>(setup.cells));
    scene.start = [](double, double y) { return WaterState{kDepth, kSpeed * std::cos(kWave * y), 0.0}; };
    scene.gravity = 1e-4;
    scene.viscosity.kinematic = kThick;
    WaterFlow flow(scene);
    Measurement m = run_water(flow, kTime);
    const double left = std::exp(-kThick * (kWave * kWave + scene.viscosity.shear / (kDepth * kDepth)) * kTime);
    double error = 0.0, size = 0.0;
    for (Index j = 0; j < setup.cells; ++j) {
        const double exact = kSpeed * left * std::cos(kWave * scene.grid.y(j));
        error += std::abs(flow.at(3 * setup.cells / 2, j).u - exact), size += std::abs(exact);
    }
    m.l1_momentum = error / size;
    return m;
}

}  // namespace

std::vector<Problem> water_viscous_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"}, closed{0, "momentum_residual", 1e-12, "round-off"};
    Problem film{"water_film",
                 "free water: laminar films down a plane, even (Nusselt 1916) and fed by rain",
                 {50, 100},
                 {},
                 run_film};
    film.gates = {{0, "speed_error", 1e-12, "exact for a constant drive: round-off of a bed 2 m high"},
                  {0, "steep_error", 1e-12, "exact for a constant drive: round-off of a bed 96 m high"},
                  {0, "rough_error", 1e-12, "a steady speed is kept: round-off"}};
    Problem shear{"water_shear", "V20: free water: viscous decay of a shear wave", {12, 24, 48}, {}, run_shear};
    shear.order_of = "l1_momentum";
    shear.gates = {{48, "l1_momentum", 1.7e-3, "a fifth above its own figure: 1.4e-3"}};
    film.gates.push_back({100, "l1_depth", 5.8e-3,
                          "a fifth above its own figure: 4.8e-3; the kinematic wave leaves out h' of 6 mm in 20 m"});
    std::vector<Problem> all = {film, shear};
    for (Problem& problem : all) {
        problem.has_presets = false;
        problem.gates.push_back(volume), problem.gates.push_back(closed);
    }
    return all;
}

}  // namespace frana::verify
