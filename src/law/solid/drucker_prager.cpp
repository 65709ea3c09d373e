#include "law/solid/drucker_prager.h"

#include "base/error.h"

namespace frana::solid {
namespace {

/// |s| over the pressure. In triaxial compression Mohr and Coulomb's law reads q = p 6 sin(phi) / (3 - sin(phi)), and |s| =
/// sqrt(2/3) q. In plane strain half the difference of the principal stresses is sin(phi) times their mean, and |s| =
/// sqrt(2) times that half. In simple shear the shear stress is tan(phi) times the pressure, and |s| sqrt(2) times it.
double cone_slope(double friction_angle, Cone cone) {
    const double sine = std::sin(friction_angle);
    switch (cone) {
        case Cone::compression:
            return std::sqrt(2.0 / 3.0) * 6.0 * sine / (3.0 - sine);
        case Cone::plane_strain:
            return std::sqrt(2.0) * sine;
        case Cone::simple_shear:
            break;
    }
    return std::sqrt(2.0) * std::tan(friction_angle);
}

}  // namespace

DruckerPrager DruckerPrager::of(const Elastic& elastic, double friction_angle, double cohesion, Cone cone) {
    expect(friction_angle > 0.0 || cohesion == 0.0, "cohesion of this law needs friction: its cone has an apex");
    return {elastic, cone_slope(friction_angle, cone), cohesion > 0.0 ? cohesion / std::tan(friction_angle) : 0.0};
}

}  // namespace frana::solid
