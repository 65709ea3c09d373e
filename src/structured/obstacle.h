#pragma once
// Upright obstacles on the plane, as the nodes in them meet them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/types.h"

namespace frana {

/// A box with sides along x and y; a side at infinity makes a wall. Contact is unilateral: normal forces are
/// compressive. Friction along its faces is `friction` times the normal force.
struct Obstacle {
    static constexpr double kFar = std::numeric_limits<double>::infinity();
    Vec2 low{-kFar, -kFar}, high{kFar, kFar};  ///< [m]
    double friction = 0.0;                     ///< mu [1]

    /// THEORY (9): the velocity v [m/s] of a node at x [m]. Inside, and no farther than `slack` [m] from the faces,
    /// nothing goes through the nearest face.
    Vec2 met(const Vec2& x, const Vec2& v, double slack) const {
        const double depth[4] = {x.x() - low.x(), high.x() - x.x(), x.y() - low.y(), high.y() - x.y()};
        const int face = static_cast<int>(std::min_element(depth, depth + 4) - depth);
        if (!(depth[face] >= -slack)) return v;
        const int axis = face / 2;
        const double into = face % 2 == 0 ? v[axis] : -v[axis];  // faces point down the axis, then up
        if (into <= 0.0) return v;
        const double along = v[1 - axis], brake = friction * into;
        Vec2 left = Vec2::Zero();
        if (std::abs(along) > brake) left[1 - axis] = along - std::copysign(brake, along);
        return left;
    }
};

/// Integral of the quadratic B-spline from far below to t [cells from its node].
inline double spline_below(double t) {
    if (t <= -1.5) return 0.0;
    if (t >= 1.5) return 1.0;
    if (t < -0.5) return (t + 1.5) * (t + 1.5) * (t + 1.5) / 6.0;
    if (t > 0.5) return 1.0 - (1.5 - t) * (1.5 - t) * (1.5 - t) / 6.0;
    return 0.5 + t * (0.75 - t * t / 3.0);
}

/// Share of a node's shape function that the box from low to high covers.
inline double covered(const Vec2& low, const Vec2& high, const Vec2& node, double cell) {
    double share = 1.0;
    for (int axis = 0; axis < 2; ++axis)
        share *= std::max(
            0.0, spline_below((high[axis] - node[axis]) / cell) - spline_below((low[axis] - node[axis]) / cell));
    return share;
}

/// Of a node at the corner between two walls. Behind walls, where less is open and little lies, depths would
/// be noise.
constexpr double kLeastOpen = 0.25;

/// Share of a node's shape function that material can fill: outside of all obstacles, of which no three
/// overlap. Mass over this share is the depth at a wall. Not below `least`.
inline double open_share(const std::vector<Obstacle>& obstacles, const Vec2& node, double cell, double least) {
    double open = 1.0;
    for (std::size_t a = 0; a < obstacles.size(); ++a) {
        open -= covered(obstacles[a].low, obstacles[a].high, node, cell);
        for (std::size_t b = 0; b < a; ++b)
            open += covered(obstacles[a].low.cwiseMax(obstacles[b].low), obstacles[a].high.cwiseMin(obstacles[b].high),
                            node, cell);
    }
    return std::max(open, least);
}

}  // namespace frana
