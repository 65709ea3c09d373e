// A column of dry grains collapses on a slope, over rock and over a thin loose layer. By how much does the layer
// lengthen the runout (after Mangeney et al. 2010, J. Geophys. Res. 115, F03040)?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

using constants::kDegree;
constexpr double kCollapseLength = 0.20,
                 kCollapseHeight = 0.14;  ///< of the column, along the slope and normal to it [m]
constexpr double kLayer = 0.005;          ///< of loose grains on all of the slope [m]
constexpr double kRepose = 26.0;          ///< friction angle of flow and bed [degrees]
constexpr double kGrain = 0.0007;         ///< [m]
constexpr double kLatest = 5.0;           ///< when fronts have stopped; thin tails creep on [s]

/// The column behind its gate at the upper end of a strip between walls. Without a law the slope is rock.
Scene column(double slope_deg, const Setup& setup, const ErosionLaw* law, double kappa) {
    const double slope = slope_deg * kDegree, cosine = std::cos(slope),
                 cell = kCollapseLength / static_cast<double>(setup.cells);
    const double room = 0.5 + 4.0 * kCollapseHeight / (std::tan(kRepose * kDegree) - std::tan(slope));
    Scene scene = scene_on(static_cast<Index>(std::ceil((kCollapseLength + room) / cell)) + 1, 5, cell,
                           [&](double x, double) { return -std::tan(slope) * x; });
    scene.sides = Sides::wall;
    scene.density = 1500.0;
    scene.scheme.cfl = 0.5;  // on rock as on loose ground
    scene.bed_law = bed::Coulomb{std::tan(kRepose * kDegree)};
    fill_cut(scene, [&](double x, double) { return x < kCollapseLength * cosine ? kCollapseHeight / cosine : 0.0; },
             {setup.per_side});
    if (!law) return scene;
    ErodibleBed bed;
    bed.depth = Raster::filled(scene.bed.geometry, kLayer / cosine);
    bed.density = scene.density, bed.law = *law, bed.momentum = kappa, bed.min_depth = kGrain;
    scene.erodible = bed;
    return scene;
}

/// From the gate to the last place where two grains lie on one another, along the slope [m].
double runout(double slope_deg, const Setup& setup, Measurement& m, const ErosionLaw* law = nullptr,
              double kappa = 0.0) {
    Trial trial(column(slope_deg, setup, law, kappa), setup);
    trial.run_to_rest(kLatest);
    const Frame frame = trial.simulation().frame();
    const double* depth = frame.node("depth")->data + frame.grid.ny / 2 * frame.grid.nx;
    const double cosine = std::cos(slope_deg * kDegree), least = 2.0 * kGrain / cosine;
    double front = 0.0;
    for (Index i = 0; i + 1 < frame.grid.nx; ++i)
        if (depth[i] >= least && depth[i + 1] < least)
            front = frame.grid.x(i) + frame.grid.cell * (depth[i] - least) / (depth[i] - depth[i + 1]);
    const Measurement one = trial.measure();
    m.particles = std::max(m.particles, one.particles), m.steps += one.steps, m.wall_seconds += one.wall_seconds;
    m.mass_error = std::max(std::isnan(m.mass_error) ? 0.0 : m.mass_error, one.mass_error);
    return front / cosine - kCollapseLength;
}

Measurement run_collapse(const Setup& setup) {
    const std::pair<std::string, ErosionLaw> laws[] = {{"growth", erosion::Growth{1.0}}, {"front", erosion::Front{}}};
    Measurement m;
    for (const int slope : {0, 10, 16, 19, 22}) {
        const std::string at = "_" + std::to_string(slope);
        const double rigid = runout(slope, setup, m);
        m.add("rigid" + at, rigid, "m");
        for (const auto& [name, law] : laws)
            for (const int kappa : {0, 1})
                m.add(fmt::format("{}{}{}", name, kappa, at), runout(slope, setup, m, &law, kappa) / rigid);
    }
    return m;
}

}  // namespace

std::vector<Problem> collapse_problems() {
    Problem collapse{
        "erodible_collapse",
        "a column of grains on slopes of 0 to 22 degrees: its runout over 5 mm of loose grains, kappa 0 and 1, "
        "over that on rock (after Mangeney et al. 2010)",
        {10, 20},
        {},
        run_collapse};
    collapse.order_of = "";
    collapse.has_presets = false;
    collapse.gates = {{0, "mass_error", 1e-13, "round-off"}};
    for (const char* law : {"growth0_", "front0_"})
        for (const int slope : {0, 10, 16, 19, 22})
            collapse.gates.push_back({20, law + std::to_string(slope), 1.0,
                                      "what is taken at rest shares the momentum: it cannot go farther"});
    collapse.gates.push_back({20, "growth1_22", 1.4, "published: up to 40 % farther near the angle of repose"});
    return {collapse};
}

}  // namespace frana::verify
