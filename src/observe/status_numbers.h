#pragma once
// The one list of a status's numbers.
#include <vector>

#include "observe/frame.h"

namespace frana {

/// All of a status but its two counts. A state holds them in this order, and each has to be finite.
inline std::vector<double*> numbers_of(Status& s) {
    return {&s.time,
            &s.dt,
            &s.mass,
            &s.mass_left,
            &s.mass_in,
            &s.momentum[0],
            &s.momentum[1],
            &s.impulse[0],
            &s.impulse[1],
            &s.momentum_left[0],
            &s.momentum_left[1],
            &s.kinetic,
            &s.potential,
            &s.dissipated,
            &s.energy_left,
            &s.p2g_mass_error,
            &s.p2g_momentum_error,
            &s.max_depth,
            &s.max_speed,
            &s.max_speed_on_map,
            &s.mean_speed,
            &s.covered_area,
            &s.front,
            &s.stored,
            &s.in_3d.friction,
            &s.in_3d.walls,
            &s.in_3d.material,
            &s.in_3d.numerical,
            &s.in_3d.volume,
            &s.bed.initial,
            &s.bed.mass,
            &s.bed.eroded,
            &s.bed.deposited,
            &s.bed.energy,
            &s.bed.deepest,
            &s.water,
            &s.water_volume};
}

}  // namespace frana
