#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"
#include "law/bed/laws.h"
#include "law/rheology/laws.h"

using namespace frana;

namespace {
BedState flat(double thickness, double density = 1000.0) { return {9.81, thickness, 1.0, 1.0, 9.81, density}; }
constexpr double kRoundOff = 1e-12;
}  // namespace

TEST_CASE("Coulomb friction takes mu g dt off the driven speed and stops exactly", "[law]") {
    const bed::Coulomb law{0.4};
    CHECK(law.speed_after(flat(1.0), 3.0, 3.0, 0.1) == Approx(3.0 - 0.4 * 9.81 * 0.1).epsilon(kRoundOff));
    CHECK(law.speed_after(flat(1.0), 0.0, 0.39, 0.1) == 0.0);
    CHECK(law.speed_after(flat(1.0), 0.1, 0.1, 0.1) == 0.0);
}

TEST_CASE("Voellmy friction follows tanh from rest and holds its terminal speed", "[law]") {
    const bed::Voellmy law{0.2, 1000.0};
    const double drive = 5.0, net = drive - 0.2 * 9.81, terminal = std::sqrt(net * 1000.0 * 2.0 / 9.81);
    double speed = 0.0;
    const double dt = 0.25;
    for (int step = 1; step <= 400; ++step) {
        speed = law.speed_after(flat(2.0), speed, speed + drive * dt, dt);
        // exact for a constant drive, so only round-off of 400 steps may stand between
        REQUIRE(speed == Approx(terminal * std::tanh(net * dt * step / terminal)).epsilon(1e-12));
    }
}

TEST_CASE("A decelerating Voellmy block follows tan and stops within the step that holds its end", "[law]") {
    const bed::Voellmy law{0.3, 500.0};
    const double coulomb = 0.3 * 9.81, quadratic = 9.81 / (500.0 * 1.0);
    const double scale = std::sqrt(coulomb / quadratic), rate = std::sqrt(coulomb * quadratic);
    const double end = std::atan(10.0 / scale) / rate;
    double speed = 10.0, time = 0.0;
    while (speed > 0.0) {
        speed = law.speed_after(flat(1.0), speed, speed, 0.05);
        time += 0.05;
        if (speed > 0.0)
            REQUIRE(speed == Approx(scale * std::tan(rate * (end - time))).epsilon(1e-10));  // round-off of tan near 0
    }
    CHECK(time - end < 0.05);
    CHECK(time >= end);
    for (const double dt : {0.5, 1.5, 2.5})  // one long step is as exact
        CHECK(law.speed_after(flat(1.0), 10.0, 10.0, dt) == Approx(scale * std::tan(rate * (end - dt))).epsilon(1e-12));
    CHECK(law.speed_after(flat(1.0), 10.0, 10.0, 1.001 * end) == 0.0);
}

TEST_CASE("The series of tanh(sqrt(x)) / sqrt(x) is right to round-off as far as it is used, on either side", "[law]") {
    for (const double x : {0.0, 1e-6, 1e-3, 3e-3, 7e-3, 0.999 * kTangentSeries})
        for (const double signed_x : {x, -x}) {
            CAPTURE(signed_x);
            // root, tan and quotient: three roundings, the first halved by its root's slope; the next term adds 1.5e-17
            CHECK(tangent_series(signed_x) == Approx(tangent_ratio(signed_x)).epsilon(1e-15));
        }
}

TEST_CASE("The fraction of tanh(sqrt(x)) / sqrt(x) is right to round-off as far as it is used, on either side",
          "[law]") {
    for (const double x : {0.0, kTangentSeries, 0.1, 0.3, 0.7, 0.999 * kTangentFraction})
        for (const double signed_x : {x, -x}) {
            CAPTURE(signed_x);
            // As above, and two polynomials and a quotient; the convergent itself is 9e-17 off at the end.
            CHECK(tangent_fraction(signed_x) == Approx(tangent_ratio(signed_x)).epsilon(2e-15));
        }
}

TEST_CASE("No law speeds a node up or turns it round", "[law]") {
    const BedLaw laws[] = {bed::Coulomb{0.5}, bed::Voellmy{0.1, 300.0}, bed::Manning{0.1, 0.05},
                           bed::Bingham{100.0, 500.0, 0.1}, bed::Pouliquen{}};
    for (const BedLaw& law : laws)
        for (const double thickness : {1e-9, 1e-3, 1.0, 100.0})
            for (const double driven : {0.0, 1e-12, 0.1, 30.0})
                for (const double before : {0.0, 0.05, 40.0})
                    for (const double dt : {1e-6, 0.1, 10.0})
                        std::visit(
                            [&](const auto& chosen) {
                                const double s0 = std::min(before, driven);
                                const double speed = chosen.speed_after(flat(thickness), s0, driven, dt);
                                CAPTURE(law.index(), thickness, driven, s0, dt, speed);
                                CHECK(speed >= 0.0);
                                CHECK(speed <= driven * (1.0 + 1e-14));  // one rounding
                            },
                            law);
}

