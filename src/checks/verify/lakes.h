#pragma once
// Lakes: a bed and a level.
#include "checks/verify/placement.h"
#include "checks/verify/trial.h"

namespace frana::verify {

struct Lake {
    Function bed;          ///< [m]
    double level, length;  ///< [m]
    bool strip = false;    ///< one-dimensional: seven nodes across
};

// Fois et al. 2024, section 4.1: a smooth bump and a step, under 10 m of water. Also an island higher than the water.
Lake lake_z1();
Lake lake_z2();
Lake lake_island();
/// The bump of Goutal and Maurel (1997), 0.2 m high in 0.1 m of water. Flow over it, the rest of that test, needs an
/// inflow, which frana does not have.
Lake lake_bump();

/// Between walls, masses fitted to the level; the time stepping does not use it but in the paper preset.
Scene scene_of(const Lake& lake, const Setup& setup, Placement placement);

}  // namespace frana::verify
