#pragma once
// Shape functions: which nodes a point touches, with which weights and slopes. src/shallow/THEORY.md (8) to (10).
#include <cmath>

#include "base/types.h"

namespace frana {

/// Quadratic B-spline in one direction: 3 nodes from `base`; weights and their slopes per cell.
/// u is the position in cells; N = {(3/2-f)^2/2, 3/4-(f-1)^2, (f-1/2)^2/2}, f = u - base in [1/2, 3/2).
struct Quadratic {
    static constexpr int kNodes = 3;
    /// Of a point's mass the most that comes back to it from the nodes around: on one of them, (sum N^2)^2 [1].
    static constexpr double kMostOfItself = 0.59375 * 0.59375;
    Index base;
    double w[3];
    explicit Quadratic(double u) {
        const double first = std::floor(u - 0.5);
        base = static_cast<Index>(first);
        const double f = u - first;
        w[0] = 0.5 * (1.5 - f) * (1.5 - f);
        w[1] = 0.75 - (f - 1.0) * (f - 1.0);
        w[2] = 0.5 * (f - 0.5) * (f - 0.5);
        offset = f;
    }
    /// dN/du of node n
    double slope(int n) const { return n == 0 ? offset - 1.5 : n == 1 ? -2.0 * (offset - 1.0) : offset - 0.5; }
    double offset;  ///< u - base
};

/// Cubic B-spline in one direction: 4 nodes from `base`, f = u - base in [1, 2).
struct Cubic {
    static constexpr int kNodes = 4;
    static constexpr double kMostOfItself = 0.5 * 0.5;
    Index base;
    double w[4];
    explicit Cubic(double u) {
        const double first = std::floor(u) - 1.0;
        base = static_cast<Index>(first);
        offset = u - first;
        const double t = offset - 1.0, s = 1.0 - t;
        w[0] = s * s * s / 6.0;
        w[1] = 2.0 / 3.0 - t * t * (1.0 - 0.5 * t);
        w[2] = 2.0 / 3.0 - s * s * (1.0 - 0.5 * s);
        w[3] = t * t * t / 6.0;
    }
    double slope(int n) const {
        const double t = offset - 1.0, s = 1.0 - t;
        return n == 0 ? -0.5 * s * s : n == 1 ? t * (1.5 * t - 2.0) : n == 2 ? s * (2.0 - 1.5 * s) : 0.5 * t * t;
    }
    double offset;  ///< u - base
};

/// Linear shape function (bilinear in the plane), the choice of Fois et al. 2024, eq. 14: 2 nodes from `base`.
struct Linear {
    static constexpr int kNodes = 2;
    static constexpr double kMostOfItself = 1.0;
    Index base;
    double w[2];
    explicit Linear(double u) {
        const double first = std::floor(u);
        base = static_cast<Index>(first);
        offset = u - first;
        w[0] = 1.0 - offset;
        w[1] = offset;
    }
    double slope(int n) const { return n == 0 ? -1.0 : 1.0; }
    double offset;
};

}  // namespace frana
