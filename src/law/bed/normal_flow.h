#pragma once
// Uniform flow down a plane, by any bed law: friction balances gravity (src/shallow/THEORY.md (65)).
#include <cmath>
#include <limits>
#include <variant>

#include "law/bed/laws.h"

namespace frana::bed {

/// A plane, and what flows down it.
struct Plane {
    double slope;    ///< tangent of its inclination, > 0 [1]
    double gravity;  ///< [m/s^2]
    double density;  ///< [kg/m^3]
    double cosine() const { return 1.0 / std::sqrt(1.0 + slope * slope); }
};

/// Speed along the bed of uniform flow of a thickness normal to the bed [m/s]. 0: it stays at rest. Infinite: it gets
/// faster for ever. A law's step leaves its steady speed as it is, however long the step: the root is found by halving.
inline double uniform_speed(const BedLaw& law, double thickness, const Plane& plane) {
    const double c = plane.cosine(), dt = 1.0, drive = plane.gravity * plane.slope * c * c;
    const BedState bed{plane.gravity * c * c, thickness, 1.0 / c, c, plane.gravity, plane.density};
    const auto gain = [&](double s) {
        return std::visit([&](const auto& of) { return double{of.speed_after(bed, s, s + dt * drive, dt)} - s; }, law);
    };
    if (!(gain(0.0) > 0.0)) return 0.0;
    double low = 0.0, high = 1.0;
    while (gain(high) > 0.0) {
        if (high > 1e4) return std::numeric_limits<double>::infinity();
        low = high, high *= 2.0;
    }
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (gain(middle) > 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high) / c;  // of the map's speed
}

/// Thickness and speed of uniform flow.
struct NormalFlow {
    double thickness = 0.0;  ///< normal to the bed [m]
    double speed = 0.0;      ///< along the bed [m/s]; 0: it stays at rest, infinite: it gets faster for ever
};

/// That of a discharge per width [m2/s].
inline NormalFlow normal_flow(const BedLaw& law, double discharge, const Plane& plane) {
    double low = 0.0, high = 1e-3;
    const auto speed = [&](double thickness) { return uniform_speed(law, thickness, plane); };
    for (; high * speed(high) < discharge; high *= 2.0) {
        if (high > 1e3) return {high, 0.0};
        low = high;
    }
    if (std::isinf(speed(high))) return {high, speed(high)};
    for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (low + high);
        (middle * speed(middle) < discharge ? low : high) = middle;
    }
    const double thickness = 0.5 * (low + high);
    return {thickness, discharge / thickness};
}

}  // namespace frana::bed
