#pragma once
// A point's domain: the parallelogram of its edges r1, r2, known to the rest of the scheme by its second moments.
#include <cmath>

namespace frana {

/// Second moments of a mass spread evenly over a domain, per unit of mass: (r1 r1^T + r2 r2^T) / 12 [cells^2].
struct Moments {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    /// Of a parallelogram with these edges [cells].
    static Moments of(double r1x, double r1y, double r2x, double r2y) {
        return {(r1x * r1x + r2x * r2x) / 12.0, (r1x * r1y + r2x * r2y) / 12.0, (r1y * r1y + r2y * r2y) / 12.0};
    }
    /// Adds `share` of others, whose centre lies (dx, dy) away from the common one.
    void add(double share, const Moments& o, double dx, double dy) {
        xx += share * (o.xx + dx * dx);
        xy += share * (o.xy + dx * dy);
        yy += share * (o.yy + dy * dy);
    }
};

/// Edges of a rectangle, r1 the longer one [cells].
struct Edges { double r1x, r1y, r2x, r2y; };

/// The rectangle that has these second moments: edges along their principal directions, sqrt(12 lambda) long. A square
/// lies along the grid.
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
struct Gradient { double xx, xy, yx, yy; };

/// The gradient without what a domain narrower than a sixteenth of a cell does not span. Points that converge are
/// squeezed to such domains, but a node, a cell away, would take their gradient times that cell for motion: a kinetic
/// energy that no matter has, and that carries a block beyond its stop.
Gradient spanned(const Gradient& c, double r1x, double r1y, double r2x, double r2y);

}  // namespace frana
