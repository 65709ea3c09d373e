#include "law/solid/herschel_bulkley.h"

#include <algorithm>

namespace frana::solid {

/// Newton's steps for the unknown in which the equation is convex: s for n <= 1, else the rate. From a start beyond the
/// root they come down to it and never pass it.
double HerschelBulkley::left_of(double over, double dt) const {
    if (!(over > 0.0) || !(consistency > 0.0)) return 0.0;
    const double g = shear * dt, power = exponent <= 1.0 ? 1.0 / exponent : exponent;
    // x + a x^power = whole, with x = s, or x = G dt rate.
    const double a = exponent <= 1.0 ? g * std::pow(consistency, -power) : consistency * std::pow(g, -power);
    double x = std::min(over, std::pow(over / a, 1.0 / power));
    constexpr int kMostSteps = 60;  // quadratic from the second on: six at most were seen
    constexpr double kRoundOff = 1e-14;
    for (int step = 0; step < kMostSteps; ++step) {
        const double y = a * std::pow(x, power), down = (x + y - over) / (1.0 + power * y / x);
        x -= down;
        if (!(down > kRoundOff * x)) break;
    }
    return exponent <= 1.0 ? x : over - x;
}

}  // namespace frana::solid
