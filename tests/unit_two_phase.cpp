// Solids and free water: closed forms of their exchange (numbers V10 to V19 as in the model's specification).
#include <cmath>

#include "catch.h"
#include "law/two_phase.h"

using namespace frana;

namespace {

constexpr double kMc = 900.0, kMu = 500.0, kReduced = kMc * kMu / (kMc + kMu);

/// Two phases with a slip of 2 m/s aslant.
struct TwoPhases {
    Phase c{kMc, {3.0, -1.0}}, u{kMu, {1.8, 0.6}};
    Vec2 momentum() const { return c.mass * c.velocity + u.mass * u.velocity; }
    double kinetic() const { return 0.5 * (c.mass * c.velocity.squaredNorm() + u.mass * u.velocity.squaredNorm()); }
    Vec2 slip() const { return c.velocity - u.velocity; }
    void run(const Exchange& by, double time, int steps) {
        for (int n = 0; n < steps; ++n) exchange(by, time / steps, c, u);
    }
};

}  // namespace

TEST_CASE("V10: slip decays exponentially under linear drag and as a hyperbola under quadratic, in any steps",
          "[two_phase][solver]") {
    const TwoPhases start;
    const double slip = start.slip().norm(), time = 1.3;
    REQUIRE(slip == Approx(2.0).epsilon(1e-14));
    for (const int steps : {1, 7, 100})
        for (const double chi : {0.0, 250.0}) {
            CAPTURE(steps, chi);
            TwoPhases one, two;
            const Exchange linear{400.0, 1, chi}, quadratic{300.0, 2, chi};
            one.run(linear, time, steps), two.run(quadratic, time, steps);
            const double tau = (kReduced + chi) / 400.0, length = (kReduced + chi) / 300.0;
            CHECK((one.slip() - start.slip() * std::exp(-time / tau)).norm() < 1e-13 * slip);
            CHECK((two.slip() - start.slip() / (1.0 + slip * time / length)).norm() < 1e-13 * slip);
            for (const TwoPhases& pair : {one, two})
                CHECK((pair.momentum() - start.momentum()).norm() < 1e-14 * start.momentum().norm());
        }
}

TEST_CASE("V10: when the slip is gone, mu slip^2 / 2 of the kinetic energy is gone, however stiff the drag",
          "[two_phase][solver]") {
    for (const double drag : {1e4, 1e12}) {
        TwoPhases pair;
        const double before = pair.kinetic(), slip = pair.slip().norm();
        pair.run({drag, 1}, 10.0, 1);
        CHECK(pair.slip().norm() < 1e-12);
        CHECK(before - pair.kinetic() == Approx(0.5 * kReduced * slip * slip).epsilon(1e-12));
    }
}

TEST_CASE("V10: drag takes energy and never turns the slip around", "[two_phase][solver]") {
    for (const int power : {1, 2})
        for (const double drag : {1.0, 1e3, 1e7})
            for (const double dt : {1e-3, 1.0, 1e3}) {
                TwoPhases pair;
                const Vec2 slip = pair.slip();
                const double before = pair.kinetic();
                pair.run({drag, power, 100.0}, dt, 1);
                CHECK(pair.kinetic() <= before);
                CHECK(pair.slip().dot(slip) >= 0.0);
                CHECK(pair.slip().norm() <= slip.norm());
            }
}

TEST_CASE("V10: where a force turns a quadratic slip the step is of first order", "[two_phase][solver]") {
    const auto after = [](int steps) {
        TwoPhases pair;
        pair.c.force = {100.0, 900.0};
        pair.run({300.0, 2}, 1.0, steps);
        return pair.slip();
    };
    const Vec2 exact = 2.0 * after(1 << 15) - after(1 << 14);
    const double coarse = (after(16) - exact).norm(), fine = (after(32) - exact).norm(),
                 order = std::log2(coarse / fine);
    CHECK(fine < 0.05);
    CHECK(order > 0.9);
    CHECK(order < 2.2);
}

TEST_CASE("V11: bodies that forces drive apart reach the slip at which drag balances them", "[two_phase][solver]") {
    const double depth = 1.5, flux = 0.0;
    for (const int power : {1, 2})
        for (const double solids : {0.05, 0.3, 0.55}) {
            CAPTURE(power, solids);
            TwoPhaseMaterial m;
            m.power = power;
            const TwoPhaseDrag drag(m);
            const Mixture mixture{solids};
            const double mc = solids * m.solid_density * depth, mu = mixture.fluid() * m.fluid_density * depth;
            const double reduced = mc * mu / (mc + mu);
            // mu (b_c - b_u) = h alpha_c alpha_u (rho_s - rho_f) g, all of it on c
            const double pushed = depth * solids * mixture.fluid() * 1650.0 * m.gravity / reduced;
            Phase c{mc, {0, 0}, {mc * pushed, 0.0}}, u{mu, {0, 0}};
            const Exchange by{depth * drag.unsplit(solids, flux), power};
            const double terminal = drag.grain_speed(mixture, flux);
            const double tau = reduced / by.drag;  // of j = 1
            exchange(by, 0.7 * tau, c, u);
            if (power == 1)
                CHECK(c.velocity.x() - u.velocity.x() == Approx(terminal * -std::expm1(-0.7)).epsilon(1e-12));
            exchange(by, 1e4, c, u);
            CHECK(c.velocity.x() - u.velocity.x() == Approx(terminal).epsilon(1e-9));
        }
}

