#pragma once
// Upright obstacles on the plane, as the nodes in them meet them.
#include <algorithm>
#include <array>
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

    /// How far a place [m] lies behind each face: the two across x, then the two across y [m]. In the box none is below 0.
    std::array<double, 4> behind(const Vec2& x) const {
        return {x.x() - low.x(), high.x() - x.x(), x.y() - low.y(), high.y() - x.y()};
    }
    /// How deep it lies in the box; below 0 outside [m].
    double depth(const Vec2& x) const {
        const std::array<double, 4> all = behind(x);
        return *std::min_element(all.begin(), all.end());
    }
    /// THEORY (9): the velocity v [m/s] of a node behind a face, through which nothing goes.
    Vec2 stopped(int face, const Vec2& v) const {
        const int axis = face / 2;
        const double into = face % 2 == 0 ? v[axis] : -v[axis];  // faces point down the axis, then up
        if (into <= 0.0) return v;
        const double along = v[1 - axis], brake = friction * into;
        Vec2 left = Vec2::Zero();
        if (std::abs(along) > brake) left[1 - axis] = along - std::copysign(brake, along);
        return left;
    }
};

/// A face of an obstacle, and how far a place lies behind it [m].
struct FaceBehind {
    int face;  ///< as Obstacle::behind has them; below 0 for a place outside, or between other obstacles
    double depth;
};

/// The nearest face of the n-th obstacle for a place in it or on it. A face does not count where another obstacle begins
/// within half a cell behind it, such as the next house of a row. Within both it does: a corner of walls.
inline FaceBehind nearest_face(const std::vector<Obstacle>& all, std::size_t n, const Vec2& x, double cell) {
    const double slack = 1e-6 * cell, gap = 0.5 * cell;  // whatever round-off makes of places; what no node is in
    const std::array<double, 4> behind = all[n].behind(x);
    FaceBehind nearest{-1, Obstacle::kFar};
    if (*std::min_element(behind.begin(), behind.end()) < -slack) return nearest;
    const auto goes_on = [&](int face) {
        Vec2 beyond = x;
        beyond[face / 2] = face % 2 == 0 ? all[n].low[face / 2] - gap : all[n].high[face / 2] + gap;
        for (std::size_t other = 0; other < all.size(); ++other)
            if (other != n && all[other].depth(beyond) > 0.0 && !(all[other].depth(x) > slack)) return true;
        return false;
    };
    for (int face = 0; face < 4; ++face) {
        const double depth = behind[static_cast<std::size_t>(face)];
        if (depth < nearest.depth && !goes_on(face)) nearest = {face, depth};
    }
    return nearest;
}

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
