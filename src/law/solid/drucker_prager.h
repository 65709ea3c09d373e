#pragma once
#include <cmath>

#include "base/constants.h"
#include "law/solid/cone.h"

namespace frana::solid {

/// Where Drucker and Prager's cone meets Mohr and Coulomb's pyramid: in triaxial compression, in plane strain, or on the
/// plane that a layer slides on. In plane strain, flow without dilatancy makes the stress across the plane the mean of the
/// others. Both laws then agree. But planes of shear then carry sin(phi) of their pressure, and heaps rest at less than phi.
/// In simple shear they carry tan(phi), and phi is the angle of repose.
enum class Cone { compression, plane_strain, simple_shear };

/// src/solid3d/THEORY.md (21), (22): sand, soil. It is elastic as above within the cone |s| = alpha (p + p_t) of Drucker
/// and Prager, in Kirchhoff stress, p_t = c cot(phi). Flow conserves the volume (no dilatancy). At the apex the material
/// parts: it carries the tension p_t and no more. The volume it gained has to be closed before it carries pressure again
/// (Tampubolon et al. 2017, sec. 4.3.4).
struct DruckerPrager {
    static constexpr const char* name = "drucker_prager";
    static std::vector<Key> keys() {
        return {{"friction_angle_deg", "degree", {0.0, 90.0, false, true}, "internal friction angle of drucker_prager"},
                {"cohesion", "Pa", ranges::not_negative, "cohesion of drucker_prager", Missing::usual, 0.0},
                {"cone",
                 "",
                 {},
                 "where drucker_prager is as strong as Mohr and Coulomb's law of that angle: in triaxial compression, "
                 "in plane strain, as slopes fail, or in simple_shear, so that the angle is that of repose",
                 Missing::usual,
                 0.0,
                 "",
                 {"triaxial", "plane_strain", "simple_shear"}},
                young_modulus(),
                poisson_ratio()};
    }
    static DruckerPrager of(const Values& value) {
        return of(Elastic::of(value), *value("friction_angle_deg") * constants::kDegree, *value("cohesion"),
                  static_cast<Cone>(static_cast<int>(*value("cone"))));
    }
    static constexpr int kStates = 7;  ///< logarithmic elastic strain; volume gained at the apex, ln J [1]
    static constexpr bool kAverages = false;
    Elastic elastic;
    double alpha = 0.0;    ///< |s| per pressure [1]
    double tension = 0.0;  ///< p_t, the pressure at the apex, negated [Pa]

    static DruckerPrager of(const Elastic& elastic, double friction_angle, double cohesion,
                            Cone cone = Cone::compression);
    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>& gradient) const {
        return elastic.stress(j, state, gradient);
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const double bulk = elastic.bulk();
        flow_in_cone<Real>(d, j, state, elastic, tension / bulk, [&](Real, Real room) { return alpha * bulk * room; });
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return elastic.stored(j, state);
    }
    double sound_speed(double density) const { return elastic.sound_speed(density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
