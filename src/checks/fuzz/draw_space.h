#pragma once
// A stage of points in space in a random case.
#include <string>

#include "checks/fuzz/draw.h"

namespace frana::stress {

/// The keys of a stage ("stage#0"), and of a barrier perhaps, for what the draft lets go. Its cell [m].
double draw_space(Dice& dice, Draft& draft, const std::string& stage);

}  // namespace frana::stress
