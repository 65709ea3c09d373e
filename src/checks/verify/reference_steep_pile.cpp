#include "checks/verify/reference_steep_pile.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_similarity.h"

namespace frana::verify {
namespace {

using Powers = std::vector<std::array<int, 2>>;

/// Monomials a^i b^j up to a total degree, j even or odd: x is even in b, y odd.
Powers monomials(int degree, int parity) {
    Powers list;
    for (int j = parity; j <= degree; j += 2)
        for (int i = 0; i + j <= degree; ++i) list.push_back({i, j});
    return list;
}

/// d-th derivative of t^n.
double power(double t, int n, int d) {
    double factor = 1.0;
    for (int k = 0; k < d; ++k) factor *= n - k;
    return factor == 0.0 ? 0.0 : factor * std::pow(t, n - d);
}

Eigen::RowVectorXd row_of(const Powers& powers, double a, double b, int by_a, int by_b) {
    Eigen::RowVectorXd row(static_cast<Eigen::Index>(powers.size()));
    for (std::size_t k = 0; k < powers.size(); ++k)
        row[static_cast<Eigen::Index>(k)] = power(a, powers[k][0], by_a) * power(b, powers[k][1], by_b);
    return row;
}

Eigen::MatrixXd rows_of(const Powers& powers, const Eigen::VectorXd& a, const Eigen::VectorXd& b, int by_a, int by_b) {
    Eigen::MatrixXd all(a.size(), static_cast<Eigen::Index>(powers.size()));
    for (Eigen::Index n = 0; n < a.size(); ++n) all.row(n) = row_of(powers, a[n], b[n], by_a, by_b);
    return all;
}

/// Points and weights on the unit disc for the weight 1 - r^2: midpoints in r^2, equal angles. The integrands are smooth.
void disc(int radii, int angles, Eigen::VectorXd& a, Eigen::VectorXd& b, Eigen::VectorXd& weight) {
    const Eigen::Index count = static_cast<Eigen::Index>(radii) * angles;
    a.resize(count), b.resize(count), weight.resize(count);
    for (int k = 0; k < radii; ++k)
        for (int n = 0; n < angles; ++n) {
            const double square = (k + 0.5) / radii, r = std::sqrt(square),
                         turn = 2.0 * constants::kPi * (n + 0.5) / angles;
            const Eigen::Index at = static_cast<Eigen::Index>(k) * angles + n;
            a[at] = r * std::cos(turn), b[at] = r * std::sin(turn), weight[at] = 1.0 - square;
        }
}

}  // namespace

struct SteepPile::Local {
    double depth = 0.0;
    Vec2 gradient{0, 0}, velocity{0, 0};
};

SteepPile::SteepPile(const Plane& plane, Form form, int degree, double end, double step)
    : plane_(plane), form_(form), powers_x_(monomials(degree, 0)), powers_y_(monomials(degree, 1)) {
    disc(40, 32, a_, b_, weight_);
    const auto basis = [&](const Powers& p) {
        return Basis{rows_of(p, a_, b_, 0, 0), rows_of(p, a_, b_, 1, 0), rows_of(p, a_, b_, 0, 1),
                     rows_of(p, a_, b_, 2, 0), rows_of(p, a_, b_, 1, 1), rows_of(p, a_, b_, 0, 2)};
    };
    basis_x_ = basis(powers_x_), basis_y_ = basis(powers_y_);
    mass_x_.compute(basis_x_.value.transpose() * weight_.asDiagonal() * basis_x_.value);
    mass_y_.compute(basis_y_.value.transpose() * weight_.asDiagonal() * basis_y_.value);
    const auto none = [](const Powers& p) { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(p.size())); };
    end_ = {none(powers_x_), none(powers_y_), none(powers_x_), none(powers_y_)};
    for (std::size_t k = 0; k < powers_x_.size(); ++k)
        if (powers_x_[k] == std::array<int, 2>{1, 0}) end_.x[static_cast<Eigen::Index>(k)] = plane.length_x;
    for (std::size_t k = 0; k < powers_y_.size(); ++k)
        if (powers_y_[k] == std::array<int, 2>{0, 1}) end_.y[static_cast<Eigen::Index>(k)] = plane.length_y;
    const int steps = static_cast<int>(std::ceil(end / step));
    const double dt = end / steps;
    const auto moved = [](const Motion& from, const Motion& rate, double by) {
        return Motion{from.x + by * rate.x, from.y + by * rate.y, from.u + by * rate.u, from.v + by * rate.v};
    };
    for (int n = 0; n < steps; ++n) {
        const Motion k1 = rate(end_), k2 = rate(moved(end_, k1, 0.5 * dt)), k3 = rate(moved(end_, k2, 0.5 * dt)),
                     k4 = rate(moved(end_, k3, dt));
        end_ = moved(moved(moved(moved(end_, k1, dt / 6), k2, dt / 3), k3, dt / 3), k4, dt / 6);
    }
}

