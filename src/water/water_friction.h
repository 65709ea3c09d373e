#pragma once
// Friction of water at the bed.
#include <cmath>

namespace frana {

/// Stress over density k |V| V: g n^2 / T^(1/3) of Manning (n in s/m^(1/3)), or f / 8 of Darcy and Weisbach
/// (f [1]); V is the velocity along the bed, T the thickness across it.
struct WaterFriction {
    enum class Law { none, manning, darcy_weisbach };
    Law law = Law::none;
    double coefficient = 0.0;  ///< n or f, >= 0
};

/// Where friction acts.
struct WaterBed {
    double gravity;    ///< g [m/s^2]
    double thickness;  ///< T, across the bed, > 0 [m]
    double kappa;      ///< |V| over the speed on the map, >= 1 [1]
};

/// The deceleration on the map over the speed on the map squared [1/m].
inline double quadratic_drag(const WaterFriction& friction, const WaterBed& bed) {
    const double t = bed.thickness, c = friction.coefficient;
    if (friction.law == WaterFriction::Law::manning)
        return bed.gravity * c * c * bed.kappa / (t * std::cbrt(t));
    if (friction.law == WaterFriction::Law::darcy_weisbach) return c * bed.kappa / (8.0 * t);
    return 0.0;
}

}  // namespace frana
