#pragma once
// The step in which bed friction ends a motion: src/shallow/THEORY.md (48).
#include "law/bed_law.h"

namespace frana {

/// Friction coefficient of a bed at rest [1].
inline double sliding_friction(const bed::None&) { return 0.0; }
inline double sliding_friction(const bed::Pouliquen& law) { return law.mu_s; }
template <class Law>
inline double sliding_friction(const Law& law) { return law.mu; }

/// A kick that friction braked, and the drift that follows it.
template <class Real>
struct BrakedOf {
    Real before;   ///< speed before the kick, along the driven direction [m/s]
    Real driven;   ///< speed that the kick would give without friction [m/s]
    Real speed;    ///< that friction left [m/s]
    double kick, drift;  ///< [s]; no drift: nothing to correct
};

/// The speed, or the mean speed over the coming drift if friction ends the motion in it, and holds: the speed in the
/// drift's middle, where the leapfrog stands, would leave the stop short by up to brake drift^2 / 8.
template <class Real, class Law>
[[gnu::always_inline]] inline Real mean_if_stopping(const Law& law, const BedStateOf<Real>& state, const BrakedOf<Real>& b) {
    if constexpr (std::is_same_v<Law, bed::None>) return b.speed;
    if (b.drift <= 0.0) return b.speed;
    const Real friction = sliding_friction(law) * state.normal_gravity, pull = (b.driven - b.before) / b.kick,
               brake = friction - pull;
    const Real at_start = b.before + brake * (0.5 * b.drift - b.kick);  // of the drift, half of which the kick has covered
    // A turning point is no stop.
    const auto stops = (b.before > 0.0) & (friction > abs(pull)) & (at_start < brake * b.drift);
    if (!any(stops)) return b.speed;
    const Real mean = select(at_start > 0.0, 0.5 * at_start * at_start / (abs(brake) * b.drift + 1e-300), Real{});
    return select(stops, mean, b.speed);
}

}  // namespace frana
