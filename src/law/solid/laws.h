#pragma once
// The laws of 3D material that there are. A new one has its header in this folder, included here, and its place in the list.
// A law is the stress of a point from its own numbers, and how these change with the deformation. It is a struct of
// parameters with
//
//   name         its word in a case
//
//   keys()       the keys of [[stage]] that it has, with unit, range, meaning, and the meaning of its absence (key.h)
//
//   of()         the law that has these values of its keys
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
#include "law/solid/mu_i.h"

namespace frana {

using SolidLaw = std::variant<solid::Fluid, solid::Bingham, solid::Elastic, solid::DruckerPrager,
                              solid::HerschelBulkley, solid::MuI>;

namespace solid {

/// Sand and grains, which part where nothing presses them together.
bool is_granular(const SolidLaw& law);
/// Words of the laws, in the order of the list.
std::vector<std::string> words();
/// A key as all laws of the list have it.
struct SharedKey {
    Key key;
    std::vector<std::string> used_by, needed_by;  ///< words of the laws
};
/// In the order in which the laws name them.
std::vector<SharedKey> shared_keys();
/// Whether the law of that word has a key.
bool has_key(const std::string& word, const std::string& key);
/// The law of that word. Its bulk modulus is still to be set where its keys do not give one.
SolidLaw make(const std::string& word, const Values& value);

}  // namespace solid
}  // namespace frana
