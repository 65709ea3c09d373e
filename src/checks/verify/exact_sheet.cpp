#include "checks/verify/exact_sheet.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::verify {
namespace {

/// Mean of f over [a, b] by Simpson's rule on so many pieces.
template <class F>
double mean_of(const F& f, double a, double b, int pieces) {
    double sum = 0.0;
    const double d = (b - a) / pieces;
    for (int k = 0; k < pieces; ++k) sum += f(a + k * d) + 4 * f(a + (k + 0.5) * d) + f(a + (k + 1) * d);
    return sum / (6 * pieces);
}

using constants::kDegree;

}  // namespace

double BinghamSheet::plug() const { return yield_stress / (density * g * std::sin(slope)); }

double BinghamSheet::speed(double z) const {
    const double sheared = std::max(0.0, thickness - plug()), s = std::min(z, sheared);
    return density * g * std::sin(slope) / viscosity * s * (sheared - 0.5 * s);
}

double BinghamSheet::mean_speed() const {
    const double share = plug() / thickness;
    if (share >= 1.0) return 0.0;
    return density * g * std::sin(slope) * thickness * thickness / (3 * viscosity) * (1 - share) * (1 - share) *
           (1 + 0.5 * share);
}

std::vector<Residual> BinghamSheet::residuals() const {
    const double yields = thickness - plug(), drive = density * g * std::sin(slope);
    const auto profile = [&](double z) { return speed(z); };
    const double mean =  // a parabola below, a plug above: Simpson's rule is exact on either
        (yields * mean_of(profile, 0.0, yields, 1) + plug() * speed(thickness)) / thickness;
    const double z = 0.4 * yields, d = 0.1 * yields;  // central differences of a parabola are exact
    const double stress = yield_stress + viscosity * (speed(z + d) - speed(z - d)) / (2 * d);
    const BinghamSheet known{1500.0, 10.0, 100.0, 15 * kDegree, 0.3};
    return {{"mean of the profile / mean speed - 1", mean / mean_speed() - 1, 1e-14},
            {"stress of the law / weight - 1", stress / (drive * (thickness - z)) - 1, 1e-13},
            {"published: 1500, 10, 100, 15 deg, .3 m: 9.929397 m/s", known.mean_speed() - 9.929397, 5e-7},
            {"published: its surface, 14.269635 m/s", known.speed(0.3) - 14.269635, 5e-7}};
}

double BagnoldSheet::inertial_number() const {
    return law.i0 * (std::tan(slope) - law.mu_s) / (law.mu_2 - std::tan(slope));
}

double BagnoldSheet::speed(double z) const {
    const double h = thickness;
    return 2 * inertial_number() / (3 * law.grain_diameter) * std::sqrt(law.solid_fraction * g * std::cos(slope)) *
           (h * std::sqrt(h) - (h - z) * std::sqrt(h - z));
}

double BagnoldSheet::mean_speed() const { return 0.6 * speed(thickness); }

std::vector<Residual> BagnoldSheet::residuals() const {
    // With w = sqrt(1 - z/h) the profile is a polynomial of w, and its mean one of degree 4. Two pieces are not exact,
    // 128 are to 1e-10.
    const double mean = mean_of([&](double w) { return 2 * w * speed(thickness * (1 - w * w)); }, 0.0, 1.0, 128);
    const double z = 0.3 * thickness, d = 1e-4 * thickness;  // difference formula: (d / (h - z))^2 / 24
    const double shear = (speed(z + d) - speed(z - d)) / (2 * d);
    const double i = shear * law.grain_diameter / std::sqrt(law.solid_fraction * g * std::cos(slope) * (thickness - z));
    const double mu = law.mu_s + (law.mu_2 - law.mu_s) / (law.i0 / i + 1);
    const BagnoldSheet known{{std::tan(21 * kDegree), std::tan(33 * kDegree), 0.3, 1e-3, 0.6}, 26 * kDegree, 0.02};
    return {{"mean of the profile / mean speed - 1", mean / mean_speed() - 1, 1e-9},
            {"mu(I) at a sheared place / tan(slope) - 1", mu / std::tan(slope) - 1, 1e-8},
            {"published: I = 0.19273583", known.inertial_number() - 0.19273583, 5e-9},
            {"published: surface 0.83590402 m/s", known.speed(0.02) - 0.83590402, 5e-9},
            {"published: mean 0.50154241 m/s", known.mean_speed() - 0.50154241, 5e-9}};
}

}  // namespace frana::verify
