#include "mpm/domain.h"

#include <cmath>

namespace frana {

Gradient spanned(const Gradient& c, double r1x, double r1y, double r2x, double r2y) {
    constexpr double least = 1.0 / 16.0;  // [cells]
    const Moments s = Moments::of({r1x, r1y, r2x, r2y});
    const double half = 0.5 * (s.xx - s.yy), narrow = 0.5 * (s.xx + s.yy) - std::sqrt(half * half + s.xy * s.xy);
    if (12.0 * narrow >= least * least) return c;
    const Edges e = rectangle_of(s);
    const double a = std::hypot(e.r1x, e.r1y), b = std::hypot(e.r2x, e.r2y);
    if (a == 0.0) return {0.0, 0.0, 0.0, 0.0};
    const double ux = e.r1x / a, uy = e.r1y / a, keep_a = std::fmin(1.0, a / least), keep_b = std::fmin(1.0, b / least);
    // The projector keep_a u u^T + keep_b w w^T, w across u.
    const double pxx = keep_a * ux * ux + keep_b * uy * uy, pyy = keep_a * uy * uy + keep_b * ux * ux;
    const double pxy = (keep_a - keep_b) * ux * uy;
    return {c.xx * pxx + c.xy * pxy, c.xx * pxy + c.xy * pyy, c.yx * pxx + c.yy * pxy, c.yx * pxy + c.yy * pyy};
}

}  // namespace frana
