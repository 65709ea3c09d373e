#pragma once
// Bed laws as a case gives them: one struct of parameters each.
#include <variant>

namespace frana {

/// Bed laws: shear stress between the flow and its bed (law/bed_law.h has the formulas).
namespace bed {
struct None {};
struct Coulomb { double mu = 0.0; };                                 ///< mu = tan(friction angle) [1]
struct Voellmy { double mu = 0.0; double xi = 1000.0; };             ///< xi: turbulence coefficient [m/s^2]
struct Manning { double n = 0.03; double mu = 0.0; };                ///< n: Manning roughness [s/m^(1/3)]
struct Bingham { double viscosity = 0.0; double yield_stress = 0.0; double mu = 0.0; };  ///< [Pa s], [Pa], [1]
struct Pouliquen {                                                   ///< mu(I), depth-averaged
    double mu_s = 0.38;            ///< friction at I -> 0 [1]
    double mu_2 = 0.65;            ///< friction at I -> infinity [1]
    double i0 = 0.3;               ///< inertial number scale [1]
    double grain_diameter = 1e-3;  ///< [m]
    double solid_fraction = 0.6;   ///< [1]
};
}  // namespace bed
using BedLaw = std::variant<bed::None, bed::Coulomb, bed::Voellmy, bed::Manning, bed::Bingham, bed::Pouliquen>;

}  // namespace frana
