#pragma once
// Energy that no force gave, and what it is measured by.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "observe/budget.h"

namespace frana {

/// What a run turned over since its first status, or could have [J]. Friction took a part, and a part moves. What left
/// is taken to have moved as what is there. Of a lake a hundredth of m g h counts. It was chosen, not derived. A surface
/// that is off by e (rms) has m g e^2 / (2 h) more energy than a level one. So a warning at 5 % of the stake means that a
/// lake's surface is off by 3 % of its depth.
inline double energy_at_stake(const Status& first, const Status& now) {
    constexpr double kOfLake = 0.01;
    const double depth = std::max(first.max_depth, now.max_depth),
                 gone = std::max(0.0, now.mass_left - first.mass_left),
                 of_gone = now.mass > 0.0 ? gone * (now.kinetic / now.mass) : 0.0;
    return std::max(0.0, now.dissipated - first.dissipated) + now.kinetic + of_gone +
           kOfLake * std::max(first.mass, now.mass) * constants::kGravity * depth;
}

/// Energy that no force gave, over energy_at_stake() [1]. 0 where energy is missing, as it is behind shocks.
inline double share_made(const Status& first, const Status& now) {
    constexpr double kRoundOff = 1e-12;  // of a mountain's potential energy, next to which a lake hardly moves
    const double whole = std::abs(first.potential) + std::abs(now.potential) + std::abs(now.energy_left);
    const double made = budget(first, now).energy_residual - kRoundOff * whole, stake = energy_at_stake(first, now);
    return made > 0.0 && stake > 0.0 ? made / stake : 0.0;
}

}  // namespace frana
