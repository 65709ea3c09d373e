#include "checks/verify/exact_spreading.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// Integral of s^(n-1) (1 - s^2)^(1/3) from 0 to 1, n = 1, 2: B(n/2, 4/3) / 2.
double shape_integral(int n) {
    return 0.5 * std::tgamma(0.5 * n) * std::tgamma(4.0 / 3) / std::tgamma(0.5 * n + 4.0 / 3);
}

/// dh/dt + (1/r^k) d(r^k q)/dr over its first term, q = -(g / (3 nu)) h^3 dh/dr, by central differences at `r`.
template <class Sheet>
double diffusion_residual(const Sheet& sheet, int k, double r, double t) {
    const double b = sheet.g / (3 * sheet.nu), d = 1e-3 * r, e = 1e-3 * t;
    const auto weighted_flux = [&](double x) {
        const double h = sheet.depth(x, t), rise = (sheet.depth(x + d, t) - sheet.depth(x - d, t)) / (2 * d);
        return -b * h * h * h * rise * std::pow(x, k);
    };
    const double by_time = (sheet.depth(r, t + e) - sheet.depth(r, t - e)) / (2 * e);
    const double by_place = (weighted_flux(r + d) - weighted_flux(r - d)) / (2 * d * std::pow(r, k));
    return (by_time + by_place) / by_time;
}

/// h u of the given speed against -(g / (3 nu)) h^3 dh/dr.
template <class Sheet>
double flux_residual(const Sheet& sheet, double r, double t) {
    const double d = 1e-4 * r, h = sheet.depth(r, t);
    const double rise = (sheet.depth(r + d, t) - sheet.depth(r - d, t)) / (2 * d);
    return -sheet.g / (3 * sheet.nu) * h * h * rise / sheet.speed(r, t) - 1;
}

double at_share(double share) { return share < 1.0 ? std::cbrt(1 - share * share) : 0.0; }

}  // namespace

double PlanarSpreading::front(double t) const {
    static const double eta = std::pow(std::cbrt(0.3) * shape_integral(1), -0.6);
    return eta * std::pow(g * volume * volume * volume * t / (3 * nu), 0.2);
}

double PlanarSpreading::depth(double x, double t) const {
    return volume / (shape_integral(1) * front(t)) * at_share(x / front(t));
}

double PlanarSpreading::contour(double level, double t) const {
    return front(t) * std::sqrt(1 - std::pow(level / depth(0.0, t), 3));
}

std::vector<Residual> PlanarSpreading::residuals() const {
    const PlanarSpreading known{0.01, 1.0};
    const double t = 10.0, r = 0.5 * known.front(t);
    return {{"dh/dt + dq/dx", diffusion_residual(known, 0, r, t), 1e-5},  // differences of 1e-3
            {"u / (q/h) - 1", flux_residual(known, r, t), 1e-7},
            {"published: front 7.120523 m", known.front(t) - 7.120523, 5e-7},
            {"published: depth 0.166929 m", known.depth(0.0, t) - 0.166929, 5e-7},
            {"published: shape 0.84130926", shape_integral(1) - 0.84130926, 5e-9}};
}

double RoundSpreading::front(double t) const {
    static const double xi = std::pow(1024 / (81 * constants::kPi * constants::kPi * constants::kPi), 0.125);
    return xi * std::pow(g * volume * volume * volume * t / (3 * nu), 0.125);
}

double RoundSpreading::depth(double r, double t) const {
    return 4 * volume / (3 * constants::kPi * front(t) * front(t)) * at_share(r / front(t));
}

double RoundSpreading::contour(double level, double t) const {
    return front(t) * std::sqrt(1 - std::pow(level / depth(0.0, t), 3));
}

std::vector<Residual> RoundSpreading::residuals() const {
    const RoundSpreading known{0.01, 1.0};
    const double t = 10.0, r = 0.5 * known.front(t);
    return {{"dh/dt + (1/r) d(r q)/dr", diffusion_residual(known, 1, r, t), 1e-5},
            {"u / (q/h) - 1", flux_residual(known, r, t), 1e-7},
            {"volume of the shape: 3/8", shape_integral(2) - 0.375, 1e-14},
            {"published: front 2.458183 m", known.front(t) - 2.458183, 5e-7},
            {"published: depth 0.070236 m", known.depth(0.0, t) - 0.070236, 5e-7}};
}

double InclineSpreading::outer_front(double t) const {
    return std::cbrt(9 * volume * volume * g * std::sin(slope) * t / (4 * nu));
}

double InclineSpreading::front_thickness(double t) const { return 1.5 * volume / outer_front(t); }

double InclineSpreading::length(double t) const { return front_thickness(t) / std::tan(slope); }

double InclineSpreading::front(double t) const { return outer_front(t) + (std::log(2.0) - 0.5) * length(t); }

double InclineSpreading::step(double distance) {
    if (distance <= 0.0) return 0.0;
    if (distance > 30.0) return 1.0;  // artanh: 1 - h = 2 exp(-2 s - 2) is below round-off
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (low + high);
        (std::atanh(middle) - middle < distance ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

double InclineSpreading::thickness(double along, double t) const {
    const double end = front(t);
    if (along <= 0.0 || along >= end) return 0.0;
    const double outer = std::sqrt(nu * std::min(along, outer_front(t)) / (g * std::sin(slope) * t));
    return outer * step((end - along) / length(t));
}

double InclineSpreading::contour(double thickness_there, double t) const {
    const double share = thickness_there / front_thickness(t);
    return front(t) - length(t) * (std::atanh(share) - share);
}

std::vector<Residual> InclineSpreading::residuals() const {
    // Outer: dh/dt + (g sin th / nu) h^2 dh/dX = 0. Step: 1 - cot th dh/dX = (h_N/h)^2. Volume: all of it.
    const double t = 10.0, x = 0.4 * outer_front(t), d = 1e-4 * x, e = 1e-4 * t;
    const auto outer = [&](double at, double when) { return std::sqrt(nu * at / (g * std::sin(slope) * when)); };
    const double by_time = (outer(x, t + e) - outer(x, t - e)) / (2 * e), h = outer(x, t);
    const double by_place = g * std::sin(slope) / nu * h * h * (outer(x + d, t) - outer(x - d, t)) / (2 * d);
    const double s = 0.3, rise = (step(s + 1e-5) - step(s - 1e-5)) / 2e-5;
    double missing = 0.0;
    constexpr int parts = 20000;
    for (int k = 0; k < parts; ++k) missing += (1 - step(20.0 * (k + 0.5) / parts)) * 20.0 / parts;
    const InclineSpreading known{0.1, 1.0, 10 * kDegree};
    return {{"outer: (dh/dt + dq/dX) / (dh/dt)", (by_time + by_place) / by_time, 1e-7},
            {"step: 1 + dH/ds - 1/H^2", (1 + rise) * step(s) * step(s) - 1, 1e-8},
            {"step: missing volume - (ln 2 - 1/2)", missing - (std::log(2.0) - 0.5), 1e-3},  // its foot is (3 s)^(1/3)
            {"published: front 7.263968 m", known.outer_front(10.0) - 7.263968, 5e-7},
            {"published: front 15.649745 m", known.outer_front(100.0) - 15.649745, 5e-7},
            {"published: thickness 0.206499 m", known.front_thickness(10.0) - 0.206499, 5e-7},
            {"published: thickness 0.095848 m", known.front_thickness(100.0) - 0.095848, 5e-7}};
}

}  // namespace frana::verify
