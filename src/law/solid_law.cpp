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

/// Product of matrices that share their principal axes: symmetric again.
Sym3 times(const Sym3& a, const Sym3& b) {
    return {a.xx * b.xx + a.xy * b.xy + a.xz * b.xz, a.xy * b.xy + a.yy * b.yy + a.yz * b.yz,
            a.xz * b.xz + a.yz * b.yz + a.zz * b.zz, a.xx * b.xy + a.xy * b.yy + a.xz * b.yz,
            a.xy * b.xz + a.yy * b.yz + a.yz * b.zz, a.xx * b.xz + a.xy * b.yz + a.xz * b.zz};
}

Sym3 inverse(const Sym3& a) {
    const double xx = a.yy * a.zz - a.yz * a.yz, xy = a.xz * a.yz - a.xy * a.zz,
                 xz = a.xy * a.yz - a.xz * a.yy;
    return Sym3{xx, a.xx * a.zz - a.xz * a.xz, a.xx * a.yy - a.xy * a.xy, xy, a.xy * a.xz - a.xx * a.yz, xz} *
           (1.0 / (a.xx * xx + a.xy * xy + a.xz * xz));
}

constexpr double kSmall =
    0.02;  ///< largest entry that the series below take to round-off: principal values up to 0.06

bool small(const Sym3& a) {
    return std::max({std::abs(a.xx), std::abs(a.yy), std::abs(a.zz), std::abs(a.xy), std::abs(a.yz),
                     std::abs(a.xz)}) <= kSmall;
}

/// exp(a) - I: the first term left out is below 0.06^9 / 9! < 1e-16.
Sym3 exponential(const Sym3& a) {
    if (!small(a)) return by_principal_values(a, [](double x) { return std::expm1(x); });
    Sym3 sum = a * (1.0 / 8.0);
    for (int n = 7; n >= 1; --n) sum = times(a, sum.plus_isotropic(1.0)) * (1.0 / n);
    return sum;
}

/// ln(I + a) = 2 artanh(z), z = a (a + 2 I)^-1: the first term left out is below 0.03^11 / 11 < 1e-16 of the
/// first.
Sym3 logarithm(const Sym3& a) {
    if (!small(a)) return by_principal_values(a, [](double x) { return std::log1p(x); });
    const Sym3 z = times(a, inverse(a.plus_isotropic(2.0))), z2 = times(z, z);
    Sym3 sum = z2 * (1.0 / 9.0);
    for (int n = 7; n >= 3; n -= 2) sum = times(z2, sum.plus_isotropic(1.0 / n));
    return times(z, sum.plus_isotropic(1.0)) * 2.0;
}

/// The stress-like state turned with the spin, W = (L - L^T) / 2: s + dt (W s - s W).
Sym3 spun(const Sym3& s, const Deformation& d) {
    const Mat3 spin = 0.5 * d.dt * (d.gradient - d.gradient.transpose()), m = s.matrix();
    return Sym3::of(m + spin * m - m * spin);
}

}  // namespace

/// With F = I + g: F (I + b) F^T - I = b + g (I + b) + (g (I + b))^T + g (I + b) g^T, small numbers among
/// themselves.
Sym3 carried_strain(const Sym3& e, const Mat3& grown) {
    const Mat3 b = exponential(e * 2.0).matrix(), gb = grown + grown * b;
    return logarithm(Sym3::of(b + gb + gb.transpose() + gb * grown.transpose())) * 0.5;
}

namespace solid {

void Fluid::update(const Deformation& d, double& j, double*) const {
    j = std::fmin(1.0, j * (1.0 + d.dt * d.gradient.trace()));
}

/// Elastic trial, then flow: of the stress beyond the yield stress what a viscous element in series leaves
/// after dt.
void Bingham::update(const Deformation& d, double& j, double* state) const {
    j = std::fmin(1.0, j * (1.0 + d.dt * d.gradient.trace()));
    const Sym3 trial = spun(Sym3::read(state), d) + Sym3::of(d.gradient).deviator() * (2.0 * shear * d.dt);
    const double size = trial.norm() / std::sqrt(2.0);
    double kept = 1.0;
    if (size > yield_stress) {
        const double relaxation = viscosity / (shear * d.dt);
        kept = (size * relaxation + yield_stress) / ((1.0 + relaxation) * size);
    }
    (trial * kept).deviator().write(state);
}

void Elastic::update(const Deformation& d, double& j, double* state) const {
    const Mat3 grown = d.dt * d.gradient;
    carried_strain(Sym3::read(state), grown).write(state);
    j *= (Mat3::Identity() + grown).determinant();
}

/// In triaxial compression Mohr and Coulomb's law reads q = p 6 sin(phi) / (3 - sin(phi)), and |s| =
/// sqrt(2/3) q; in plane strain half the difference of the principal stresses is sin(phi) times their mean,
/// and |s| = sqrt(2) times that half.
DruckerPrager DruckerPrager::of(const Elastic& elastic, double friction_angle, double cohesion, Cone cone) {
    expect(friction_angle > 0.0 || cohesion == 0.0,
           "cohesion of this law needs friction: its cone has an apex");
    const double sine = std::sin(friction_angle);
    const double alpha =
        cone == Cone::compression ? std::sqrt(2.0 / 3.0) * 6.0 * sine / (3.0 - sine) : std::sqrt(2.0) * sine;
    return {elastic, alpha, cohesion > 0.0 ? cohesion / std::tan(friction_angle) : 0.0};
}

void DruckerPrager::update(const Deformation& d, double& j, double* state) const {
    const Mat3 grown = d.dt * d.gradient;
    const double bulk = elastic.lambda + 2.0 / 3.0 * elastic.shear;
    const Sym3 trial = carried_strain(Sym3::read(state), grown);
    j *= (Mat3::Identity() + grown).determinant();
    const double gained = state[6], volume = trial.trace() + gained;
    const double apex = tension / bulk;  // the volume strain at which nothing is carried any more
    if (volume >= apex) {
        Sym3{apex / 3.0, apex / 3.0, apex / 3.0, 0.0, 0.0, 0.0}.write(state);
        state[6] = volume - apex;
        return;
    }
    const Sym3 shear_strain = trial.deviator();
    const double size = 2.0 * elastic.shear * shear_strain.norm();
    const double strength = alpha * bulk * (apex - volume);
    const double kept = size > strength ? strength / size : 1.0;
    (shear_strain * kept).plus_isotropic(volume / 3.0).write(state);
    state[6] = 0.0;
}

}  // namespace solid
}  // namespace frana
