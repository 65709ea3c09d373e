#pragma once
// A stage of 3D points in a random case.
#include <string>

#include "checks/fuzz/draw.h"

namespace frana::fuzz {

/// The keys of a stage ("stage#0"), and of a barrier perhaps, for what the draft lets go. Its cell [m].
double draw_3d(Dice& dice, Draft& draft, const std::string& stage);

}  // namespace frana::fuzz
