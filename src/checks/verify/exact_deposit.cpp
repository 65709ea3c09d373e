#include "checks/verify/exact_deposit.h"

#include <cmath>

#include "base/constants.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// Integral of weight(x) depth(x) from 0 to `front` for a depth that ends as a square root. x = front (1 - w^2) makes
/// it smooth, and the midpoint rule second order.
template <class Deposit, class Weight>
double volume_of(const Deposit& deposit, const Weight& weight) {
    constexpr int parts = 4000;
    const double end = deposit.front();
    double sum = 0.0;
    for (int k = 0; k < parts; ++k) {
        const double w = (k + 0.5) / parts, x = end * (1 - w * w);
        sum += weight(x) * deposit.depth(x) * 2 * w * end / parts;
    }
    return sum;
}

/// rho g h |dh/dx| / tau_Y - 1 at x by a central difference.
template <class Deposit>
double balance(const Deposit& deposit, double x) {
    const double d = 1e-5 * deposit.front();
    const double rise = (deposit.depth(x - d) - deposit.depth(x + d)) / (2 * d);
    return deposit.depth(x) * rise / deposit.material.length() - 1;
}

}  // namespace

double FlatDeposit::front() const { return std::cbrt(9 * volume * volume / (8 * material.length())); }

double FlatDeposit::depth(double x) const {
    return x < front() ? std::sqrt(2 * material.length() * (front() - x)) : 0.0;
}

double FlatDeposit::contour(double level) const { return front() - level * level / (2 * material.length()); }

std::vector<Residual> FlatDeposit::residuals() const {
    const FlatDeposit known{{1000.0, 50.0}, 1.0};
    return {{"volume / given - 1", volume_of(*this, [](double) { return 1.0; }) / volume - 1, 1e-6},  // 1/parts^2
            {"rho g h h' / tau_Y - 1", balance(*this, 0.4 * front()), 1e-9},  // (d/x)^2 and round-off / d
            {"published: front 6.043435 m", known.front() - 6.043435, 5e-7},
            {"published: depth at the wall 0.248203 m", known.depth(0.0) - 0.248203, 5e-7}};
}

double RoundDeposit::front() const {
    return std::pow(225 * volume * volume / (128 * constants::kPi * constants::kPi * material.length()), 0.2);
}

double RoundDeposit::depth(double r) const {
    return r < front() ? std::sqrt(2 * material.length() * (front() - r)) : 0.0;
}

double RoundDeposit::contour(double level) const { return front() - level * level / (2 * material.length()); }

std::vector<Residual> RoundDeposit::residuals() const {
    const RoundDeposit known{{1000.0, 50.0}, 1.0};
    return {
        {"volume / given - 1", volume_of(*this, [](double r) { return 2 * constants::kPi * r; }) / volume - 1, 1e-6},
        {"rho g h h' / tau_Y - 1", balance(*this, 0.4 * front()), 1e-9},
        {"published: front 2.035515 m", known.front() - 2.035515, 5e-7}};
}

InclineDeposit::InclineDeposit(const YieldMaterial& material, double slope, double volume)
    : material_(material),
      slope_(slope),
      volume_(volume),
      plug_(material.length() / std::sin(slope)),
      least_(std::sin(slope) * std::sin(slope)) {
    double low = least_, high = 1.0;  // share of the plug's thickness at the wall: the volume grows with it
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (middle < 1.0 && held(middle) < volume ? low : high) = middle;
    }
    foot_ = behind(low);
    front_ = foot_ - behind(least_);
}

double InclineDeposit::distance(double share) const { return plug_ / std::tan(slope_) * (-share - std::log1p(-share)); }

double InclineDeposit::behind(double share) const {
    return std::cos(slope_) * distance(share) - plug_ * share * std::sin(slope_);
}

double InclineDeposit::held(double share) const {
    const auto integral = [&](double h) {
        return (-0.5 * h * h - h - std::log1p(-h)) / std::tan(slope_) - 0.5 * h * h * std::tan(slope_);
    };
    return plug_ * plug_ * (integral(share) - integral(least_));
}

double InclineDeposit::depth(double x) const {
    if (x >= front_) return 0.0;
    double low = least_, high = 1.0;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (low + high);
        (middle < 1.0 && behind(middle) < foot_ - x ? low : high) = middle;
    }
    return plug_ * low / std::cos(slope_);
}

double InclineDeposit::contour(double level) const {
    return foot_ - behind(std::max(least_, level * std::cos(slope_) / plug_));
}

std::vector<Residual> InclineDeposit::residuals() const {
    double volume = 0.0;
    constexpr int parts = 4000;
    for (int k = 0; k < parts; ++k) {
        const double w = (k + 0.5) / parts;
        volume += depth(front_ * (1 - w * w)) * 2 * w * front_ / parts;
    }
    // The column's own equation on the map: g e / (1 + dZ/dx e) = tau_Y / (rho h), e the surface's slope.
    const double x = 0.4 * front_, d = 1e-5 * front_, t = std::tan(slope_);
    const double e = t - (depth(x + d) - depth(x - d)) / (2 * d);
    const double drive = e / (1 + t * e);
    const InclineDeposit known({1000.0, 50.0}, 10 * kDegree, 0.1);
    std::vector<Residual> all{{"volume / given - 1", volume / volume_ - 1, 1e-6},
                              {"rho g h e / (1 + Z' e) / tau_Y - 1", drive * depth(x) / material_.length() - 1, 1e-8},
                              {"published: plug 0.029352 m", known.plug() - 0.029352, 5e-7}};
    for (const auto& [share, length] :
         {std::pair{0.25, 0.00627}, {0.5, 0.03215}, {0.75, 0.10592}, {0.9, 0.23348}, {0.99, 0.60178}})
        all.push_back({"published: distance from the front", known.distance(share) - length, 5e-6});
    return all;
}

}  // namespace frana::verify