TEST_CASE("The Bingham closure inverts |v| = tau_B h / (6 mu) (2 + zeta)(1 - zeta)^2", "[law]") {
    const double mu = 20.0, tau_y = 50.0, h = 0.4;
    for (const double zeta : {1e-6, 0.05, 0.3, 0.7, 0.95, 1.0 - 1e-7}) {
        const double y = 1.0 - zeta;
        const double speed = tau_y / zeta * h / (6.0 * mu) * (2.0 + zeta) * y * y;
        const bed::SheetShares sheet = bed::bingham_sheet(0.0, 6.0 * mu * speed / (tau_y * h));
        CHECK(sheet.plug == Approx(zeta).epsilon(1e-14));
        CHECK(sheet.sheared == Approx(y).epsilon(1e-14));  // to full precision at rest too
    }
    CHECK(bed::bingham_sheet(0.0, 0.0).plug == 1.0);
    CHECK(bed::bingham_sheet(1e9, 0.0).sheared == 0.0);
}

TEST_CASE("Both shares of a Bingham sheet satisfy their cubic to round-off, from rest to a Newtonian sheet", "[law]") {
    for (double b = 1e-12; b < 1e13; b *= 10.0)
        for (double d = 1e-18; d < 1e13; d *= 10.0) {
            const auto [z, y] = bed::bingham_sheet(b, d);
            CAPTURE(b, d, z, y);
            // The smaller share solves a well-conditioned equation; the other is one less it.
            const double of_y = (3.0 * y * y - y * y * y) + (b + d) * y - d,
                         of_z = z * z * z - (3.0 + b + d) * z + 2.0 + b;
            REQUIRE((y <= 0.5 ? std::abs(of_y) / d : std::abs(of_z) / (2.0 + b)) < 1e-15);
            REQUIRE(z + y == Approx(1.0).epsilon(1e-15));
            REQUIRE(z > 0.0);
            REQUIRE(y > 0.0);
        }
}

TEST_CASE("A Newtonian sheet relaxes exactly, whatever the step", "[law]") {
    const bed::Bingham law{500.0, 0.0, 0.0};
    const double h = 0.5, rho = 1500.0, drive = 2.0, rate = 3.0 * law.viscosity / (rho * h * h);
    for (const double dt : {0.01, 0.3, 5.0}) {
        double speed = 3.0;
        for (int step = 1; step <= 20; ++step) {
            speed = law.speed_after(flat(h, rho), speed, speed + dt * drive, dt);
            const double terminal = drive / rate;
            REQUIRE(speed == Approx(terminal + (3.0 - terminal) * std::exp(-rate * dt * step)).epsilon(1e-13));
        }
    }
}

namespace {
/// Speed of a sheet under a constant drive after `time`, in `steps` steps.
template <class Law>
double sheet_speed(const Law& law, const BedState& bed, double start, double drive, double time, int steps) {
    const double dt = time / steps;
    double speed = start;
    for (int step = 0; step < steps; ++step) speed = law.speed_after(bed, speed, speed + dt * drive, dt);
    return speed;
}

/// Order of the error at `time`, from 64 and 128 steps against many.
template <class Law>
double sheet_order(const Law& law, const BedState& bed, double start, double drive, double time) {
    const double exact = sheet_speed(law, bed, start, drive, time, 100000);
    return std::log2(std::abs((sheet_speed(law, bed, start, drive, time, 64) - exact) /
                              (sheet_speed(law, bed, start, drive, time, 128) - exact)));
}
}  // namespace

TEST_CASE("Bingham and mu(I) sheets relax with third order, speeding up and slowing down", "[law]") {
    const bed::Bingham mud{1000.0, 300.0, 0.0};
    CHECK(sheet_order(mud, flat(1.0, 1500.0), 0.1, 2.5, 0.8) > 2.7);
    CHECK(sheet_order(mud, flat(1.0, 1500.0), 3.0, 0.8, 0.8) > 2.7);
    const bed::Pouliquen grains{0.38, 0.65, 0.3, 1e-3, 0.6};
    CHECK(sheet_order(grains, flat(0.02), 0.1, 4.7, 0.5) > 2.7);
    CHECK(sheet_order(grains, flat(0.02), 1.5, 4.7, 0.5) > 2.7);
}

