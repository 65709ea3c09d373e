#pragma once
// What a 3D law is given of a step, and what of it several laws need. Numbers of equations: src/solid3d/THEORY.md.
#include "law/strain.h"

namespace frana {

/// A law's input of a step: L_kl = dv_k/dx_l at the point [1/s], and the step [s].
template <class Real>
struct DeformationOf {
    Square<Real> gradient;
    double dt;
};
using Deformation = DeformationOf<double>;

/// The stress-like state turned with the spin, W = (L - L^T) / 2: s + dt (W s - s W).
template <class Real>
[[gnu::always_inline]] inline SymOf<Real> spun(const SymOf<Real>& s, const DeformationOf<Real>& d) {
    const double half = 0.5 * d.dt;
    const Real xy = half * (d.gradient(0, 1) - d.gradient(1, 0)), yz = half * (d.gradient(1, 2) - d.gradient(2, 1)),
               xz = half * (d.gradient(0, 2) - d.gradient(2, 0));
    return s + SymOf<Real>{2.0 * (xy * s.xy + xz * s.xz),
                           2.0 * (yz * s.yz - xy * s.xy),
                           -2.0 * (xz * s.xz + yz * s.yz),
                           xy * (s.yy - s.xx) + xz * s.yz + yz * s.xz,
                           yz * (s.zz - s.yy) - xy * s.xz - xz * s.xy,
                           xz * (s.zz - s.xx) + xy * s.yz - yz * s.xy};
}

/// F - I of the step, F = I + dt L.
template <class Real>
[[gnu::always_inline]] inline Square<Real> grown_in(const DeformationOf<Real>& d) {
    Square<Real> grown;
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) grown(k, l) = d.dt * d.gradient(k, l);
    return grown;
}

}  // namespace frana
