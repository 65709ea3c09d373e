#pragma once
#include <cmath>

#include "base/constants.h"
#include "law/solid/elastic.h"

namespace frana::solid {

/// Where Drucker and Prager's cone meets Mohr and Coulomb's pyramid: in triaxial compression, or in plane
/// strain. In plane strain, flow without dilatancy makes the stress across the plane the mean of the others. Both laws
/// then agree.
enum class Cone { compression, plane_strain };

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
                 "or in plane strain, as heaps and slopes fail",
                 Missing::usual,
                 0.0,
                 "",
                 {"triaxial", "plane_strain"}},
                young_modulus(),
                poisson_ratio()};
    }
    static DruckerPrager of(const Values& value) {
        return of(Elastic::of(value), *value("friction_angle_deg") * constants::kDegree, *value("cohesion"),
                  *value("cone") > 0.0 ? Cone::plane_strain : Cone::compression);
    }
    static constexpr int kStates = 7;  ///< logarithmic elastic strain; volume gained at the apex, ln J [1]
    static constexpr bool kAverages = false;
    /// Volume over that without stress of points that have parted: twice as far apart in each direction. What flies
    /// apart further leaves room between points, which need not close before they carry pressure again.
    static constexpr double kLoosest = 8.0;
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
        const Square<Real> grown = grown_in<Real>(d);
        const SymOf<Real> trial = carried<Real>(SymOf<Real>::read(state), grown);
        j *= volume_ratio<Real>(grown);
        const double bulk = elastic.lambda + 2.0 / 3.0 * elastic.shear;
        const double apex = tension / bulk;  // the volume strain at which nothing is carried any more
        const Real volume = trial.trace() + state[6];
        const auto parted = volume >= apex;
        const SymOf<Real> shear_strain = trial.deviator();
        const Real size = 2.0 * elastic.shear * shear_strain.norm();
        const Real strength = alpha * bulk * (apex - volume);
        const Real yielding = strength / select(size > 0.0, size, Real{} + 1.0);
        const Real kept = select(parted, Real{}, select(size > strength, yielding, Real{} + 1.0));
        (shear_strain * kept).plus_isotropic(select(parted, Real{} + apex, volume) / 3.0).write(state);
        const Real gap = select(parted, volume - apex, Real{}), widest = Real{} + std::log(kLoosest);
        state[6] = min(gap, widest);
        j = min(j, Real{} + kLoosest);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return elastic.stored(j, state);
    }
    double sound_speed(double density) const { return elastic.sound_speed(density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
