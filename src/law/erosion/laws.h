#pragma once
// The erosion laws that there are. A new one has its header in this folder, included here, and its place in the list.
#include <variant>

#include "law/erosion/energy.h"
#include "law/erosion/front.h"
#include "law/erosion/growth.h"
#include "law/erosion/jump.h"
#include "law/erosion/mechanical.h"
#include "law/erosion/shear.h"
#include "law/erosion/steady.h"

namespace frana {

/// How fast a moving particle lowers the erodible bed below it, rate() [m/s]. Keys, words and descriptions are made
/// from this list, in its order, by laws::Catalogue.
using ErosionLaw = std::variant<erosion::Growth, erosion::Steady, erosion::Shear, erosion::Energy, erosion::Jump,
                                erosion::Front, erosion::Mechanical>;

}  // namespace frana
