#pragma once
// What is said to people of a key that varies.
#include <string>

#include "ensemble/plan.h"

namespace frana {

/// Its distribution, with the numbers that the plan gives: "triangular, 0.05 to 0.3, most likely 0.12".
std::string words_of(const Vary& vary);

}  // namespace frana
