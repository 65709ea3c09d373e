#pragma once

namespace frana {

/// A step of at most `longest` towards a time that is `left` away, both [s]. The time is hit exactly, and the steps
/// before it are not shorter than half of `longest`: a crumb would cost as much as a whole step.
inline double step_towards(double left, double longest) {
    if (left <= longest) return left;
    return left < 2.0 * longest ? 0.5 * left : longest;
}

}  // namespace frana
