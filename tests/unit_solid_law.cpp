// Laws of 3D material against numbers found another way.
#include <Eigen/Eigenvalues>

#include "catch.h"
#include "law/solid/laws.h"

using namespace frana;

namespace {

Mat3 function_of(const Mat3& a, double (*f)(double)) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(a);
    return solver.eigenvectors() * solver.eigenvalues().unaryExpr(f).asDiagonal() * solver.eigenvectors().transpose();
}

double log_of(double x) { return std::log(x); }
double exp_of(double x) { return std::exp(x); }

}  // namespace

TEST_CASE("Elastic strain is carried by any deformation, small or large, to round-off", "[solid]") {
    const double size = GENERATE(1e-6, 1e-3, 4e-3, 0.009, 0.015, 0.02, 0.03, 0.045, 0.1, 0.3);
    const Sym3 e{0.9 * size, -0.5 * size, 0.2 * size, 0.4 * size, -0.7 * size, 0.1 * size};
    Mat3 grown;
    grown << 0.3, -0.8, 0.5, 0.6, -0.2, 0.1, -0.4, 0.7, 0.25;
    grown *= size;
    const Mat3 factor = Mat3::Identity() + grown;
    const Mat3 exact = 0.5 * function_of(factor * function_of(2.0 * e.matrix(), exp_of) * factor.transpose(), log_of);
    CAPTURE(size);
    // The reference itself loses 1e-16 of one, which the series do not.
    CHECK((carried_strain(e, grown).matrix() - exact).cwiseAbs().maxCoeff() < 4e-15);
}

TEST_CASE("Small strains keep their digits", "[solid]") {
    // A stretch along x: ln(1 + g) exactly.
    Mat3 grown = Mat3::Zero();
    grown(0, 0) = 1e-9;
    CHECK(carried_strain({}, grown).xx == Approx(std::log1p(1e-9)).epsilon(1e-14));
}

