#pragma once
#include <cmath>

#include "law/solid/deformation.h"
#include "law/solid/key.h"

namespace frana::solid {

/// src/solid3d/THEORY.md (20): Hencky's elastic solid, Kirchhoff stress linear in the logarithmic strain, tau = 2 G e +
/// lambda tr(e) I. Agrees with the linear theory for small strain, and stays objective for any rotation.
struct Elastic {
    static constexpr const char* name = "elastic";
    static std::vector<Key> keys() { return {young_modulus(), poisson_ratio()}; }
    static Elastic of(const Values& value) { return of(*value("young_modulus"), *value("poisson_ratio")); }
    static constexpr int kStates = 6;  ///< logarithmic strain [1]
    static constexpr bool kAverages = false;
    double lambda = 1.0, shear = 1.0;  ///< Lame's constants [Pa]

    static Elastic of(double young, double poisson) {
        return {young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson)};
    }
    /// Of the modulus lambda + 2 G [Pa]: density times the square of the speed of sound.
    static Elastic of_sound(double modulus, double poisson) {
        return of(modulus * (1.0 + poisson) * (1.0 - 2.0 * poisson) / (1.0 - poisson), poisson);
    }
    template <class Real>
    [[gnu::always_inline]] SymOf<Real> stress(Real, const Given<Real>* state, const Square<Real>&) const {
        const SymOf<Real> e = SymOf<Real>::read(state);
        return (e * (Real{} + 2.0 * shear)).plus_isotropic(lambda * e.trace());
    }
    template <class Real>
    [[gnu::always_inline]] void update(const DeformationOf<Real>& d, Real& j, Given<Real>* state) const {
        const Square<Real> grown = grown_in<Real>(d);
        carried<Real>(SymOf<Real>::read(state), grown).write(state);
        j *= volume_ratio<Real>(grown);
    }
    template <class Real>
    [[gnu::always_inline]] Real stored(Real, const Given<Real>* state) const {
        const SymOf<Real> e = SymOf<Real>::read(state);
        return shear * contracted(e, e) + 0.5 * lambda * e.trace() * e.trace();
    }
    double bulk() const { return lambda + 2.0 / 3.0 * shear; }  ///< K [Pa]
    double sound_speed(double density) const { return std::sqrt((lambda + 2.0 * shear) / density); }
    double explicit_viscosity() const { return 0.0; }
};

}  // namespace frana::solid