SteepPile::Motion SteepPile::rate(const Motion& now) const {
    Eigen::VectorXd force_x(a_.size()), force_y(a_.size());
    const double fall = weight_.dot(basis_x_.value * now.u) / weight_.sum();
    for (Eigen::Index n = 0; n < a_.size(); ++n) {
        const Local here = local(now, n);
        const Vec2 force = weight_[n] * (form_ == Form::steep ? steep(here) : linearised(here, fall));
        force_x[n] = force.x(), force_y[n] = force.y();
    }
    return {now.u, now.v, mass_x_.solve(basis_x_.value.transpose() * force_x),
            mass_y_.solve(basis_y_.value.transpose() * force_y)};
}

/// Depth by the Jacobian of the map, h = h0 / J, and its gradient by the chain rule.
SteepPile::Local SteepPile::local(const Motion& now, Index n) const {
    const auto x = [&](const Eigen::MatrixXd& d) { return d.row(n).dot(now.x); };
    const auto y = [&](const Eigen::MatrixXd& d) { return d.row(n).dot(now.y); };
    const double xa = x(basis_x_.by_a), xb = x(basis_x_.by_b), ya = y(basis_y_.by_a), yb = y(basis_y_.by_b);
    const double xaa = x(basis_x_.by_aa), xab = x(basis_x_.by_ab), xbb = x(basis_x_.by_bb);
    const double yaa = y(basis_y_.by_aa), yab = y(basis_y_.by_ab), ybb = y(basis_y_.by_bb);
    const double area = plane_.length_x * plane_.length_y, start = plane_.height * weight_[n];
    const double j = xa * yb - xb * ya;
    const double ja = xaa * yb + xa * yab - xab * ya - xb * yaa, jb = xab * yb + xa * ybb - xbb * ya - xb * yab;
    const double ha = area * (-2.0 * plane_.height * a_[n] - start * ja / j) / j;
    const double hb = area * (-2.0 * plane_.height * b_[n] - start * jb / j) / j;
    return {area * start / j, Vec2((yb * ha - ya * hb) / j, (xa * hb - xb * ha) / j),
            Vec2(basis_x_.value.row(n).dot(now.u), basis_y_.value.row(n).dot(now.v))};
}

/// At the start v / fall is what gravity and this friction make it: pull_y / (g cos^2 slope).
Vec2 SteepPile::linearised(const Local& here, double fall) const {
    const double s = plane_.slope, gravity = plane_.gravity / (1.0 + s * s);
    const Vec2 drive(gravity * (s - here.gradient.x() / (1.0 + s * s)), -gravity * here.gradient.y());
    const double aside = fall > 0.0 ? here.velocity.y() / fall : drive.y() / (gravity * s);
    return drive - plane_.friction * gravity * Vec2(1.0, aside);
}

