#pragma once
// A bed law at the nodes of a kernel, one or four at once. It has the step in which friction ends a motion,
// src/shallow/THEORY.md (48).
#include <type_traits>
#include <utility>

#include "law/bed/none.h"
#include "law/friction_step.h"

namespace frana {

/// Whether a law's formula takes four nodes at once.
template <class Law, class = void>
inline constexpr bool kTakesFour = false;
template <class Law>
inline constexpr bool kTakesFour<Law, std::void_t<decltype(std::declval<const Law&>().speed_after(
                                          BedStateOf<Double4>{}, Double4{}, Double4{}, 0.0))>> = true;

/// The speeds that a law leaves of `driven` after a step from `s0`. They are of four nodes at once by any law, or of
/// one.
template <class Law>
[[gnu::always_inline]] inline Double4 speeds_after(const Law& law, const BedStateOf<Double4>& bed, Double4 s0,
                                                   Double4 driven, double dt) {
    if constexpr (kTakesFour<Law>) {
        return law.speed_after(bed, s0, driven, dt);
    } else {
        Double4 speed = {};
        for (int n = 0; n < 4; ++n)
            speed[n] = law.speed_after(BedState{bed.normal_gravity[n], bed.thickness[n], bed.kappa[n], bed.cosine[n],
                                                bed.gravity, bed.density},
                                       s0[n], driven[n], dt);
        return speed;
    }
}
template <class Law>
inline double speeds_after(const Law& law, const BedState& bed, double s0, double driven, double dt) {
    return law.speed_after(bed, s0, driven, dt);
}

/// A grid update that friction braked, and the drift that follows it.
template <class Real>
struct BrakedOf {
    Real before;                ///< speed before the grid update, along the driven direction [m/s]
    Real driven;                ///< speed that the grid update would give without friction [m/s]
    Real speed;                 ///< that friction left [m/s]
    double velocity_dt, drift;  ///< [s]; no drift: nothing to correct
};

/// The speed. If friction ends the motion in the coming drift, and holds, it is the mean speed over the drift. The
/// speed in the drift's middle, where the leapfrog stands, would leave the stop short by up to brake drift^2 / 8.
template <class Real, class Law>
[[gnu::always_inline]] inline Real mean_if_stopping(const Law& law, const BedStateOf<Real>& state,
                                                    const BrakedOf<Real>& b) {
    if constexpr (std::is_same_v<Law, bed::None>) return b.speed;
    if (b.drift <= 0.0) return b.speed;
    const Real friction = law.friction_at_rest() * state.normal_gravity, drive = (b.driven - b.before) / b.velocity_dt,
               brake = friction - drive;
    // The speed at the start of the drift, half of which the grid update has covered.
    const Real at_start = b.before + brake * (0.5 * b.drift - b.velocity_dt);
    // A turning point is no stop.
    const auto stops = (b.before > 0.0) & (friction > abs(drive)) & (at_start < brake * b.drift);
    if (!any(stops)) return b.speed;
    const Real mean = select(at_start > 0.0, 0.5 * at_start * at_start / (abs(brake) * b.drift + 1e-300), Real{});
    return select(stops, mean, b.speed);
}

}  // namespace frana
