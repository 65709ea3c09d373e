#pragma once
// Rheologies as a case gives them: one struct of parameters each.
#include <variant>

namespace frana {

/// Rheologies: stress inside the depth-averaged mass (law/rheology.h has the formulas).
namespace rheology {
struct None {};
struct Newtonian { double viscosity = 0.0; };                            ///< [Pa s]
struct Bingham { double viscosity = 0.0; double yield_stress = 0.0; };   ///< [Pa s], [Pa]
}  // namespace rheology
using Rheology = std::variant<rheology::None, rheology::Newtonian, rheology::Bingham>;

}  // namespace frana