// Friction that grows with speed brings any two speeds under the same drive closer together. A step that does the contrary feeds
// on round-off (a film that came to rest in a gully swung across it, ten times as far from step to step).
TEST_CASE("No step of friction parts two speeds under the same drive", "[law]") {
    const BedLaw laws[] = {bed::Coulomb{0.5},
                           bed::Voellmy{0.1, 300.0},
                           bed::Manning{0.1, 0.05},
                           bed::Bingham{1000.0, 300.0, 0.0},
                           bed::Bingham{10.0, 1e-3, 0.2},
                           bed::Bingham{0.0, 300.0, 0.0},
                           bed::Pouliquen{},
                           bed::Pouliquen{0.03, 0.056, 0.3, 0.2, 0.6}};
    const double step = 1e-5;  // of a speed; differences are good to about round-off over it
    for (const BedLaw& law : laws)
        for (double thickness = 1e-4; thickness < 20.0; thickness *= 3.1)
            for (double slow = 1e-9; slow < 20.0; slow *= 2.3)
                for (double drive = 1e-3; drive < 30.0; drive *= 1.9)
                    for (const double dt : {1e-3, 0.07, 1.0})
                        std::visit(
                            [&](const auto& chosen) {
                                const double fast = slow * (1.0 + step);
                                const double a = chosen.speed_after(flat(thickness), slow, slow + dt * drive, dt);
                                const double b = chosen.speed_after(flat(thickness), fast, fast + dt * drive, dt);
                                CAPTURE(law.index(), thickness, slow, drive, dt, a, b);
                                REQUIRE(std::abs(b - a) <=
                                        (fast - slow) * (1.0 + 1e-4) + 8.0 * (slow + dt * drive) * 2.3e-16);
                            },
                            law);
}

TEST_CASE("A Bingham sheet reaches its uniform speed and yields exactly", "[law]") {
    const bed::Bingham law{1000.0, 300.0, 0.0};
    const double h = 1.0, rho = 1500.0, drive = 9.81 * std::sin(0.26), shear = rho * drive * h;
    const double plug = law.yield_stress / shear;  // share of the depth that does not shear
    const double exact = shear * h / (3.0 * law.viscosity) * (1 - plug) * (1 - plug) * (1 + 0.5 * plug);
    double speed = 0.0;
    for (int step = 0; step < 2000; ++step) speed = law.speed_after(flat(h, rho), speed, speed + 0.1 * drive, 0.1);
    CHECK(speed == Approx(exact).epsilon(1e-12));  // the fixed point of backward Euler is the exact one
    const double just_below = law.yield_stress / (rho * h) * 0.1;
    CHECK(law.speed_after(flat(h, rho), 0.0, just_below * (1 - 1e-12), 0.1) == 0.0);
    CHECK(law.speed_after(flat(h, rho), 0.0, just_below * 1.01, 0.1) > 0.0);
}

TEST_CASE("A mu(I) sheet reaches Bagnold's mean speed", "[law]") {
    const double slope = 26.0 * constants::kPi / 180.0;
    const bed::Pouliquen law{std::tan(21.0 * constants::kPi / 180.0), std::tan(33.0 * constants::kPi / 180.0), 0.3,
                             1e-3, 0.6};
    BedState bed{9.81 * std::cos(slope), 0.02, 1.0, std::cos(slope), 9.81, 1500.0};
    double speed = 0.0;
    for (int step = 0; step < 20000; ++step)
        speed = law.speed_after(bed, speed, speed + 1e-3 * 9.81 * std::sin(slope), 1e-3);
    CHECK(speed == Approx(0.50154241).epsilon(1e-7));  // computed from the closed form to eight digits
}

TEST_CASE("The plug's share from three Newton steps is the cubic's root to round-off", "[law]") {
    for (double d = 1e-18; d < 1e15; d *= 7.0) {
        CAPTURE(d);
        const double exact = bed::bingham_sheet(0.0, d).plug;
        // Five roundings of numbers near one, divided by a slope of the equation that is small only with its terms.
        CHECK(rheology::plug_share(d) == Approx(exact).margin(1e-15).epsilon(0.0));
    }
    CHECK(rheology::plug_share(0.0) == 1.0);
}

