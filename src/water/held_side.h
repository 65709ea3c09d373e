#pragma once
// Water beyond a side of the grid: of a lake that is held at its level, or where the ground ends. THEORY (30), (31).
#include <algorithm>
#include <cmath>

namespace frana {

/// At a side, of even depth beyond it.
struct AtSide {
    double depth;  ///< [m]
    double out;    ///< speed out of the grid; negative where water comes in [m/s]
};

/// The water that a side has before a lake of depth `lake` at rest far behind it, 0 where all falls out. `h`, `u`: of the
/// last cell, the speed outwards. `g`: gravity across the ground [m/s^2]. What leaves slower than waves stands at the lake's
/// level, and no lower than its critical depth. What comes in has the lake's energy, and is no faster than waves. The
/// invariant u + 2 c of the last cell gives the rest. A lake at rest stays so to the last bit.
inline AtSide at_side(double h, double u, double lake, double g) {
    const double c = std::sqrt(g * h), c_lake = std::sqrt(g * lake), leaves = u + 2.0 * c;
    const double lacks = 2.0 * (c_lake - c) - u;  // of the invariant, for a lake at rest
    if (lacks > 0.0) {
        constexpr double kCritical = 2.0 / 3.0;  // of the lake's depth, where what comes in is as fast as its waves
        const double critical = std::sqrt(kCritical) * c_lake;
        if (leaves <= critical) return {kCritical * lake, -critical};
        const double in =
            lacks * (2.0 * c_lake + leaves) / (leaves + std::sqrt(12.0 * g * lake - 2.0 * leaves * leaves));
        return {lake - 0.5 * in * in / g, -in};
    }
    const double critical = leaves / 3.0;
    if (critical <= c_lake) return {lake, -lacks};
    if (u >= c) return {h, u};
    return {critical * critical / g, critical};
}

}  // namespace frana