/// At the start friction points against the drive.
Vec2 SteepPile::steep(const Local& here) const {
    const double s = plane_.slope, g = plane_.gravity, cosine = 1.0 / std::sqrt(1.0 + s * s);
    const Vec2 rise = here.gradient - Vec2(s, 0.0);
    const Vec2 drive = -g / (1.0 + std::max(0.0, -s * rise.x())) * rise;
    const Vec2 along = here.velocity.squaredNorm() > 0.0 ? here.velocity : drive;
    const double speed = std::sqrt(along.squaredNorm() + s * s * along.x() * along.x());
    return drive - plane_.friction * g * cosine / speed * along;
}

/// The place of the start that has come to (x, y). Newton's method starts from the linear part of the map.
SteepPile::Place SteepPile::at(double x, double y) const {
    double a = (x - end_.x[0]) / plane_.length_x, b = y / plane_.length_y;
    for (int n = 0; n < 20; ++n) {
        const auto of_x = [&](int da, int db) { return row_of(powers_x_, a, b, da, db).dot(end_.x); };
        const auto of_y = [&](int da, int db) { return row_of(powers_y_, a, b, da, db).dot(end_.y); };
        const double ex = x - of_x(0, 0), ey = y - of_y(0, 0);
        const double xa = of_x(1, 0), xb = of_x(0, 1), ya = of_y(1, 0), yb = of_y(0, 1), j = xa * yb - xb * ya;
        const double step_a = (yb * ex - xb * ey) / j, step_b = (xa * ey - ya * ex) / j;
        a += step_a, b += step_b;
        if (a * a + b * b > 4.0) return {};
        if (std::abs(step_a) + std::abs(step_b) > 1e-13) continue;
        if (a * a + b * b >= 1.0) return {};
        const double depth = plane_.length_x * plane_.length_y * plane_.height * (1.0 - a * a - b * b) / j;
        return {depth, row_of(powers_x_, a, b, 0, 0).dot(end_.u), row_of(powers_y_, a, b, 0, 0).dot(end_.v)};
    }
    return {};
}

double SteepPile::centre() const { return weight_.dot(basis_x_.value * end_.x) / weight_.sum(); }

namespace {

/// L2 of the difference of two depths over that of the first, on a lattice of 2 m.
template <class A, class B>
double apart(const A& first, const B& second) {
    double difference = 0.0, whole = 0.0;
    for (double x = -75.0; x < 125.0; x += 2.0)
        for (double y = -95.0; y < 95.0; y += 2.0) {
            const double one = first(x, y), other = second(x, y);
            difference += (one - other) * (one - other), whole += one * one;
        }
    return std::sqrt(difference / whole);
}

}  // namespace

std::vector<Residual> steep_pile_residuals() {
    constexpr double kEnd = 5.0;
    const double tangent = std::tan(35 * constants::kPi / 180.0), cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
    const SteepPile::Plane plane{tangent, std::tan(25 * constants::kPi / 180.0), 4.0 / cosine, 80.0 * cosine, 80.0,
                                 9.81};
    const SteepPile linear(plane, SteepPile::Form::linearised, 3, kEnd), five(plane, SteepPile::Form::steep, 5, kEnd),
        seven(plane, SteepPile::Form::steep, 7, kEnd);
    const SimilarityPile theory(35, 25, 80, 4);
    const SimilarityPile::Shape shape = theory.shape(kEnd);
    const auto of = [](const SteepPile& pile) { return [&pile](double x, double y) { return pile.at(x, y).depth; }; };
    const auto printed = [&](double x, double y) { return theory.at(shape, x / cosine, y).depth / cosine; };
    return {
        {"linearised, the polynomial map against the similarity solution", apart(printed, of(linear)), 1e-10},
        {"the steep map of degree 5 against degree 7", apart(of(seven), of(five)), 1e-5}};  // 1e-3 of what it measures
}

}  // namespace frana::verify
