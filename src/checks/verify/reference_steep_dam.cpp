#include "checks/verify/reference_steep_dam.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_dam_break.h"

namespace frana::verify {

SteepDam::SteepDam(const Plane& plane, double behind, double end, int parcels)
    : plane_(plane), mass_(behind * plane.depth / parcels) {
    const std::size_t edges = static_cast<std::size_t>(parcels) + 1;
    x_.resize(edges), u_.assign(edges, 0.0);
    for (std::size_t k = 0; k < edges; ++k) x_[k] = behind * (static_cast<double>(k) / parcels - 1.0);
    // A wave crosses a quarter of the narrowest parcel: they only grow wider.
    const double longest = 0.25 * (behind / parcels) / std::sqrt(plane.gravity * plane.depth);
    const double steps = std::ceil(end / longest), dt = end / steps;
    accelerate(0.5 * dt);
    for (double step = 1; step <= steps; ++step) {
        for (std::size_t k = 0; k < edges; ++k) x_[k] += dt * u_[k];
        accelerate(step < steps ? dt : 0.5 * dt);
    }
}

double SteepDam::drive(double gradient) const {
    const double fall = plane_.slope - gradient, slope2 = plane_.slope * plane_.slope;
    return plane_.gravity * (fall / (1.0 + plane_.slope * std::max(0.0, fall)) - plane_.friction / (1.0 + slope2));
}

/// The last edge behind the dam moves as an endless layer, the first edge in front has nothing before it.
void SteepDam::accelerate(double dt) {
    const std::size_t last = x_.size() - 1;
    u_[0] += dt * drive(0.0);
    double behind = mass_ / (x_[1] - x_[0]);
    for (std::size_t k = 1; k < last; ++k) {
        const double before = mass_ / (x_[k + 1] - x_[k]);
        u_[k] += dt * drive((before - behind) / (0.5 * (x_[k + 1] - x_[k - 1])));
        behind = before;
    }
    u_[last] += dt * drive(-behind / (0.5 * (x_[last] - x_[last - 1])));
}

std::size_t SteepDam::parcel_at(double x) const {
    const auto next = std::upper_bound(x_.begin(), x_.end(), x);
    return static_cast<std::size_t>(
               std::clamp<std::ptrdiff_t>(next - x_.begin(), 1, static_cast<std::ptrdiff_t>(x_.size()) - 1)) -
           1;
}

/// Linear between the middles of parcels.
double SteepDam::depth_at(double x) const {
    if (x > x_.back()) return 0.0;
    const auto depth = [&](std::size_t k) { return mass_ / (x_[k + 1] - x_[k]); };
    const auto middle = [&](std::size_t k) { return 0.5 * (x_[k + 1] + x_[k]); };
    std::size_t k = parcel_at(x);
    if (x < middle(k)) k = k > 0 ? k - 1 : 0;
    if (k + 2 >= x_.size()) return depth(k);
    const double share = std::clamp((x - middle(k)) / (middle(k + 1) - middle(k)), 0.0, 1.0);
    return (1.0 - share) * depth(k) + share * depth(k + 1);
}

double SteepDam::velocity_at(double x) const {
    if (x > x_.back()) return 0.0;
    const std::size_t k = parcel_at(x);
    const double share = std::clamp((x - x_[k]) / (x_[k + 1] - x_[k]), 0.0, 1.0);
    return (1.0 - share) * u_[k] + share * u_[k + 1];
}

std::vector<Residual> steep_dam_residuals() {
    constexpr double kEnd = 5.0, kBehind = 20.0;  // the fan's rear stands at -15.7 m
    // Nearly level and without friction: Ritter's fan, slowly carried down.
    const SteepDam gentle({1e-6, 0.0, 1.0, 9.81}, kBehind, kEnd, 8000);
    const Ritter ritter{1.0, 9.81};
    double off = 0.0, whole = 0.0;
    for (double x = -15.0; x < 30.0; x += 0.05) {
        const double exact = ritter.at(x / kEnd).depth;
        off += std::abs(gentle.depth_at(x) - exact), whole += exact;
    }
    const double tangent = std::tan(22 * constants::kPi / 180.0), friction = std::tan(21 * constants::kPi / 180.0);
    const SteepDam fine({tangent, friction, 1.0, 9.81}, kBehind, kEnd, 8000),
        coarse({tangent, friction, 1.0, 9.81}, kBehind, kEnd, 4000);
    double apart = 0.0, all = 0.0;
    for (double x = -15.0; x < 40.0; x += 0.05)
        apart += std::abs(fine.depth_at(x) - coarse.depth_at(x)), all += fine.depth_at(x);
    // A quarter of the smallest error that is measured with it. Order one: half the parcels change it by its own error.
    constexpr double kBound = 0.25 * 6.6e-3;
    return {{"parcels on a level bed against Ritter", off / whole, kBound},
            {"steep, half the parcels", apart / all, kBound}};
}

}  // namespace frana::verify
