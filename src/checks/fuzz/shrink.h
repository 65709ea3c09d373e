#pragma once
// From a case that fails to a smaller one that fails alike.
#include <functional>

#include "checks/fuzz/trial.h"

namespace frana::fuzz {

/// The smallest draft found whose verdict still breaks the same invariant as `draft`, and that verdict. Tries fewer
/// steps, a smaller grid, less and plainer material, plainer ground, and keys at their defaults. Repeats that until
/// nothing helps or `budget` trials are spent. `judge` runs a draft.
struct Shrunk {
    Draft draft;
    Verdict verdict;
    Index trials = 0;
};
Shrunk shrink(const Draft& draft, const std::function<Verdict(const Draft&)>& judge, Index budget = 300);

}  // namespace frana::fuzz
