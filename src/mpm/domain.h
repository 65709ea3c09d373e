#pragma once
// A point's domain: the parallelogram of its edges r1, r2. The rest of the scheme uses its second moments only.
// src/shallow/THEORY.md (53).
#include <cmath>

#include "base/simd.h"
#include "base/types.h"

namespace frana {

/// Edges of a parallelogram [cells].
struct Edges {
    double r1x, r1y, r2x, r2y;
    double length1_2() const { return r1x * r1x + r1y * r1y; }  ///< [cells^2]
    double length2_2() const { return r2x * r2x + r2y * r2y; }
    double area() const { return r1x * r2y - r1y * r2x; }  ///< with its sign [cells^2]
};

/// Those of point p (Held: Carried of shallow/particles.h).
template <class Held>
Edges edges_of(const Held& held, Index p) {
    return {held.r1x[p], held.r1y[p], held.r2x[p], held.r2y[p]};
}
template <class Held>
void set_edges(Held& held, Index p, const Edges& e) {
    using Real = typename decltype(held.r1x)::value_type;
    held.r1x[p] = static_cast<Real>(e.r1x), held.r1y[p] = static_cast<Real>(e.r1y);
    held.r2x[p] = static_cast<Real>(e.r2x), held.r2y[p] = static_cast<Real>(e.r2y);
}

/// Second moments of a mass spread evenly over a domain, per unit of mass: (r1 r1^T + r2 r2^T) / 12 [cells^2].
struct Moments {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    static Moments of(const Edges& e) {
        return {(e.r1x * e.r1x + e.r2x * e.r2x) / 12.0, (e.r1x * e.r1y + e.r2x * e.r2y) / 12.0,
                (e.r1y * e.r1y + e.r2y * e.r2y) / 12.0};
    }
    /// Adds `share` of others, whose centre lies (dx, dy) away from the common one.
    void add(double share, const Moments& o, double dx, double dy) {
        xx += share * (o.xx + dx * dx);
        xy += share * (o.xy + dx * dy);
        yy += share * (o.yy + dy * dy);
    }
};

/// The rectangle that has these second moments, r1 its longer edge: edges along their principal directions,
/// sqrt(12 lambda) long. A square lies along the grid.
inline Edges rectangle_of(const Moments& s) {
    const double mean = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
    const double radius = std::sqrt(half * half + s.xy * s.xy);
    const double a = std::sqrt(12.0 * (mean + radius)), b = std::sqrt(12.0 * std::fmax(0.0, mean - radius));
    if (radius <= 1e-9 * mean) return {a, 0.0, 0.0, b};  // round-off must not choose a direction
    // Half of the angle whose cosine is half / radius; the form without cancellation.
    double cosine, sine;
    if (half >= 0.0) {
        cosine = std::sqrt(0.5 * (1.0 + half / radius));
        sine = 0.5 * s.xy / (radius * cosine);
    } else {
        sine = std::sqrt(0.5 * (1.0 - half / radius));
        cosine = 0.5 * s.xy / (radius * sine);
    }
    return {a * cosine, a * sine, -b * sine, b * cosine};
}

/// A velocity gradient as the point's own domain feels it.
struct Gradient {
    double xx, xy, yx, yy;
};

/// THEORY (12): the gradient without what a domain narrower than a sixteenth of a cell does not span. Points that
/// converge are squeezed to such domains. But a node, a cell away, would take their gradient times that cell for
/// motion. That is a kinetic energy that no matter has, and that carries a block beyond its stop. Real: double, or
/// Double4 of four points. r: edges [cells], c: the gradient.
template <class Real>
[[gnu::always_inline]] inline void leave_spanned(const Real& r1x, const Real& r1y, const Real& r2x, const Real& r2y,
                                                 Real& cxx, Real& cxy, Real& cyx, Real& cyy) {
    constexpr double least = 1.0 / 16.0;  // [cells]
    constexpr double tiny = 1e-300;       // a domain without length divides nothing by zero
    const Real xx = r1x * r1x + r2x * r2x, yy = r1y * r1y + r2y * r2y, xy = r1x * r1y + r2x * r2y;
    const Real half = 0.5 * (xx - yy), radius = sqrt(half * half + xy * xy);
    const Real length = sqrt(0.5 * (xx + yy) + radius);  // of the rectangle that has these moments, u along it
    const Real width = abs(r1x * r2y - r1y * r2x) / max(length, Real{} + tiny);
    const Real along = min(length / least, Real{} + 1.0), across = min(width / least, Real{} + 1.0);
    // The projector along u u^T + across (1 - u u^T), with u u^T = (r r^T - width^2) / (length^2 - width^2).
    // Next to a square no direction is chosen by round-off.
    const Real turn = (along - across) / max(max(2.0 * radius, 1e-12 * length * length), Real{} + tiny);
    const Real pxx = across + turn * (xx - width * width), pyy = across + turn * (yy - width * width), pxy = turn * xy;
    const Real x = cxx * pxx + cxy * pxy, y = cyx * pxx + cyy * pxy;
    cxy = cxx * pxy + cxy * pyy, cyy = cyx * pxy + cyy * pyy;
    cxx = x, cyx = y;
}

/// The same of one point.
inline Gradient spanned(Gradient c, double r1x, double r1y, double r2x, double r2y) {
    leave_spanned(r1x, r1y, r2x, r2y, c.xx, c.xy, c.yx, c.yy);
    return c;
}

}  // namespace frana
