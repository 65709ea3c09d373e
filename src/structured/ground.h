#pragma once
// What the ground makes of gravity, in the coordinates in which particles move.
#include <cmath>
#include <functional>

#include "base/constants.h"
#include "base/types.h"

namespace frana {

/// Gravity at a place [m/s^2]: along the plane of the particles, and across the ground. Also how the ground slopes
/// against that plane [1]. Particles leave where there is no ground.
struct GroundGravity {
    double x = 0.0, y = 0.0, across = constants::kGravity;
    double slope_x = 0.0, slope_y = 0.0;
    double elevation = 0.0;           ///< [m]
    bool exit = false, hole = false;  ///< no ground; and that in a hole of the terrain
};
using Ground = std::function<GroundGravity(double x, double y)>;

/// THEORY (2): over terrain in map coordinates, given its slope (db/dx, db/dy). What slides without friction has the
/// horizontal acceleration -g_z grad b, g_z = g / (1 + |grad b|^2). A solid's length on the map stays the same over a
/// break of slope.
inline Ground terrain_ground(std::function<Vec2(double x, double y)> slope, double g = constants::kGravity) {
    return [slope = std::move(slope), g](double x, double y) {
        const Vec2 s = slope(x, y);
        const double across = g / (1.0 + s.squaredNorm());
        return GroundGravity{-across * s.x(), -across * s.y(), across, s.x(), s.y(), 0.0, false};
    };
}

/// Down a flume, x being the length along its floor, which falls by angle(x) [rad] there.
inline Ground flume_ground(std::function<double(double x)> angle, double g = constants::kGravity) {
    return [angle = std::move(angle), g](double x, double) {
        const double a = angle(x);
        return GroundGravity{g * std::sin(a), 0.0, g * std::cos(a)};
    };
}

}  // namespace frana
