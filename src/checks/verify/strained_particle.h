#pragma once
// A structured particle that is strained by itself, without a grid, and closed forms of its stress. Tests use it too.
#include "structured/structured_flow.h"

namespace frana::verify {

/// A clay of 5 MPa that no strain breaks; angles in degrees.
StructuredMaterial unbroken_clay(double friction_deg, StructuredYield yield = StructuredYield::compression,
                                 double dilatancy_deg = 0.0);

/// Steps with the same strain and turn each, under the weight zz [Pa] and with a cohesion [Pa].
StructuredState strained(const StructuredLaw& law, int steps, const StructuredStep& each, double weight,
                         double cohesion, StructuredState state = {});

/// Strains by `total` along x with yy free: finds each step's yy strain at which sigma_yy stays as it is.
StructuredState squeezed_alone(const StructuredLaw& law, double total, double weight, double cohesion);

/// Simple shear by gamma in so many steps. Jaumann's rate makes it G sin(gamma) and, across, G (1 - cos(gamma)), of
/// opposite signs (Dienes 1979, Acta Mech. 32, 217). Differences from that over G.
struct ShearError {
    double shear, along, across;
    double size() const;
};
ShearError jaumann_shear_error(double gamma, int steps);

/// What an unconfined particle bears [Pa]. Mohr and Coulomb's pyramid and the cone of triaxial compression have 2 c
/// cos(phi) / (1 - sin(phi)). The cone of plane strain has k / (1 / sqrt(3) - alpha).
double unconfined_strength(const StructuredLaw& law, double cohesion);
/// The same as squeezing by a tenth finds it.
double squeezed_strength(const StructuredLaw& law, double cohesion);

}  // namespace frana::verify
