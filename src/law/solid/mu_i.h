#pragma once
#include <cmath>

#include "law/solid/cone.h"

namespace frana::solid {

/// src/solid3d/THEORY.md (23), (24): dry grains, elastic within a cone that widens with the rate of shear. Its size is
/// |s| / sqrt(2) = mu(I) p (Jop, Forterre and Pouliquen 2006, Nature 441, 727). Flow conserves the volume. At p = 0 the
/// material parts.
struct MuI {
    static constexpr const char* name = "mu_i";
    static std::vector<Key> keys() {
        const char* const of_bed = "that of material.bed with pouliquen";
        return {{"mu_s", "1", ranges::above_to(0.0, 10.0), "friction of the slowest flow, of mu_i", Missing::none, 0.0,
                 of_bed},
                {"mu_2", "1", ranges::above_to(0.0, 10.0), "friction of the fastest flow, of mu_i", Missing::none, 0.0,
                 of_bed},
                {"i0", "1", ranges::positive, "inertial number between slow and fast, of mu_i", Missing::none, 0.0,
                 "that of material.bed with pouliquen, else 0.3"},
                {"grain_diameter", "m", ranges::positive, "diameter of the grains of mu_i", Missing::none, 0.0, of_bed},
                {"solid_fraction",
                 "1",
                 {0.0, 1.0, true, true},
                 "share of the volume that is grains, of mu_i",
                 Missing::none,
                 0.0,
                 "that of material.bed with pouliquen, else 0.6"},
                young_modulus(),
                poisson_ratio()};
    }
    static MuI of(const Values& value) {
        MuI law = grains(value);
        law.elastic = Elastic::of(value);
        return law;
    }
    /// Without its stiffness.
    static MuI grains(const Values& value) {
        MuI law;
        law.mu_s = value("mu_s").value_or(law.mu_s), law.mu_2 = value("mu_2").value_or(law.mu_2);
        law.i0 = value("i0").value_or(law.i0);
        law.grain_diameter = value("grain_diameter").value_or(law.grain_diameter);
        law.solid_fraction = value("solid_fraction").value_or(law.solid_fraction);
        return law;
    }
    static constexpr int kStates = 7;  ///< logarithmic elastic strain; volume gained at the apex, ln J [1]
    static constexpr bool kAverages = false;
    Elastic elastic;
    double mu_s = 0.38, mu_2 = 0.65;  ///< friction at I -> 0 and I -> infinity [1]
    double i0 = 0.3;                  ///< inertial number scale [1]
    double grain_diameter = 1e-3;     ///< [m]
    double solid_fraction = 0.6;      ///< [1]
    double density = 1600.0;          ///< of the material, pores included [kg/m^3]

    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real j, const Given<Real>* state, const Square<Real>& gradient) const {
        return elastic.stress(j, state, gradient);
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const double bulk = elastic.bulk();
        flow_in_cone<Real>(d, j, state, elastic, 0.0,
                           [&](Real size, Real room) { return left_of<Real>(size, bulk * max(room, Real{}), d.dt); });
    }
    /// |s| after flow of dt under the pressure p, from the trial's |s| = size [Pa]. The rate of flow is that of the end.
    template <class Real>
    [[gnu::always_inline]] Real left_of(const Given<Real>& size, const Given<Real>& p, double dt) const {
        const double rooted = std::sqrt(2.0);
        // I sqrt(p) of a stress that flow takes away, 1 Pa of |s|
        const double brisk = grain_diameter * std::sqrt(density / solid_fraction) / (rooted * elastic.shear * dt);
        const Real scale = i0 * frana::sqrt(p), over = max(size - rooted * mu_s * p, Real{});
        const Real b = scale + (rooted * (mu_2 - mu_s) * p - over) * brisk;
        const Real root = frana::sqrt(b * b + 4.0 * brisk * scale * over);
        const auto slow = b > 0.0;  // both are the positive root of a quadratic; neither takes near numbers' difference
        const Real taken = select(slow, 2.0 * over * scale, root - b) / select(slow, b + root, Real{} + 2.0 * brisk);
        return size - taken;
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real j, const Given<Real>* state) const {
        return elastic.stored(j, state);
    }
    double sound_speed(double rho) const { return elastic.sound_speed(rho); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
