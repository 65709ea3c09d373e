#include "law/solid/drucker_prager.h"

#include "base/error.h"

namespace frana::solid {

/// In triaxial compression Mohr and Coulomb's law reads q = p 6 sin(phi) / (3 - sin(phi)), and |s| =
/// sqrt(2/3) q. In plane strain half the difference of the principal stresses is sin(phi) times their mean, and |s| =
/// sqrt(2) times that half.
DruckerPrager DruckerPrager::of(const Elastic& elastic, double friction_angle, double cohesion, Cone cone) {
    expect(friction_angle > 0.0 || cohesion == 0.0, "cohesion of this law needs friction: its cone has an apex");
    const double sine = std::sin(friction_angle);
    const double alpha =
        cone == Cone::compression ? std::sqrt(2.0 / 3.0) * 6.0 * sine / (3.0 - sine) : std::sqrt(2.0) * sine;
    return {elastic, alpha, cohesion > 0.0 ? cohesion / std::tan(friction_angle) : 0.0};
}

}  // namespace frana::solid