TEST_CASE("V11: without solid-like drag the slip in still mixture is Richardson and Zaki's", "[two_phase][solver]") {
    TwoPhaseMaterial m;
    m.weighting = 1e6;  // P = 0
    const TwoPhaseDrag drag(m);
    for (const double solids : {0.01, 0.2, 0.4})
        CHECK(drag.grain_speed({solids}, 0.0) ==
              Approx(zanke_velocity(m, 1e-3) * std::pow(1.0 - solids, richardson_zaki(117.6) - 1.0)).epsilon(1e-4));
    CHECK(drag.grain_speed({0.2}, 0.5) - drag.grain_speed({0.2}, 0.0) == Approx(0.5 / 0.8).epsilon(1e-12));
    m.weighting = 1.0;  // then the flux counts twice, whatever the shares
    CHECK(TwoPhaseDrag(m).grain_speed({0.3}, 0.5) - TwoPhaseDrag(m).grain_speed({0.3}, 0.0) ==
          Approx(1.0).epsilon(1e-12));
}

TEST_CASE("Drag split by structure is the unsplit one without structure, and blocks alone where all is structured",
          "[two_phase][solver]") {
    TwoPhaseMaterial m;
    for (const int power : {1, 2}) {
        m.power = power;
        const TwoPhaseDrag drag(m);
        for (const double flux : {0.0, 0.3}) {
            CHECK(drag.coefficient({0.4}, flux) == Approx(drag.unsplit(0.4, flux)).epsilon(1e-14));
            const Mixture blocks{0.4, 1.0, 0.5};  // alpha_c 0.7, alpha_u 0.3
            const double density = (0.4 * 2650.0 + 0.3 * 1000.0) / 0.7;
            CHECK(bound_density(m, blocks) == Approx(density).epsilon(1e-14));
            const double weight = 0.7 * 0.3 * (density - 1000.0) * 9.81;
            const double speed = terminal_velocity(m, m.block) * std::pow(0.3, 2.39 - 1.0) + flux / 0.3;
            CHECK(drag.coefficient(blocks, flux) == Approx(weight / std::pow(speed, power)).epsilon(1e-13));
            // Halfway both count, and the last grains bring no jump.
            const Mixture nearly{0.4, 1.0 - 1e-9, 0.5};
            CHECK(drag.coefficient(nearly, flux) == Approx(drag.coefficient(blocks, flux)).epsilon(1e-6));
            CHECK(drag.coefficient({0.4, 0.5, 0.25}, flux) > 0.0);
        }
    }
    // Unsplit, it is that of grains in all of the water, whatever holds together.
    TwoPhaseMaterial whole = m;
    whole.split = false;
    for (const double structured : {0.0, 0.5, 1.0})
        CHECK(TwoPhaseDrag(whole).coefficient({0.4, structured, 0.25}, 0.3) == TwoPhaseDrag(whole).unsplit(0.4, 0.3));
    // S_p of a mixture with structure: P / alpha_c + (1 - P) / alpha_u
    const TwoPhaseDrag drag(m);
    const double p = 0.2 / 0.65;
    CHECK(drag.grain_speed({0.4, 0.5, 0.25}, 0.3) - drag.grain_speed({0.4, 0.5, 0.25}, 0.0) ==
          Approx((p / 0.55 + (1.0 - p) / 0.45) * 0.3).epsilon(1e-12));
    // F of (32), by its own numbers: gamma / 180 (alpha_u / grains)^3 Re
    m.power = 1, m.weighting = 1e-9;  // P = 1
    const TwoPhaseDrag solid_like(m);
    const double ut = terminal_velocity(m, m.grain), re = 1000.0 * 1e-3 * ut / 1e-3, ratio = 0.6 * 0.75 / (0.4 * 0.5);
    CHECK(solid_like.grain_speed({0.4, 0.5, 0.25}, 0.0) ==
          Approx(ut * (1000.0 / 2650.0 / 180.0) * ratio * ratio * ratio * re).epsilon(1e-6));
}

