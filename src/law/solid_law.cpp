#include "law/solid_law.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

#include "base/error.h"

namespace frana {
namespace {

/// exp(a) or ln(a) of a symmetric matrix by its principal values.
template <class Function>
Sym3 by_principal_values(const Sym3& a, Function&& function) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(a.matrix());
    const Vec3 values = solver.eigenvalues().unaryExpr(function);
    return Sym3::of(solver.eigenvectors() * values.asDiagonal() * solver.eigenvectors().transpose());
}

}  // namespace

Sym3 exponential_of_large(const Sym3& a) {
    return by_principal_values(a, [](double x) { return std::expm1(x); });
}

Sym3 logarithm_of_large(const Sym3& a) {
    return by_principal_values(a, [](double x) { return std::log1p(x); });
}

SymOf<Double4> each(const SymOf<Double4>& a, Sym3 (*function)(const Sym3&)) {
    Double4 from[6], to[6];
    a.write(from);
    for (int lane = 0; lane < 4; ++lane) {
        double numbers[6];
        for (int n = 0; n < 6; ++n) numbers[n] = from[n][lane];
        function(Sym3::read(numbers)).write(numbers);
        for (int n = 0; n < 6; ++n) to[n][lane] = numbers[n];
    }
    return SymOf<Double4>::read(to);
}

namespace solid {

/// In triaxial compression Mohr and Coulomb's law reads q = p 6 sin(phi) / (3 - sin(phi)), and |s| =
/// sqrt(2/3) q. In plane strain half the difference of the principal stresses is sin(phi) times their mean, and |s| =
/// sqrt(2) times that half.
DruckerPrager DruckerPrager::of(const Elastic& elastic, double friction_angle, double cohesion, Cone cone) {
    expect(friction_angle > 0.0 || cohesion == 0.0, "cohesion of this law needs friction: its cone has an apex");
    const double sine = std::sin(friction_angle);
    const double alpha =
        cone == Cone::compression ? std::sqrt(2.0 / 3.0) * 6.0 * sine / (3.0 - sine) : std::sqrt(2.0) * sine;
    return {elastic, alpha, cohesion > 0.0 ? cohesion / std::tan(friction_angle) : 0.0};
}

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

}  // namespace solid
}  // namespace frana
