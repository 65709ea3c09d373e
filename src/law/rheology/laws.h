#pragma once
// The rheologies that there are. A new one has its header in this folder, included here, and its place in the list.
#include <variant>

#include "law/rheology/bingham.h"
#include "law/rheology/newtonian.h"
#include "law/rheology/none.h"

namespace frana {

/// Stress inside the depth-averaged mass, from the strain rate of a point. Keys, words, kernels and descriptions are
/// made from this list, in its order.
using Rheology = std::variant<rheology::None, rheology::Newtonian, rheology::Bingham>;

}  // namespace frana
