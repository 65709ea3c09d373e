#pragma once
// A point's state for a rheology, and the resulting stress. Pressure is not part of it. Numbers of equations:
// src/shallow/THEORY.md, section 7.
#include "base/simd.h"

namespace frana {

/// Symmetric plane tensor: stress [Pa] or strain rate [1/s]. Real: double, or Double4 for four points at once.
template <class Real>
struct PlaneOf {
    Real xx{}, yy{}, xy{};
};
using Plane = PlaneOf<double>;

/// A point's state for a rheology.
template <class Real>
struct StrainState {
    PlaneOf<Real> rate;  ///< sym grad v [1/s]
    Real shear;          ///< speed along the bed over thickness across it, V / T [1/s]
    double floor;        ///< regularisation of the yield stress [1/s]
    double cap;          ///< largest 2 mu_eff that is stable explicitly [Pa s]
};

template <class Real>
[[gnu::always_inline]] inline PlaneOf<Real> scaled(const PlaneOf<Real>& rate, Real factor) {
    return {factor * rate.xx, factor * rate.yy, factor * rate.xy};
}

/// Newton's stress: sigma = 2 mu eps, as far as that is stable. Number: double, or Double4 for four points that differ.
template <class Number, class Real>
[[gnu::always_inline]] inline PlaneOf<Real> viscous_stress(Number viscosity, const StrainState<Real>& s) {
    return scaled(s.rate, Real{} + min(2.0 * viscosity, Number{} + s.cap));
}

}  // namespace frana
