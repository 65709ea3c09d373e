// Piles whose surface is nowhere as steep as friction can hold: they must not move by one bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "checks/verify/library.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kPileLength = 60.0, kPileMiddle = 30.0, kPileHeight = 4.0, kPileEnd = 10.0;

/// On a plane, fall line turned against the grid; a cone, or a paraboloid as steep at its edge.
struct Pile {
    double slope, flank, mu;  ///< of the bed; of the depth at the edge; tan(phi)
    double turn;              ///< [rad]
    bool cone;

    double bed(double x, double y) const {
        return 100 - slope * (std::cos(turn) * (x - kPileMiddle) + std::sin(turn) * (y - kPileMiddle));
    }
    double depth(double x, double y) const {
        const double r = std::hypot(x - kPileMiddle, y - kPileMiddle) * flank / kPileHeight;  // 1 at the edge
        return kPileHeight * (cone ? 1 - r : 0.5 * (1 - r * r));
    }
};

std::vector<Pile> piles() {
    std::vector<Pile> all;
    for (const auto& [slope, flank, mu] : {std::array{0.2, 0.3, 0.6}, std::array{0.7, 0.2, 1.1}})
        for (const double degrees : {0.0, 27.0, 45.0})
            for (const bool cone : {true, false})
                all.push_back({slope, flank, mu, degrees * constants::kPi / 180.0, cone});
    return all;
}

/// Drive over holding friction where the pile is steepest on the way down, both per unit mass and gravity. The
/// surface's slope is e = B + grad h, eased on steep ground by 1 + B.e, against mu cos(th) / kappa with kappa along e.
double drive_over_friction(const Pile& pile, bool steep) {
    const double e = pile.slope + pile.flank, b = pile.slope;  // all along the fall line
    if (!steep) return e / pile.mu;
    return e / (1 + b * e) / (pile.mu / (1 + b * b));  // cos(th) and kappa are those of the bed itself
}

std::vector<Residual> pile_residuals() {
    std::vector<Residual> all;
    for (const bool steep : {true, false})
        for (const Pile& pile : piles())
            if (pile.cone && pile.turn == 0.0)
                all.push_back({steep ? "drive / friction, steep form" : "drive / friction, shallow form",
                               drive_over_friction(pile, steep), 1.0});
    return all;
}

/// Largest distance of a point from where it started [cells]; infinite when there are other points than at the start.
double displacement(const Particles& before, const Particles& now) {
    if (before.count() != now.count()) return std::numeric_limits<double>::infinity();
    std::vector<Index> where(before.id.size());
    for (Index p = 0; p < before.count(); ++p) where[before.id[p]] = p;
    double worst = 0.0;
    for (Index p = 0; p < now.count(); ++p) {
        const Index q = where[now.id[p]];
        worst = std::max(worst, std::hypot(now.x[p] - before.x[q], now.y[p] - before.y[q]));
    }
    return worst;
}

Measurement run_piles(const Setup& setup) {
    Measurement m;
    double moved = 0.0, speed = 0.0;
    const double cell = kPileLength / static_cast<double>(setup.cells);
    for (const TerrainModel terrain : {TerrainModel::steep, TerrainModel::shallow})
        for (const Pile& pile : piles()) {
            const auto bed = [&](double x, double y) { return pile.bed(x, y); };
            Scene scene = scene_on(setup.cells + 1, setup.cells + 1, cell, bed);
            scene.terrain = terrain;
            scene.bed_law = bed::Coulomb{pile.mu};
            fill(scene, [&](double x, double y) { return pile.depth(x, y); }, {setup.per_side});
            Trial trial(std::move(scene), setup);
            const Particles before = trial.simulation().flow().particles;
            trial.run_to(kPileEnd, [&](const Status& now) { speed = std::max(speed, now.max_speed_on_map); });
            moved = std::max(moved, cell * displacement(before, trial.simulation().flow().particles));
            const double wall = m.wall_seconds;
            m = trial.measure();
            m.wall_seconds += wall;
        }
    m.add("displacement", moved, "m");
    m.add("max_speed", speed, "m/s");
    return m;
}

}  // namespace

std::vector<Problem> pile_problems() {
    Problem pile{"pile",
                 "cones and paraboloids below their friction angle on planes of 11 and 35 deg, 24 set-ups",
                 {60},
                 pile_residuals,
                 run_piles};
    pile.gates = {{0, "displacement", 0.0, "friction holds to the last bit"},
                  {0, "max_speed", 0.0, "friction holds to the last bit"},
                  {0, "mass_error", 0.0, "nothing moves"}};
    return {pile};
}

}  // namespace frana::verify
