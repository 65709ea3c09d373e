// Lakes at rest: nothing may move, on any bed, wherever the points stand. No level is given to the time stepping (the
// level only fits the initial masses). The exact answer is the level itself: h + z constant, v = 0.
#include <algorithm>
#include <cmath>

#include "checks/verify/lakes.h"
#include "checks/verify/library.h"

namespace frana::verify {
namespace {

/// Largest |h + z - level| over the nodes whose 5 x 5 neighbours are all wet [m]. Nearer to the shore a node averages
/// over partly dry ground and stands higher.
double surface_error(const Frame& frame, double level) {
    const Index nx = frame.grid.nx, ny = frame.grid.ny;
    const double *h = frame.node("depth")->data, *surface = frame.node("surface")->data;
    double worst = 0.0;
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i) {
            bool wet = true;
            for (Index b = std::max<Index>(j - 2, 0); b <= std::min(j + 2, ny - 1); ++b)
                for (Index a = std::max<Index>(i - 2, 0); a <= std::min(i + 2, nx - 1); ++a) wet &= h[b * nx + a] > 0.0;
            if (wet) worst = std::max(worst, std::abs(surface[j * nx + i] - level));
        }
    return worst;
}

/// What one lake does at worst.
struct Unrest {
    double speed = 0.0, surface = 0.0;
};
Unrest unrest_of(const Lake& lake, Trial& trial, double end) {
    Unrest worst;
    trial.run_to(end, [&](const Status& now) { worst.speed = std::max(worst.speed, now.max_speed_on_map); });
    const Frame frame = trial.simulation().frame();
    worst.speed = std::max(worst.speed, frame.status.max_speed_on_map);
    const double* v = frame.node("velocity")->data;
    for (Index k = 0; k < frame.grid.size(); ++k)
        worst.speed = std::max(worst.speed, std::hypot(v[3 * k], v[3 * k + 1]));
    worst.surface = surface_error(frame, lake.level);
    return worst;
}

/// Adds one set-up of a lake to what is known of the others.
void add_lake(Measurement& m, Unrest& worst, const Lake& lake, const Setup& setup, Placement placement,
              TerrainModel terrain, double end) {
    Scene scene = scene_of(lake, setup, placement);
    scene.terrain = terrain;
    Trial trial(std::move(scene), setup);
    const Unrest now = unrest_of(lake, trial, end);
    const Measurement one = trial.measure();
    m.particles = std::max(m.particles, one.particles);
    m.steps += one.steps;
    m.wall_seconds += one.wall_seconds;
    m.mass_error = std::isnan(m.mass_error) ? one.mass_error : std::max(m.mass_error, one.mass_error);
    worst = {std::max(worst.speed, now.speed), std::max(worst.surface, now.surface)};
    m.add(std::string(terrain == TerrainModel::steep ? "steep_" : "shallow_") + name_of(placement) +
              (end > 1.0 ? "_" + std::to_string(std::lround(end)) + "s" : ""),
          now.speed, "m/s");
}

/// All placements on steep and shallow terrain for 1 s, and, if `minute`, the most irregular one for a minute.
Measurement rest(const Lake& lake, const Setup& setup, bool minute) {
    Measurement m;
    Unrest worst;
    const bool paper = setup.preset == "paper";  // has shallow terrain only
    for (const TerrainModel terrain : {TerrainModel::steep, TerrainModel::shallow}) {
        if (paper && terrain == TerrainModel::steep) continue;
        for (const Placement placement : kPlacements) add_lake(m, worst, lake, setup, placement, terrain, 1.0);
    }
    if (!paper) m.add("surface_error", worst.surface, "m");  // the paper's depth lives on the points
    const TerrainModel usual = paper ? TerrainModel::shallow : TerrainModel::steep;
    if (minute) add_lake(m, worst, lake, setup, Placement::full_jitter, usual, 60.0);
    m.add("max_speed", worst.speed, "m/s");
    if (!paper && minute) m.add("surface_error_60s", worst.surface, "m");
    return m;
}

/// The island's lake with ripples of 1e-8 m/s, from points at random places. Nothing feeds them, and at the start all
/// their energy is motion. So the kinetic energy may never be larger than then.
Measurement ripple(const Setup& setup) {
    constexpr double speed = 1e-8;
    Scene scene = scene_of(lake_island(), setup, Placement::full_jitter);
    scene.terrain = TerrainModel::shallow;
    Noise noise;
    for (Index p = 0; p < scene.particles.count(); ++p) {
        scene.particles.vx[p] = speed * noise.next();
        scene.particles.vy[p] = speed * noise.next();
    }
    Trial trial(std::move(scene), setup);
    const double start = trial.simulation().frame().status.kinetic;
    double largest = 0.0;
    trial.run_to(60.0, [&](const Status& now) { largest = std::max(largest, now.kinetic); });
    Measurement m = trial.measure();
    m.energy_error = kNone;  // the budget is lost in the round-off of the lake's potential energy
    m.add("kinetic_growth", largest / start);
    m.add("kinetic_left", trial.simulation().status().kinetic / start);
    return m;
}

/// The minute is run on the first of the grids.
Problem problem_of(const std::string& name, const std::string& title, const std::vector<Index>& grids, Lake (*lake)()) {
    Problem problem{name, title, grids, {}, [lake, first = grids.front()](const Setup& setup) {
                        return rest(lake(), setup, setup.cells == first);
                    }};
    problem.gates = {{0, "max_speed", 1e-12, "goal: round-off of 1 to 60 s"},
                     {0, "surface_error", 1e-12, "round-off after 1 s, goal of the scheme study"},
                     {0, "mass_error", 1e-13, "round-off"}};
    problem.needs_level = true;
    return problem;
}

}  // namespace

std::vector<Problem> lake_problems() {
    Problem waves{"lake_ripple",
                  "faint ripples on the lake around the island die away or at least do not grow, 60 s",
                  {50},
                  {},
                  ripple};
    waves.gates = {{0, "kinetic_growth", 1.0, "no source of energy"}, {0, "mass_error", 1e-13, "round-off"}};
    return {waves,
            problem_of("lake_z1", "lake at rest over a smooth bump (Fois et al. 2024, Z1), 11 set-ups", {50}, lake_z1),
            problem_of("lake_z2", "lake at rest over a step (Fois et al. 2024, Z2), 11 set-ups", {50}, lake_z2),
            problem_of("lake_island", "lake at rest around an island, 11 set-ups", {50, 40, 60}, lake_island),
            problem_of("lake_bump",
                       "lake at rest on both sides of an emerged bump, 11 set-ups; no flow over it, for "
                       "want of an inflow",
                       {100, 50, 200}, lake_bump)};
}

}  // namespace frana::verify
