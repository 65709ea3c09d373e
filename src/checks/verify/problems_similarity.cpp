// The similarity pile on steep terrain, in map coordinates, at four angles to the grid.
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/constants.h"
#include "checks/verify/exact_similarity.h"
#include "checks/verify/library.h"
#include "checks/verify/reference_steep_pile.h"
#include "checks/verify/trial.h"

namespace frana::verify {
namespace {

constexpr double kSimilaritySlope = 35 * constants::kPi / 180.0, kSimilarityEnd = 5.0;
constexpr double kSimilarityReach = 240.0;  ///< the reference length: so many metres have Setup::cells cells

const SimilarityPile kPile(35, 25, 80, 4);

/// Fields of the pile on the map when it slides in direction `turn` [rad]: X = x / cos, h = h_n / cos, u = U cos.
Exact on_map(double turn, double t) {
    const SimilarityPile::Shape shape = kPile.shape(t);
    const double c = std::cos(turn), s = std::sin(turn), cosine = std::cos(kSimilaritySlope);
    const auto at = [=](double x, double y) { return kPile.at(shape, (c * x + s * y) / cosine, c * y - s * x); };
    return {[=](double x, double y) { return at(x, y).depth / cosine; },
            [=](double x, double y) { return c * cosine * at(x, y).u - s * at(x, y).v; },
            [=](double x, double y) { return s * cosine * at(x, y).u + c * at(x, y).v; }};
}

/// The same, sliding along x, by the steep equations themselves; a map of degree 5 is exact to 1e-5.
Exact steep_on_map(double t) {
    const double cosine = std::cos(kSimilaritySlope);
    const SteepPile::Plane plane{
        std::tan(kSimilaritySlope), std::tan(25 * constants::kPi / 180.0), 4.0 / cosine, 80.0 * cosine, 80.0, 9.81};
    const auto pile = std::make_shared<const SteepPile>(plane, SteepPile::Form::steep, 5, t);
    return {[pile](double x, double y) { return pile->at(x, y).depth; },
            [pile](double x, double y) { return pile->at(x, y).u; },
            [pile](double x, double y) { return pile->at(x, y).v; }};
}

/// The window holds the pile at the start and at the end, whatever the angle. The pile starts around (0, 0).
Trial turned_trial(const Setup& setup, double turn, TerrainModel terrain) {
    const double cell = kSimilarityReach / static_cast<double>(setup.cells), c = std::cos(turn), s = std::sin(turn);
    const double low = -std::ceil(96 / cell) * cell;
    const Index nx = static_cast<Index>(std::ceil((120 - low) / cell)) + 1;
    const auto bed = [&](double x, double y) { return -std::tan(kSimilaritySlope) * (c * x + s * y); };
    Scene scene = scene_on(nx, nx, cell, bed, low, low);
    scene.terrain = terrain;
    scene.bed_law = bed::Coulomb{std::tan(25 * constants::kPi / 180.0)};
    fill_cut(scene, on_map(turn, 0.0).depth, {setup.per_side});
    Trial trial(std::move(scene), setup);
    trial.run_to(kSimilarityEnd);
    return trial;
}

Measurement measured(Trial& trial, double turn) {
    Measurement m = trial.measure(on_map(turn, kSimilarityEnd));
    const double c = std::cos(turn), s = std::sin(turn);
    const double along = trial.point_mean([&](double x, double y) { return c * x + s * y; });
    m.add("centre_error", along - kPile.centre(kSimilarityEnd) * std::cos(kSimilaritySlope), "m");
    return m;
}

Measurement run_similarity(const Setup& setup) {
    Trial steep = turned_trial(setup, 0.0, TerrainModel::steep);
    Measurement m = measured(steep, 0.0);
    double least = m.l2_depth, most = m.l2_depth;
    for (const double degrees : {15.0, 27.0, 45.0}) {
        const double turn = degrees * constants::kPi / 180.0;
        Trial turned = turned_trial(setup, turn, TerrainModel::steep);
        const double error = measured(turned, turn).l2_depth;
        least = std::min(least, error);
        most = std::max(most, error);
    }
    m.add("rotation_spread", most - least);
    // Against its own equations: what is the scheme's own error.
    const Measurement full = steep.measure(steep_on_map(kSimilarityEnd));
    m.add("full_l2_depth", full.l2_depth);
    m.add("full_l2_momentum", full.l2_momentum);
    // The theory's own linearisation in the depth gradient; that of its friction's direction stays.
    Trial other = turned_trial(setup, 0.0, TerrainModel::linearised);
    const Measurement linear = measured(other, 0.0);
    m.add("linear_l2_depth", linear.l2_depth);
    m.add("linear_l2_momentum", linear.l2_momentum);
    return m;
}

}  // namespace

std::vector<Problem> similarity_problems() {
    Problem pile{"similarity",
                 "pile sliding and spreading on 35 degrees, friction 25 degrees (Hutter et al. 1993)",
                 {40, 80, 160},
                 [] { return joined(SimilarityPile::residuals(), steep_pile_residuals()); },
                 run_similarity};
    pile.order_of = "l2_depth";
    pile.gates = {{80, "l2_depth", 8e-3, "goal; AvaFrame 8.4e-3 with 27k points, an earlier code 7.6e-3"},
                  {80, "rotation_spread", 2e-4, "goal; an earlier code 1e-4"},
                  {80, "l2_momentum", 1.2e-2, "AvaFrame 1.18e-2 with 27k points, an earlier code 1.2e-2"},
                  {160, "full_l2_depth", 6.4e-3, "the theory's own distance from the steep equations"},
                  {0, "mass_error", 1e-13, "round-off"}};
    return {pile};
}

}  // namespace frana::verify
