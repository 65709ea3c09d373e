#include "law/strain.h"

#include <Eigen/Eigenvalues>

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

}  // namespace frana