TEST_CASE("Bingham stress in plane strain equals 2 mu eps plus the yield stress over sqrt(I2)", "[law]") {
    const rheology::Bingham law{10.0, 100.0};
    const Plane rate{0.3, -0.3, 0.4};  // no vertical part, at rest no vertical shear: I2 = 0.09 + 0.16
    const Plane sigma = law.stress(StrainState<double>{rate, 0.0, 0.0, 1e9});
    CHECK(sigma.xx == Approx((20.0 + 100.0 / 0.5) * 0.3).epsilon(kRoundOff));
    CHECK(sigma.xy == Approx((20.0 + 100.0 / 0.5) * 0.4).epsilon(kRoundOff));
    const Plane capped = law.stress(StrainState<double>{rate, 0.0, 0.0, 7.0});
    CHECK(capped.yy == Approx(-7.0 * 0.3).epsilon(kRoundOff));
}

TEST_CASE("On a slope every law holds its steady speed along the bed", "[law]") {
    const double kappa = 1.25, h = 0.8, rho = 1500.0, normal = 6.0, g = 9.81;
    const BedState bed{normal, h, kappa, 0.8, g, rho};
    for (const double dt : {0.01, 1.0, 100.0}) {
        CAPTURE(dt);
        const auto keeps = [&](const auto& law, double along,
                               double drive) {  // the speed along the map is 1 / kappa of it
            const double speed = along / kappa;
            CHECK(law.speed_after(bed, speed, speed + dt * drive, dt) == Approx(speed).epsilon(kRoundOff));
        };
        // tau / (rho h), along the map 1 / kappa of it, is what the drive must make up for
        keeps(bed::Voellmy{0.2, 400.0}, 7.0, 0.2 * normal + g * 7.0 * 7.0 / (400.0 * h * kappa));
        keeps(bed::Manning{0.05, 0.2}, 7.0, 0.2 * normal + g * 0.05 * 0.05 * 7.0 * 7.0 / (h * std::cbrt(h) * kappa));
        const double zeta = 0.4, bed_stress = 300.0 / zeta, mu = 40.0;
        keeps(bed::Bingham{mu, 300.0, 0.1}, bed_stress * h / (6.0 * mu) * (2.0 + zeta) * (1.0 - zeta) * (1.0 - zeta),
              0.1 * normal + bed_stress / (rho * h * kappa));
        const bed::Pouliquen grains{0.38, 0.65, 0.3, 2e-3, 0.6};
        const double inertial = 0.2, friction = 0.38 + (0.65 - 0.38) / (0.3 / inertial + 1.0);
        keeps(grains, inertial * 2.0 * h * std::sqrt(0.6 * g * 0.8 * h) / (5.0 * 2e-3), friction * normal);
        const double plastic = 5.0 - dt * 300.0 / (rho * h * kappa);
        CHECK(bed::Bingham{0.0, 300.0, 0.0}.speed_after(bed, 5.0, 5.0, dt) ==
              Approx(std::max(plastic, 0.0)).epsilon(kRoundOff));
    }
}

TEST_CASE("Bingham stress of a moving sheet has its vertical part and its vertical shear in I2", "[law]") {
    const rheology::Bingham law{10.0, 100.0};
    const Plane rate{0.3, 0.1, 0.4};
    const double speed = 2.0, depth = 0.5, zeta = bed::bingham_sheet(0.0, 6.0 * 10.0 * speed / (100.0 * depth)).plug;
    const double shear = 3.0 / (2.0 + zeta) * speed / depth;
    const double i2 = 0.5 * (0.09 + 0.01 + 0.16) + 0.16 + 0.25 * shear * shear;
    const Plane sigma = law.stress(StrainState<double>{rate, speed / depth, 0.0, 1e9});
    CHECK(sigma.xx == Approx((20.0 + 100.0 / std::sqrt(i2)) * 0.3).epsilon(kRoundOff));
    CHECK(sigma.yy == Approx((20.0 + 100.0 / std::sqrt(i2)) * 0.1).epsilon(kRoundOff));
}

TEST_CASE("Newtonian stress is 2 mu eps, capped", "[law]") {
    const Plane rate{0.3, -0.1, 0.4};
    for (const double cap : {1e9, 7.0}) {
        const double factor = std::min(20.0, cap);
        const StrainState<double> state{rate, 4.0, 0.0, cap};
        CHECK(rheology::Newtonian{10.0}.stress(state).xy == Approx(factor * 0.4).epsilon(kRoundOff));
        CHECK(rheology::Bingham{10.0, 0.0}.stress(state).yy == Approx(factor * -0.1).epsilon(kRoundOff));
    }
}
