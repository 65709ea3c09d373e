#pragma once
// Numbers of mathematics that several rooms need, and the default of gravity.

namespace frana::constants {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180.0;  ///< in radians
inline constexpr double kRadian = 180.0 / kPi;  ///< in degrees
inline constexpr double kGravity = 9.81;        ///< where a case gives no other [m/s^2]

}  // namespace frana::constants
