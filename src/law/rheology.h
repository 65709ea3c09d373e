#pragma once
// Stress inside the depth-averaged mass, from the strain rate of a point. Pressure is not part of it.
#include <cmath>

#include "law/bed_law.h"
#include "scene/scene.h"

namespace frana {

/// Symmetric plane tensor: stress [Pa] or strain rate [1/s].
struct Plane { double xx = 0.0, yy = 0.0, xy = 0.0; };

/// What a rheology sees of a point.
struct StrainState {
    Plane rate;       ///< sym grad v [1/s]
    double speed;     ///< [m/s]
    double depth;     ///< > 0 [m]
    double floor;     ///< regularisation of the yield stress [1/s]
    double cap;       ///< largest 2 mu_eff that is stable explicitly [Pa s]
};

inline Plane scaled(const Plane& rate, double factor) { return {factor * rate.xx, factor * rate.yy, factor * rate.xy}; }

/// sigma = 2 mu eps
inline Plane stress(const rheology::Newtonian& law, const StrainState& s) {
    return scaled(s.rate, std::min(2.0 * law.viscosity, s.cap));
}

/// sigma = (2 mu + tau_Y / sqrt(I2 + floor^2)) eps (Fois et al. 2024, eq. 3, corrected). I2 holds the plane strain
/// rate, its incompressible vertical part, and the vertical shear 3/(2 + zeta) |v|/h of a Bingham sheet (eq. 4).
inline Plane stress(const rheology::Bingham& law, const StrainState& s) {
    if (law.yield_stress <= 0.0) return scaled(s.rate, std::min(2.0 * law.viscosity, s.cap));
    const double zeta = bingham_sheet(0.0, 6.0 * law.viscosity * s.speed / (law.yield_stress * s.depth)).plug;
    const double shear = 3.0 / (2.0 + zeta) * s.speed / s.depth;
    const double zz = s.rate.xx + s.rate.yy;
    const double i2 = 0.5 * (s.rate.xx * s.rate.xx + s.rate.yy * s.rate.yy + zz * zz) + s.rate.xy * s.rate.xy +
                      0.25 * shear * shear;
    return scaled(s.rate, std::min(2.0 * law.viscosity + law.yield_stress / std::sqrt(i2 + s.floor * s.floor), s.cap));
}

}  // namespace frana
