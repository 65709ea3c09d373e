#pragma once
// A step of water under friction of both kinds.
#include <cmath>

#include "law/friction_step.h"

namespace frana {

/// THEORY (13): one step of  ds/dt = drive - linear s - quadratic s^2  for a constant drive, exactly; as riccati_speed
/// without the linear term. `driven`: speed that the drive alone would give at the end [m/s].
inline double braked_speed(double s0, double driven, double linear, double quadratic, double dt) {
    if (linear == 0.0) return riccati_speed(s0, driven, 0.0, quadratic, dt);
    const double gain = driven - s0;
    const double ratio = tangent_ratio(0.25 * dt * dt * linear * linear + dt * quadratic * gain);
    if (!(ratio > 0.0)) return 0.0;
    const double half = 0.5 * linear * dt;
    return std::fmax(0.0, (s0 + ratio * (gain - half * s0)) / (1.0 + ratio * (half + dt * quadratic * s0)));
}

}  // namespace frana
