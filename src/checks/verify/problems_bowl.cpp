// Water that swings in parabolic bowls: moving shorelines without friction. The exact answers are those of the
// shallow-water equations, so the terrain model is the shallow one.
#include <algorithm>
#include <cmath>

#include "checks/verify/exact_bowl.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kBowlSide = 4.0;
constexpr Index kStripNodes = 7;  ///< across a one-dimensional problem, between walls

Scene scene_of(const Bowl& bowl, const Setup& setup) {
    const bool strip = bowl.width < kBowlSide;
    const double cell = kBowlSide / static_cast<double>(setup.cells);
    Scene scene = scene_on(setup.cells + 1, strip ? kStripNodes : setup.cells + 1, cell, bowl.bed);
    scene.terrain = TerrainModel::shallow;
    if (strip) scene.sides = Sides::wall;
    fill(scene, [&](double x, double y) { return bowl.at(x, y, 0).depth; }, {setup.per_side});
    Seeds& seeds = scene.particles;
    for (Index p = 0; p < seeds.count(); ++p) {
        const BowlState w = bowl.at(seeds.x[p], seeds.y[p], 0);
        seeds.vx[p] = w.u;
        seeds.vy[p] = w.v;
    }
    return scene;
}

double energy_of(const Status& status) { return status.kinetic + status.potential; }

/// Largest difference between depths that a symmetry of the square carries into one another, over the largest depth.
/// The symmetries are mirrors of x and y, and the exchange of x and y.
struct Asymmetry {
    double mirror = 0.0, exchange = 0.0;
};
Asymmetry asymmetry(const Frame& frame) {
    const Index n = frame.grid.nx;
    const double* h = frame.node("depth")->data;
    Asymmetry worst;
    double largest = 0.0;
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            const double here = h[j * n + i];
            largest = std::max(largest, here);
            for (const double image : {h[j * n + (n - 1 - i)], h[(n - 1 - j) * n + i]})
                worst.mirror = std::max(worst.mirror, std::abs(here - image));
            worst.exchange = std::max(worst.exchange, std::abs(here - h[i * n + j]));
        }
    return {worst.mirror / largest, worst.exchange / largest};
}

/// `periods` of a swing; energy_drift = (E - E_0) / (E_0 - E_rest).
Measurement swing(const Bowl& bowl, const Setup& setup, int periods) {
    Trial trial(scene_of(bowl, setup), setup);
    const double start = energy_of(trial.simulation().frame().status), end = periods * bowl.period;
    trial.run_to(end);
    Exact exact{[&](double x, double y) { return std::max(0.0, bowl.at(x, y, end).depth); }};
    if (std::abs(bowl.at(1.0, 1.0, end).u) + std::abs(bowl.at(1.0, 1.0, end).v) > 1e-9) {  // else: at a turning point
        exact.u = [&](double x, double y) { return bowl.at(x, y, end).u; };
        exact.v = [&](double x, double y) { return bowl.at(x, y, end).v; };
    }
    Measurement m = trial.measure(exact);
    const Frame frame = trial.simulation().frame();
    const double width = bowl.width < kBowlSide ? (kStripNodes - 1) * frame.grid.cell : kBowlSide;
    const double swing_energy = trial.scene().density * bowl.swing * width / bowl.width;
    m.add("energy_drift", (energy_of(frame.status) - start) / swing_energy);
    m.add("centre_error", trial.point_mean([](double x, double) { return x; }) - bowl.centre_x(end), "m");
    if (bowl.round) {
        const Asymmetry worst = asymmetry(frame);
        m.add("mirror_error", worst.mirror);
        m.add("exchange_error", worst.exchange);
    }
    return m;
}

}  // namespace

std::vector<Problem> bowl_problems() {
    const Gate volume{0, "mass_error", 1e-13, "round-off"};
    Problem planar{"thacker_planar",
                   "a tilted plane of water turns in a bowl, 3 periods (Thacker 1981)",
                   {50, 100, 200},
                   [] { return residuals_of(planar_bowl()); },
                   [](const Setup& s) { return swing(planar_bowl(), s, 3); }};
    planar.gates = {{100, "l1_depth", 4e-3, "goal; an earlier code 2.4e-3"},
                    {100, "energy_drift", 1e-3, "goal; an earlier code -1e-4"},
                    volume};
    Problem period = planar;
    period.name = "thacker_period";
    period.title = "a tilted plane of water turns in a bowl, one period (Thacker 1981)";
    period.run = [](const Setup& s) { return swing(planar_bowl(), s, 1); };
    period.gates = {{100, "l1_depth", 5e-3, "goal; GeoClaw 2.6e-2 at 100"}, volume};
    Problem radial{"thacker_radial",
                   "a round mound of water falls and rises in a bowl, 3 periods (Thacker 1981)",
                   {50, 100, 200},
                   [] { return residuals_of(radial_bowl()); },
                   [](const Setup& s) { return swing(radial_bowl(), s, 3); }};
    radial.gates = {{100, "l1_depth", 5e-3, "goal; an earlier code 3.5e-3"},
                    {200, "l1_depth", 2e-3, "goal; an earlier code 1.3e-3"},
                    {100, "energy_drift", 2e-2, "goal; an earlier code -0.3 %"},
                    {200, "energy_drift", 2e-2, "goal; an earlier code -0.6 %"},
                    {0, "mirror_error", 1e-12, "the canon's radial symmetry: round-off"},
                    {0, "exchange_error", 1e-12, "the canon's radial symmetry: round-off"},
                    volume};
    Problem trough{"trough",
                   "water swings in a parabolic trough, 5 periods (Thacker 1981, in one dimension)",
                   {100, 200, 400},
                   [] { return residuals_of(parabolic_trough()); },
                   [](const Setup& s) { return swing(parabolic_trough(), s, 5); }};
    trough.gates = {{400, "l1_depth", 5e-3, "suggested by the canon at 401 nodes"}, volume};
    return {planar, period, radial, trough};
}

}  // namespace frana::verify