TEST_CASE("A turned elastic body has the turned stress", "[solid]") {
    const auto law = solid::Elastic::of(1e6, 0.3);
    double state[7] = {1e-3, -2e-3, 5e-4, 3e-4, 0.0, -1e-4, 0.0}, j = 1.0;
    const Mat3 before = law.stress(j, state, Mat3::Zero()).matrix();
    const double a = 0.7;
    const Mat3 turn = (Mat3() << std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1).finished();
    law.update({turn - Mat3::Identity(), 1.0}, j, state);
    CHECK((law.stress(j, state, Mat3::Zero()).matrix() - turn * before * turn.transpose()).norm() <
          1e-11 * before.norm());
    CHECK(j == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("Sand is never stressed beyond Drucker and Prager's cone, and flows without a change of volume", "[solid]") {
    const double phi = 0.5, cohesion = GENERATE(0.0, 300.0);
    const auto law = solid::DruckerPrager::of(solid::Elastic::of(1e6, 0.3), phi, cohesion);
    double state[7] = {-1e-3, -1e-3, -1e-3, 0, 0, 0, 0}, j = std::exp(-3e-3);
    Deformation shear{Mat3::Zero(), 1e-3};
    shear.gradient(0, 1) = 1.0;
    for (int step = 0; step < 20; ++step) law.update(shear, j, state);
    const Sym3 stress = law.stress(j, state, Mat3::Zero());
    const double p = -stress.trace() / 3.0;
    // Triaxial compression of Mohr and Coulomb's law: q = (6 sin(phi) p + 6 c cos(phi)) / (3 - sin(phi)), |s|
    // = sqrt(2/3) q.
    const double q = (6.0 * std::sin(phi) * p + 6.0 * cohesion * std::cos(phi)) / (3.0 - std::sin(phi));
    CHECK(stress.deviator().norm() == Approx(std::sqrt(2.0 / 3.0) * q).epsilon(1e-10));
    CHECK(Sym3::read(state).trace() == Approx(-3e-3).epsilon(1e-9));
}

TEST_CASE("Sand that was drawn apart carries nothing until the gap is closed", "[solid]") {
    const auto law = solid::DruckerPrager::of(solid::Elastic::of(1e6, 0.3), 0.5, 0.0);
    double state[7] = {}, j = 1.0;
    const auto stretch = [&](double rate) {
        Deformation d{Mat3::Zero(), 1.0};
        d.gradient.diagonal().setConstant(rate);
        law.update(d, j, state);
        return -law.stress(j, state, Mat3::Zero()).trace() / 3.0;
    };
    CHECK(stretch(0.01) == 0.0);
    CHECK(stretch(-0.005) == 0.0);
    const double closed = stretch(1.0 / 1.01 / 0.995 - 1.0);  // back to the first volume
    const double bulk = 1e6 / (3.0 * (1.0 - 0.6));
    CHECK(std::abs(closed) < 1e-10 * bulk);
    CHECK(stretch(-1e-3) == Approx(-3.0 * bulk * std::log(1.0 - 1e-3)).epsilon(1e-9));
}

TEST_CASE("Sand that flew far apart carries pressure again once it is pressed", "[solid]") {
    const auto law = solid::DruckerPrager::of(solid::Elastic::of(1e6, 0.3), 0.5, 0.0);
    double state[7] = {}, j = 1.0;
    const auto stretch = [&](double ratio) {
        Deformation d{Mat3::Zero(), 1.0};
        d.gradient.diagonal().setConstant(std::cbrt(ratio) - 1.0);
        law.update(d, j, state);
        return -law.stress(j, state, Mat3::Zero()).trace() / 3.0;
    };
    for (int step = 0; step < 2000; ++step) REQUIRE(stretch(2.0) == 0.0);  // 2^2000 is no number
    CHECK(j == solid::kLoosest);
    CHECK(stretch(1.01 / solid::kLoosest) == 0.0);
    CHECK(stretch(0.99 / 1.01) > 0.0);
}

TEST_CASE("Grains under mu(I) are sheared at Jop's friction, and rest within it", "[solid]") {
    const double rate = GENERATE(0.01, 1.0, 100.0), p = GENERATE(10.0, 1e4);
    CAPTURE(rate, p);
    const solid::MuI law{solid::Elastic::of(1e7, 0.3), 0.38, 0.65, 0.3, 0.01, 0.6, 1600.0};
    const double strain = -p / law.elastic.bulk() / 3.0;
    double state[7] = {strain, strain, strain}, j = std::exp(3.0 * strain);
    Deformation shear{Mat3::Zero(), 1e-3 / rate};
    shear.gradient(0, 2) = rate;
    for (int step = 0; step < 100; ++step) law.update(shear, j, state);
    const double i = rate * 0.01 * std::sqrt(1600.0 / 0.6 / p), mu = 0.38 + 0.27 / (1.0 + 0.3 / i);
    const Sym3 stress = law.stress(j, state, Mat3::Zero());
    CHECK(-stress.trace() / 3.0 == Approx(p).epsilon(1e-9));
    // The spin turns the elastic strain by mu p / G each way: a term of that square. Strains of 1e-6 have ten digits.
    const double turned = mu * p / law.elastic.shear;
    CHECK(stress.deviator().norm() / std::sqrt(2.0) == Approx(mu * p).epsilon(turned * turned + 1e-7));
    // Half of mu_s is carried without flow.
    double resting[7] = {strain, strain, strain, 0.0, 0.0, 0.19 * p / (2.0 * law.elastic.shear), 0.0}, other = j;
    law.update({Mat3::Zero(), 1e-3}, other, resting);
    CHECK(resting[5] == Approx(0.19 * p / (2.0 * law.elastic.shear)).epsilon(1e-12));
}

TEST_CASE("mu(I) with the same friction at any rate is sand as strong in simple shear", "[solid]") {
    const double phi = 0.5, mu = std::tan(phi);
    const auto sand = solid::DruckerPrager::of(solid::Elastic::of(1e6, 0.3), phi, 0.0, solid::Cone::simple_shear);
    const solid::MuI grains{solid::Elastic::of(1e6, 0.3), mu, mu, 0.3, 0.01, 0.6, 1600.0};
    double a[7] = {-1e-3, -1e-3, -1e-3}, b[7] = {-1e-3, -1e-3, -1e-3}, ja = 1.0, jb = 1.0;
    Deformation d{Mat3::Zero(), 1e-3};
    d.gradient << -0.2, 0.9, 0.1, -0.1, 0.1, 0.2, 0.4, 0.0, -0.1;
    for (int step = 0; step < 50; ++step) sand.update(d, ja, a), grains.update(d, jb, b);
    CHECK(sand.stress(ja, a, Mat3::Zero()).deviator().norm() > 0.0);
    for (int k = 0; k < 7; ++k) CHECK(b[k] == Approx(a[k]).epsilon(1e-12).margin(1e-18));
}

TEST_CASE("Bingham's stress below the yield stress is elastic; sheared on, it goes to tau_Y + mu rate", "[solid]") {
    const solid::Bingham law{1e6, 1e5, 50.0, 1000.0};
    double state[7] = {}, j = 1.0;
    Deformation d{Mat3::Zero(), 1e-4};
    d.gradient(0, 2) = 4.0;
    law.update(d, j, state);
    CHECK(law.stress(j, state, d.gradient).xz == Approx(1e5 * 4e-4).epsilon(1e-12));
    for (int step = 0; step < 4000; ++step) law.update(d, j, state);
    const double size = Sym3::read(state).norm() / std::sqrt(2.0);
    // The spin of simple shear turns the elastic part by tau / G: a second-order term.
    CHECK(size == Approx(1000.0 + 50.0 * 4.0).epsilon(1e-3));
}

TEST_CASE("Herschel and Bulkley's stress solves its equation, and with n = 1 is Bingham's", "[solid]") {
    const double n = GENERATE(0.2, 0.5, 1.0, 1.7);
    const solid::HerschelBulkley law{1e6, 1e5, 80.0, n, 1000.0};
    CAPTURE(n);
    for (const double over : {1e-6, 1e-2, 3.0, 500.0, 1e6}) {
        const double dt = 1e-4, s = law.left_of(over, dt);
        CAPTURE(over);
        CHECK(s > 0.0);
        CHECK(s <= over);
        CHECK(s + 1e5 * dt * std::pow(s / 80.0, 1.0 / n) == Approx(over).epsilon(1e-12));
    }
    CHECK(law.left_of(0.0, 1e-4) == 0.0);
    // Sheared on, tau_Y + K rate^n; the spin's second-order term is (tau / G)^2.
    double state[7] = {}, j = 1.0, other[7] = {}, other_j = 1.0;
    Deformation d{Mat3::Zero(), 1e-4};
    d.gradient(0, 2) = 4.0;
    const solid::Bingham bingham{1e6, 1e5, 80.0, 1000.0};
    for (int step = 0; step < 4000; ++step) law.update(d, j, state), bingham.update(d, other_j, other);
    CHECK(Sym3::read(state).norm() / std::sqrt(2.0) == Approx(1000.0 + 80.0 * std::pow(4.0, n)).epsilon(1e-3));
    if (n == 1.0)
        for (int k = 0; k < 6; ++k) CHECK(state[k] == Approx(other[k]).epsilon(1e-11).margin(1e-9));
}

TEST_CASE("What a law stores is the work done on it, as long as nothing flows", "[solid]") {
    Deformation d{Mat3::Zero(), 1e-3};
    d.gradient << -0.02, 0.03, 0.01, -0.01, -0.03, 0.02, 0.04, 0.0, -0.01;
    const auto check = [&](const auto& law) {
        double state[7] = {}, j = 1.0, work = 0.0;
        for (int step = 0; step < 200; ++step) {
            const Sym3 before = law.stress(j, state, d.gradient);
            law.update(d, j, state);
            const Sym3 mean = (before + law.stress(j, state, d.gradient)) * 0.5;
            work += d.dt * contracted(mean, Sym3::of(d.gradient));
        }
        CHECK(law.stored(j, state) > 0.0);
        CHECK(law.stored(j, state) == Approx(work).epsilon(1e-2));  // strains of 1 %
    };
    check(solid::Fluid{1e6, 0.0});
    check(solid::Bingham{1e6, 1e5, 50.0, 1e9});
    check(solid::HerschelBulkley{1e6, 1e5, 50.0, 0.5, 1e9});
    check(solid::Elastic::of(1e6, 0.3));
    check(solid::DruckerPrager::of(solid::Elastic::of(1e6, 0.3), 0.5, 1e9));
    check(solid::MuI{solid::Elastic::of(1e6, 0.3), 1e9, 2e9, 0.3, 0.01, 0.6, 1600.0});
}

TEST_CASE("A fluid's pressure follows its volume and is never a tension", "[solid]") {
    const solid::Fluid law{2e6, 3.0};
    double j = 1.0;
    Deformation d{Mat3::Zero(), 1e-3};
    d.gradient(1, 1) = -2.0;
    law.update(d, j, nullptr);
    CHECK(j == Approx(0.998).epsilon(1e-14));
    CHECK(law.stress(j, nullptr, Mat3::Zero()).yy == Approx(-2e6 * 0.002 * 0.998).epsilon(1e-12));
    d.gradient(1, 1) = 5.0;
    law.update(d, j, nullptr);
    CHECK(j == 1.0);
    CHECK(law.stress(j, nullptr, Mat3::Zero()).yy == 0.0);
}