TEST_CASE("V12: an impulse on the solids moves the water at once by its virtual mass", "[two_phase][solver]") {
    const double chi = 300.0, force = 7.0, dt = 1e-6;
    Phase c{kMc, {0, 0}, {force, 0}}, u{kMu, {0, 0}};
    exchange({50.0, 1, chi}, dt, c, u);
    const double all = kMc * kMu + chi * (kMc + kMu);
    CHECK(c.velocity.x() / dt == Approx(force * (kMu + chi) / all).epsilon(1e-6));
    CHECK(u.velocity.x() / dt == Approx(force * chi / all).epsilon(1e-6));
    TwoPhaseMaterial m;
    const Mixture mixture{0.4, 0.0, 0.25};  // alpha_c 0.55, alpha_u 0.45
    CHECK(virtual_mass_number(VirtualMass::unbounded, m, mixture) == Approx(0.5 * 2.1 / 0.45).epsilon(1e-14));
    CHECK(virtual_mass(VirtualMass::unbounded, m, mixture, 2.0) ==
          Approx(0.55 * 1000.0 * 0.5 * 2.1 / 0.45 * 2.0).epsilon(1e-14));
    const double gamma = 0.55 / (0.4 * 2.65 + 0.15);
    CHECK(virtual_mass_number(VirtualMass::bounded, m, mixture) ==
          Approx((10.0 * 0.67 - 1.0) / (0.55 / 0.45 + gamma)).epsilon(1e-13));
    CHECK(virtual_mass_number(VirtualMass::bounded, m, {0.999999}) < 1e-4);
    CHECK(virtual_mass(VirtualMass::none, m, mixture, 2.0) == 0.0);
}

TEST_CASE("A phase without mass goes with the other, and two without stay", "[two_phase][solver]") {
    Phase c{2.0, {1.0, 0.0}, {4.0, 0.0}}, u{0.0, {9.0, 9.0}};
    exchange({5.0, 2}, 0.5, c, u);
    CHECK(c.velocity == Vec2(2.0, 0.0));
    CHECK(u.velocity == c.velocity);
    Phase a{0.0, {1.0, 2.0}}, b{0.0, {3.0, 4.0}};
    exchange({5.0, 1}, 0.5, a, b);
    CHECK((a.velocity == Vec2(1.0, 2.0) && b.velocity == Vec2(3.0, 4.0)));
}

TEST_CASE("V19: settling speeds of quartz in water", "[two_phase][solver]") {
    const TwoPhaseMaterial m;
    CHECK(zanke_velocity(m, 1e-4) == Approx(7.79e-3).epsilon(1e-3));
    CHECK(zanke_velocity(m, 5e-4) == Approx(0.0722).epsilon(1e-3));
    CHECK(zanke_velocity(m, 1e-3) == Approx(0.1176).epsilon(1e-3));
    CHECK(zanke_velocity(m, 1e-2) == Approx(0.401).epsilon(2e-3));
    CHECK(stokes_velocity(m, 1e-4) == Approx(8.99e-3).epsilon(1e-3));
    CHECK(terminal_velocity(m, 0.99e-4) == stokes_velocity(m, 0.99e-4));
    CHECK(terminal_velocity(m, 1e-4) == zanke_velocity(m, 1e-4));
    CHECK(zanke_velocity(m, 1e-6) / stokes_velocity(m, 1e-6) == Approx(0.9).epsilon(1e-6));
    CHECK(zanke_velocity(m, 1.0) == Approx(std::sqrt(1.65 * 9.81)).epsilon(1e-4));
    CHECK(richardson_zaki(0.1) == 4.65);
    CHECK(richardson_zaki(0.5) == Approx(4.4414).epsilon(1e-4));
    CHECK(richardson_zaki(100.0) == Approx(2.8078).epsilon(1e-4));
    CHECK(richardson_zaki(1e4) == 2.39);
}

TEST_CASE("Buoyancy, what rests on the bed, and the viscosity of mud", "[two_phase][solver]") {
    const TwoPhaseMaterial m;
    CHECK((buoyancy(1000.0, 9.0, 0.5, {0.1, -0.2}) - Vec2(-450.0, 900.0)).norm() < 1e-10);
    const double normal_gravity = 9.0, depth = 2.0;
    CHECK(basal_stress(m, {0.4}, normal_gravity, depth, 0.0) == Approx(0.4 * 1650.0 * 18.0).epsilon(1e-14));
    const Mixture blocks{0.4, 1.0, 0.5};
    CHECK(basal_stress(m, blocks, normal_gravity, depth, 1.0) == Approx(0.4 * 1650.0 * 18.0).epsilon(1e-13));
    CHECK(basal_stress(m, blocks, normal_gravity, depth, 0.0) ==
          Approx((0.4 * 2650.0 + 0.3 * 1000.0) * 18.0).epsilon(1e-13));
    CHECK(mud_viscosity(3.6e-3, 22.1, 0.4) == Approx(3.6e-3 * std::exp(8.84)).epsilon(1e-14));
    CHECK(mud_viscosity(1e-4, 6.0, 0.0) == 1e-3);
}
