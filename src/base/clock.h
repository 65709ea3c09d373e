#pragma once
// The clock of every flow: where it is in time, and how its steps meet given times.
#include <algorithm>

#include "base/types.h"

namespace frana {

/// A step of at most `longest` towards a time that is `left` away, both [s]. The time is hit exactly. The steps before
/// it are not shorter than half of `longest`: a crumb would cost as much as any step.
inline double step_towards(double left, double longest) {
    if (left <= longest) return left;
    return left < 2.0 * longest ? 0.5 * left : longest;
}

/// Steps since the start. The status of each model begins with it.
struct Clock {
    Index step = 0;     ///< steps taken
    double time = 0.0;  ///< [s]
    double dt = 0.0;    ///< last step [s]

    /// The next step, at most `longest` [s], towards `until` [s].
    double step_towards(double until, double longest) const { return frana::step_towards(until - time, longest); }
    /// The time after a step of `length` that was not to pass `until`, both [s]: round-off neither passes nor misses it.
    double after(double length, double until) const {
        return length >= until - time ? until : std::min(time + length, until);
    }
    void tick(double length, double until) {
        step += 1;
        time = after(length, until);
        dt = length;
    }
};

}  // namespace frana
