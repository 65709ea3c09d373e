#pragma once
// What a run has gained or lost that no force and no open side accounts for.
#include <algorithm>
#include <array>
#include <cmath>

#include "observe/frame.h"

namespace frana {

/// Residuals of three balances between a first status and a later one of the same run (src/shallow/THEORY.md, 60 and
/// 61).
struct Budget {
    double mass_error = 0.0;  ///< (m + m_left + m_bed - m_0 - m_in) / (m_0 + m_in), m_0 with that of the bed [1]
    double bed_error = 0.0;   ///< of the bed alone, over what it had at the start and was given [1]
    std::array<double, 2> momentum_residual{};  ///< P + P_left - P_0 - impulse [kg m/s]
    double energy_residual = 0.0;               ///< (K + E_p + E_s + D + E_left - E_bed) - (the same at the start) [J]
};

inline Budget budget(const Status& first, const Status& now) {
    Budget result;
    const double came = now.mass_in - first.mass_in, had = first.mass + first.bed.mass + came;
    // What the bed had at the start grows with the part of the terrain that is held.
    const auto gained_by_bed = [](const Status& s) { return s.bed.mass - s.bed.initial; };
    const double lost = (now.mass - first.mass) + (now.mass_left - first.mass_left) +
                        (gained_by_bed(now) - gained_by_bed(first)) - came;
    result.mass_error = had > 0.0 ? lost / had : 0.0;
    const double of_bed = (now.bed.mass - now.bed.initial) + (now.bed.eroded - now.bed.deposited);
    const double bed_had = now.bed.initial + now.bed.deposited;
    if (bed_had > 0.0) result.bed_error = of_bed / bed_had;
    for (std::size_t axis = 0; axis < 2; ++axis)
        result.momentum_residual[axis] = (now.momentum[axis] - first.momentum[axis]) +
                                         (now.momentum_left[axis] - first.momentum_left[axis]) -
                                         (now.impulse[axis] - first.impulse[axis]);
    // Differences first: the potential energy of a mountain is far larger than what a flow turns over.
    result.energy_residual = (now.kinetic - first.kinetic) + (now.potential - first.potential) +
                             (now.stored - first.stored) + (now.dissipated - first.dissipated) +
                             (now.energy_left - first.energy_left) - (now.bed.energy - first.bed.energy);
    return result;
}

/// What came in after the start: by inflows, and of releases that entered later [kg]. What enters with the first frame
/// was there at the start, such as a release that is reached at once.
inline double mass_came_in(const Status& first, const Status& now) { return now.mass_in - first.mass_in; }

/// The largest values over a run, and when they were reached.
struct Extremes {
    double max_depth = 0.0, max_depth_time = 0.0;           ///< [m], [s]
    double max_speed = 0.0, max_speed_time = 0.0;           ///< [m/s], [s]
    double max_covered_area = 0.0;                          ///< covered at one time [m2]
    double max_front = 0.0;                                 ///< [m]
    double p2g_mass_error = 0.0, p2g_momentum_error = 0.0;  ///< worst step [1]

    void note(const Status& now) {
        if (now.max_depth > max_depth) max_depth = now.max_depth, max_depth_time = now.time;
        if (now.max_speed > max_speed) max_speed = now.max_speed, max_speed_time = now.time;
        max_covered_area = std::max(max_covered_area, now.covered_area);
        max_front = std::max(max_front, now.front);
        p2g_mass_error = std::max(p2g_mass_error, now.p2g_mass_error);
        p2g_momentum_error = std::max(p2g_momentum_error, now.p2g_momentum_error);
    }
};

}  // namespace frana
