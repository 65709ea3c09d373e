#pragma once
// Scenes from formulas, for tests: those of the verification library, and short words for running them.
#include <cmath>

#include "checks/verify/trial.h"

namespace frana::test {

using verify::Function;
using verify::scene_on;

/// Adds per_side^2 points a cell on the lattice aligned with the grid, shifted by (shift_x, shift_y) cells.
inline void fill(Scene& scene, const Function& depth, int per_side = 2, double shift_x = 0.0, double shift_y = 0.0) {
    verify::fill(scene, depth, {per_side, shift_x, shift_y});
}

inline void run_to(Simulation& simulation, double end) {
    while (simulation.status().time < end) simulation.advance(end);
}

/// |V_end + V_left - V_0| / V_0 from the masses.
inline double mass_error(const Status& now, double initial) {
    return std::abs(now.mass + now.mass_left - initial) / initial;
}

}  // namespace frana::test
