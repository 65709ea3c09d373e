#pragma once
// The bed laws that there are. A new one has its header in this folder, included here, and its place in the list.
#include <variant>

#include "law/bed/bingham.h"
#include "law/bed/coulomb.h"
#include "law/bed/manning.h"
#include "law/bed/none.h"
#include "law/bed/pouliquen.h"
#include "law/bed/voellmy.h"

namespace frana {

/// Shear stress between the flow and its bed. Keys, words, kernels and descriptions are made from this list, in its order.
/// A law only ever slows a node down. It may stop it but never turns it round. A node at rest stays at rest to the last
/// bit until driven hard enough.
using BedLaw = std::variant<bed::None, bed::Coulomb, bed::Voellmy, bed::Manning, bed::Bingham, bed::Pouliquen>;

/// Coulomb's part of a law: its friction coefficient at rest [1].
inline double friction_at_rest(const BedLaw& law) {
    return std::visit([](const auto& chosen) { return chosen.friction_at_rest(); }, law);
}

/// Whether a law is more than a coefficient.
inline bool hangs_on_speed(const BedLaw& law) {
    return !std::holds_alternative<bed::None>(law) && !std::holds_alternative<bed::Coulomb>(law);
}

}  // namespace frana
