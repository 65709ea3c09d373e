#pragma once
// The laws of 3D material that there are. A new one has its header in this folder, included here, and its place in the list.
// A law is the stress of a point from its own numbers, and how these change with the deformation. It is a struct of
// parameters with
//
//   name, keys   its word in a case, and the keys of [[stage]] that it has
//
//   kStates      numbers that a point stores for it
//
//   kAverages    whether J is drawn to its mean over the neighbourhood, a cure for noisy pressure in fluids
//
//   stress()     Cauchy stress times J, tension positive [Pa]
//
//   update()     the same numbers after a step
//
//   stored()     energy that unloading gives back, per volume without stress [J/m^3]
//
//   sound_speed(), explicit_viscosity()   what bounds the step [m/s], [Pa s]
//
// stress(), update() and stored() are for one point (Real is double) or for four at once (Double4).
#include <string>
#include <variant>
#include <vector>

#include "law/solid/bingham.h"
#include "law/solid/drucker_prager.h"
#include "law/solid/elastic.h"
#include "law/solid/fluid.h"
#include "law/solid/herschel_bulkley.h"

namespace frana {

using SolidLaw =
    std::variant<solid::Fluid, solid::Bingham, solid::Elastic, solid::DruckerPrager, solid::HerschelBulkley>;

namespace solid {

/// Words of the laws, in the order of the list.
std::vector<std::string> words();
/// Words of those that have a key of [[stage]].
std::vector<std::string> words_with(const std::string& key);
/// All keys of laws, each once.
std::vector<std::string> all_keys();

}  // namespace solid
}  // namespace frana
