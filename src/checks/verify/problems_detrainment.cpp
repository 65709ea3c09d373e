// A slab that a forest takes mass out of.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_detrainment.h"
#include "checks/verify/library.h"
#include "checks/verify/slab_middle.h"
#include "observe/budget.h"

namespace frana::verify {
namespace {

/// So long that what its middle comes over has had the slab on it from the start. The ground there rises evenly, and a
/// plane stays one.
Measurement run_slab(const Setup& setup) {
    constexpr double kSlopeDeg = 30.0, kEnd = 20.0, kLength = 850.0, kRoom = 200.0;
    const DetrainedSlab slab;
    const SlabState exact = slab.at(kEnd);
    const double slope = kSlopeDeg * constants::kPi / 180.0, cosine = std::cos(slope),
                 cell = 100.0 / static_cast<double>(setup.cells);
    const Index nx = static_cast<Index>(std::ceil((kLength + exact.way * cosine + 2.0 * kRoom) / cell)) + 1;
    Scene scene = scene_on(
        nx, 7, cell, [&](double x, double) { return -std::tan(slope) * x; }, -kRoom);
    scene.sides = Sides::wall;
    scene.density = slab.density;
    scene.bed_law = bed::Coulomb{std::tan(slope) - slab.acceleration / (scene.gravity * cosine)};
    fill(scene, [&](double x, double) { return x > 0.0 && x < kLength ? slab.thickness / cosine : 0.0; },
         {setup.per_side});
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), slab.speed * cosine);
    scene.forest = Forest{Raster::filled(scene.bed.geometry, slab.pressure), {}};
    Trial trial(std::move(scene), setup);
    const Status first = trial.simulation().status();
    trial.run_to(kEnd);
    const SlabState found = middle_of(trial, 0.5 * kLength, cosine);
    const Status& now = trial.simulation().status();
    Measurement m = trial.measure();
    m.add("thickness_error", found.thickness / exact.thickness - 1.0);
    m.add("speed_error", found.speed / exact.speed - 1.0);
    m.add("travel_error", found.way / exact.way - 1.0);
    m.add("balance_error", budget(first, now).mass_error);
    return m;
}

}  // namespace

std::vector<Problem> detrainment_problems() {
    Problem slab{"detrainment",
                 "a slab slows down among trees that take K/u of it (Feistl et al. 2014)",
                 {10, 20, 40},
                 detrained_slab_residuals,
                 run_slab};
    slab.order_of = "thickness_error";
    slab.gates = {{10, "thickness_error", 8e-6, "second order in the step: (a dt/u)^2/24 of what is taken"},
                  {40, "thickness_error", 8e-7, "likewise"},
                  {0, "speed_error", 1e-6, "what is left is not slowed"},
                  {0, "travel_error", 1e-6, "likewise"},
                  {0, "balance_error", 1e-13, "round-off"}};
    return {slab};
}

}  // namespace frana::verify
