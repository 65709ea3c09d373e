// The law of structured particles against closed forms. Angles in degrees, stress in Pa, tension positive.
#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <random>
#include <tuple>

#include "base/constants.h"
#include "catch.h"
#include "checks/verify/strained_particle.h"
#include "law/structured_law.h"

using namespace frana;
using namespace frana::verify;

namespace {

constexpr double kDegree = constants::kPi / 180.0;
/// The return stops within 1e-7 of strength and weight (structured_law.cpp), which the cone's slope makes a few times more.
constexpr double kReturned = 1e-6;

double q_of(const StructuredStress& s) {
    const double mean = (s.xx + s.yy + s.zz) / 3.0;
    return std::sqrt(0.5 * (std::pow(s.xx - mean, 2) + std::pow(s.yy - mean, 2) + std::pow(s.zz - mean, 2)) +
                     s.xy * s.xy);
}

}  // namespace

TEST_CASE("V1: a particle that turns takes its stress along, in any number of steps", "[structured]") {
    const int steps = GENERATE(1, 50, 500, 5000);
    const StructuredLaw law(unbroken_clay(28.0));
    const double angle = 2.0 * constants::kPi + 0.6;
    StructuredState state;
    state.stress = {3e3, -5e3, -2e3, 1e3};
    const StructuredStress s = strained(law, steps, {0, 0, 0, angle / steps}, -2e3, 1e9, state).stress;
    const double c = std::cos(angle), d = std::sin(angle);
    CAPTURE(steps);
    // Round-off of so many turns.
    const double bound = 6.5e3 * 4e-16 * (steps + 10);
    CHECK(std::abs(s.xx - (c * c * 3e3 - 2 * c * d * 1e3 - d * d * 5e3)) < bound);
    CHECK(std::abs(s.yy - (d * d * 3e3 + 2 * c * d * 1e3 - c * c * 5e3)) < bound);
    CHECK(std::abs(s.xy - (c * d * 8e3 + (c * c - d * d) * 1e3)) < bound);
    CHECK(s.zz == -2e3);
}

TEST_CASE("V2: strain along one axis is Hooke's with the weight given", "[structured]") {
    const StructuredLaw law(unbroken_clay(28.0));
    const double e = 1e-3, young = 5e6, nu = 0.3;
    const StructuredStress held = strained(law, 1, {e, 0, 0, 0}, 0.0, 1e9).stress;
    CHECK(held.xx == Approx(young / (1 - nu * nu) * e).epsilon(1e-14));
    CHECK(held.yy == Approx(nu * held.xx).epsilon(1e-14));
    CHECK(held.zz == 0.0);
    const StructuredStress free = strained(law, 1, {e, -nu * e, 0, 0}, 0.0, 1e9).stress;
    CHECK(free.xx == Approx(young * e).epsilon(1e-14));
    CHECK(std::abs(free.yy) < 1e-12 * young * e);
    // More weight pushes sideways where nothing can give way.
    const StructuredStress loaded = strained(law, 1, {}, -700.0, 1e9).stress;
    CHECK(loaded.xx == Approx(-700.0 * nu / (1 - nu)).epsilon(1e-14));
}

TEST_CASE("V3: elastic simple shear: G sin(gamma), G (1 - cos(gamma)), of second order in the step", "[structured]") {
    double before = 0.0;
    for (const int steps : {100, 1000}) {
        const ShearError error = jaumann_shear_error(2.0, steps);
        CHECK(std::abs(error.along + error.across) < 1e-10);  // round-off of so many steps
        if (before > 0.0)
            CHECK(before / error.size() == Approx(100.0).epsilon(0.02));
        else
            CHECK(error.size() < 1e-4);  // a first-order return gives 1.4e-2 here
        before = error.size();
    }
}

TEST_CASE("V4: simple shear under a pressure goes to k + 3 alpha p and keeps its mean stress", "[structured]") {
    const double p = 1e4, c = 2e4;
    const auto plateau = [&](StructuredYield yield) {
        const StructuredLaw law(unbroken_clay(28.0, yield));
        StructuredState state;
        state.stress = {-p, -p, -p, 0.0};
        return strained(law, 1000, {0, 0, 5e-5, 0.0}, -p, c, state).stress;
    };
    const StructuredStress tri = plateau(StructuredYield::compression), plane = plateau(StructuredYield::plane_strain),
                           pyramid = plateau(StructuredYield::hexagon);
    CHECK(tri.xy == Approx(30600.5).epsilon(2e-6));  // two-phase spec, V4
    CHECK(plane.xy == Approx(c * std::cos(28 * kDegree) + p * std::sin(28 * kDegree)).epsilon(1e-9));
    CHECK(plane.xy == Approx(22353.7).epsilon(2e-6));
    CHECK(pyramid.xy == Approx(plane.xy).epsilon(1e-9));  // Mohr's circle through the same centre
    for (const StructuredStress& s : {tri, plane, pyramid}) {
        CHECK((s.xx + s.yy) / 2 == Approx(-p).epsilon(1e-9));
        CHECK(s.zz == -p);
    }
}

TEST_CASE("V5: the return of a cone that dilates: multiplier, pressure and shear strength grow together",
          "[structured]") {
    const StructuredLaw law(unbroken_clay(28.0, StructuredYield::plane_strain, 10.0));
    const double p = 1e4, k = law.strength(2e4), alpha = law.alpha(), flows = std::sin(10 * kDegree) / 3.0;
    const double q0 = k + 3 * alpha * p, gamma = 1e-3;
    const ConeReturn back = law.to_cone(q0 + law.shear() * gamma, -3 * p, k);
    const double multiplier = law.shear() * gamma / (law.shear() + 9 * alpha * flows * law.bulk());
    CHECK(back.multiplier == Approx(multiplier).epsilon(1e-13));
    const double gained = -back.first / 3.0 - p;
    CHECK(gained == Approx(3 * law.bulk() * flows * multiplier).epsilon(1e-12));
    CHECK(back.scale * (q0 + law.shear() * gamma) - q0 == Approx(3 * alpha * gained).epsilon(1e-10));
}

TEST_CASE(
    "V5: plastic strain in the plane is the elastic strain that the return takes away, wherever the trial stress lies",
    "[structured]") {
    const StructuredYield yield = GENERATE(StructuredYield::compression, StructuredYield::plane_strain);
    // What dilates as much as it rubs and hardly shrinks has states that Newton's method leaves to the search.
    const auto [phi, psi, poisson] =
        GENERATE(std::tuple(28.0, 0.0, 0.3), std::tuple(28.0, 10.0, 0.3), std::tuple(45.0, 45.0, 0.45));
    StructuredMaterial m = unbroken_clay(phi, yield, psi);
    m.poisson = poisson;
    const StructuredLaw law(m);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> size(2.0, 7.0), side(-1.0, 1.0);
    const auto stress = [&] { return std::copysign(std::pow(10.0, size(random)), side(random)); };
    int yielded = 0;
    for (int n = 0; n < 20000; ++n) {
        const double c = std::pow(10.0, size(random) - 2.0);
        const StructuredStress trial{stress(), stress(), -std::pow(10.0, size(random) - 1.0), stress()};
        if (law.excess(trial, c) <= 0.0) continue;
        ++yielded;
        StructuredStress s = trial;
        const PlasticStep plastic = law.yield(c, s);
        const double dx = trial.xx - s.xx, dy = trial.yy - s.yy, xy = (1.0 + m.poisson) / m.young * (trial.xy - s.xy);
        const double exx = (dx - m.poisson * dy) / m.young, eyy = (dy - m.poisson * dx) / m.young;
        const double largest = 0.5 * (exx + eyy) + std::hypot(0.5 * (exx - eyy), xy);
        // zz is met to 1e-7 of the strength and the weight (kStressError), and is what these strains are without.
        const double scale = (law.strength(c) + std::abs(s.zz)) / m.young;
        const double round_off = 1e-14 * (std::abs(trial.xx) + std::abs(trial.yy) + std::abs(trial.xy)) / m.young;
        REQUIRE(std::abs(plastic.dilation - exx - eyy) <= 1e-6 * scale + round_off);
        REQUIRE(std::abs(plastic.extension - largest) <= 1e-6 * scale + round_off);
    }
    CHECK(yielded > 10000);
}

TEST_CASE("V6: tension in all directions ends at c cot(phi), and a returned stress stays", "[structured]") {
    const StructuredYield yield = GENERATE(StructuredYield::compression, StructuredYield::plane_strain);
    const double psi = GENERATE(0.0, 10.0), c = 2e4;
    const StructuredLaw law(unbroken_clay(28.0, yield, psi));
    const ConeReturn back = law.to_cone(10.0, 1e6, law.strength(c));
    CHECK(back.scale == 0.0);
    CHECK(back.first / 3.0 == Approx(c / std::tan(28 * kDegree)).epsilon(1e-14));
    StructuredStress s{7e4, 2e4, -3e3, 1.5e4};
    law.yield(c, s);
    CHECK(std::abs(law.excess(s, c)) < 2e-7 * law.strength(c));
    const StructuredStress once = s;
    law.yield(c, s);
    CHECK(std::hypot(s.xx - once.xx, s.yy - once.yy, s.xy - once.xy) < 1e-6 * law.strength(c));
}

TEST_CASE("V7: unconfined compression holds 2 c cos(phi) / (1 - sin(phi))", "[structured]") {
    for (const auto& [c, phi, printed] : {std::tuple(26.7e3, 28.0, 88.87e3), std::tuple(18.3e3, 27.0, 59.73e3)}) {
        // The flume's clays, as printed.
        CHECK(unconfined_strength(StructuredLaw(unbroken_clay(phi)), c) == Approx(printed).margin(5.0));
        for (const StructuredYield yield :
             {StructuredYield::compression, StructuredYield::hexagon, StructuredYield::plane_strain}) {
            const StructuredLaw law(unbroken_clay(phi, yield));
            CHECK(squeezed_strength(law, c) == Approx(unconfined_strength(law, c)).epsilon(kReturned));
        }
    }
}

TEST_CASE("V7: unconfined tension holds what cone and pyramid say", "[structured]") {
    const double c = 1e4, phi = 30.0 * kDegree;
    const auto strength = [&](StructuredYield yield) {
        return squeezed_alone(StructuredLaw(unbroken_clay(30.0, yield)), 0.05, 0.0, c).stress.xx;
    };
    CHECK(strength(StructuredYield::compression) ==
          Approx(6 * c * std::cos(phi) / (3 + std::sin(phi))).epsilon(kReturned));
    CHECK(strength(StructuredYield::hexagon) == Approx(2 * c * std::cos(phi) / (1 + std::sin(phi))).epsilon(kReturned));
}

TEST_CASE("V8: at constant dilation all bonds are broken when the plastic part is the critical strain",
          "[structured]") {
    StructuredMaterial m = unbroken_clay(28.0, GENERATE(StructuredYield::compression, StructuredYield::hexagon));
    m.critical_strain = 0.05;
    const StructuredLaw law(m);
    const double d = 1e-5, c0 = 2e4, lame = m.young / (1 - m.poisson);
    StructuredState state;
    double plastic = 0.0, worst = 0.0;
    for (int n = 0; n < 20000 && state.damage < 1.0; ++n) {
        const StructuredState before = state;
        law.update({d, d, 0.0, 0.0}, 0.0, c0, state);
        if (before.damage > 0.0 && state.damage < 1.0) {
            plastic += 2.0 * d - (state.stress.xx + state.stress.yy - before.stress.xx - before.stress.yy) / lame;
            worst = std::max(worst, std::abs(state.damage - plastic / m.critical_strain));
        } else if (state.damage > 0.0 && before.damage == 0.0) {
            plastic = state.damage * m.critical_strain;
        }
        // What is left of the cohesion, at the step's start, bears the tension: both cones go through c
        // cot(phi).
        if (before.damage > 0.0) CHECK(law.excess(state.stress, c0 * (1 - before.damage)) < 1e-6 * c0);
    }
    CHECK(state.damage == 1.0);
    CHECK(plastic == Approx(m.critical_strain).epsilon(1e-3));  // a step is 4e-4 of it
    CHECK(worst < 1e-6);
}

TEST_CASE("V8: in compression nothing breaks by dilation, and something by extension", "[structured]") {
    StructuredMaterial m = unbroken_clay(28.0);
    m.critical_strain = 0.05;
    const auto damage = [&](DamageBy by) {
        m.damage_by = by;
        m.onset = 0.02;
        return squeezed_alone(StructuredLaw(m), -0.05, 0.0, 2e4).damage;
    };
    CHECK(damage(DamageBy::dilation) == 0.0);
    CHECK(damage(DamageBy::extension) > 0.1);
    CHECK(damage(DamageBy::strain) > 0.3);
}

TEST_CASE("Damage by strain: none before the onset, exponential behind it", "[structured]") {
    StructuredMaterial m = unbroken_clay(28.0);
    m.damage_by = DamageBy::strain, m.critical_strain = 0.1, m.onset = 0.05;
    const StructuredLaw law(m);
    StructuredState state = strained(law, 49, {1e-3, 0, 0, 0}, 0.0, 1e3);  // yields from the first steps on
    CHECK(state.damage == 0.0);
    state = strained(law, 101, {1e-3, 0, 0, 0}, 0.0, 1e3, state);
    CHECK(state.damage == Approx(1.0 - std::exp(-100 * 1e-3 / 0.1)).epsilon(0.02));
}

TEST_CASE("Bell: extended both ways, the lateral stress is -(Ka p - 2 c sqrt(Ka)), whatever the weight",
          "[structured]") {
    const double p = GENERATE(0.0, 5e3, 30e3, 100e3), c = 2e4;
    const StructuredLaw law(unbroken_clay(28.0, GENERATE(StructuredYield::compression, StructuredYield::hexagon)));
    StructuredState state;
    state.stress.zz = -p;
    const StructuredStress s = strained(law, 2000, {1e-4, 1e-4, 0.0, 0.0}, -p, c, state).stress;
    const double bell = -(law.active() * p - 2 * c * std::sqrt(law.active()));
    CAPTURE(p);
    CHECK(s.xx == Approx(bell).margin(1e-6 * c));
    CHECK(s.yy == Approx(bell).margin(1e-6 * c));
}

TEST_CASE("The pyramid's return ends on the pyramid, on its side, and does no negative work", "[structured]") {
    const double psi = GENERATE(0.0, 28.0), weight = GENERATE(0.0, -2e4);
    const StructuredLaw law(unbroken_clay(28.0, StructuredYield::hexagon, psi));
    int yielded = 0;
    for (int n = 0; n < 400; ++n) {
        const double a = 0.11 * n, size = 3e4 + 500.0 * n;
        StructuredStress s{size * std::cos(a), size * std::sin(a), weight, 0.4 * size * std::cos(3.7 * a)};
        const StructuredStress trial = s;
        if (law.excess(s, 1e4) <= 0.0) continue;
        const PlasticStep plastic = law.yield(1e4, s);
        CAPTURE(n, trial.xx, trial.yy, trial.xy);
        CHECK(std::abs(law.excess(s, 1e4)) < 1e-9 * size);
        // What was taken away is elastic strain of plane stress, times E.
        const double nu = 0.3, young = law.material().young;
        const double xx = trial.xx - s.xx, yy = trial.yy - s.yy, xy = (1 + nu) * (trial.xy - s.xy);
        CHECK(plastic.dilation == Approx((1 - nu) * (xx + yy) / young).margin(1e-10));
        CHECK(plastic.extension ==
              Approx(((1 - nu) * (xx + yy) / 2 + std::hypot((1 + nu) * (xx - yy) / 2, xy)) / young).margin(1e-10));
        const double work = s.xx * (xx - nu * yy) + s.yy * (yy - nu * xx) + 2 * s.xy * xy;
        if (weight == 0.0) CHECK(work >= 0.0);
        ++yielded;
    }
    CHECK(yielded > 300);
}

TEST_CASE("Any stress outside a cone comes back to it with zz as it was, from near and from far", "[structured]") {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0), both(-1.0, 1.0);
    const double dilates = GENERATE(0.0, 0.3, 1.0);  // psi / phi; the last one needs the search for some of them
    int yielded = 0;
    for (int n = 0; n < 20000; ++n) {
        const double phi = 5.0 + 35.0 * unit(random);
        const StructuredLaw law(unbroken_clay(phi, StructuredYield::compression, dilates * phi));
        const double weight = -std::pow(10.0, 2.0 + 3.0 * unit(random)),
                     cohesion = std::pow(10.0, 1.0 + 5.0 * both(random)),
                     size = std::pow(10.0, 1.0 + 5.0 * unit(random));
        const StructuredStress trial{weight + size * both(random), weight + size * both(random), weight,
                                     size * both(random)};
        if (law.excess<double>(trial, cohesion) <= 0.0) continue;
        StructuredStress s = trial;
        const PlasticStep plastic = law.yield(cohesion, s);
        ++yielded;
        // zz is met to 1e-7 of strength and weight; the surface rises by less than that with it.
        CAPTURE(phi, trial.xx, trial.yy, trial.zz, trial.xy, cohesion);
        CHECK(std::abs(law.excess<double>(s, cohesion)) < 1e-7 * (law.strength(cohesion) - weight));
        CHECK(s.zz == weight);
        // What was taken away is 2 G times the plastic strain in the plane, up to what goes with all three directions.
        const double gone = std::hypot(0.5 * (trial.xx - trial.yy) - 0.5 * (s.xx - s.yy), trial.xy - s.xy);
        CHECK(plastic.extension - 0.5 * plastic.dilation ==
              Approx(gone / (2.0 * law.shear())).epsilon(1e-6).margin(1e-9 * size / law.shear()));
    }
    CHECK(yielded > 5000);
}

TEST_CASE("Four particles at once come out as one after the other, to round-off", "[structured]") {
    StructuredMaterial m = unbroken_clay(
        28.0, GENERATE(StructuredYield::compression, StructuredYield::plane_strain, StructuredYield::hexagon));
    m.critical_strain = 0.05;
    const StructuredLaw law(m);
    StructuredState one[4];
    StructuredStateOf<Double4> four;
    for (int step = 0; step < 200; ++step) {
        StructuredStepOf<Double4> d4;
        Double4 weight, cohesion;
        for (int n = 0; n < 4; ++n) {
            const double a = 0.3 * n + 0.01 * step;
            const StructuredStep d{2e-4 * std::cos(a), 1e-4 * n, 1e-4 * std::sin(2 * a), n == 3 ? 0.2 : 1e-3};
            weight[n] = -1e3 * n, cohesion[n] = 5e2 * (n + 1);
            d4.xx[n] = d.xx, d4.yy[n] = d.yy, d4.xy[n] = d.xy, d4.turn[n] = d.turn;
        }
        for (int n = 0; n < 4; ++n)
            law.update(StructuredStep{d4.xx[n], d4.yy[n], d4.xy[n], d4.turn[n]}, weight[n], cohesion[n], one[n]);
        law.update(d4, weight, cohesion, four);
    }
    int damaged = 0;
    for (int n = 0; n < 4; ++n) {
        // A batch with one large turn turns all by cos and sin of the library: other round-off.
        CHECK(four.stress.xx[n] == Approx(one[n].stress.xx).epsilon(1e-9).margin(1e-6));
        CHECK(four.stress.xy[n] == Approx(one[n].stress.xy).epsilon(1e-9).margin(1e-6));
        CHECK(four.damage[n] == Approx(one[n].damage).epsilon(1e-9).margin(1e-12));
        damaged += one[n].damage > 0.0;
    }
    CHECK(damaged > 0);
    CHECK(q_of(one[1].stress) > 0.0);
}

TEST_CASE("A damaged particle keeps a stress that grains can bear", "[structured]") {
    const StructuredLaw law(unbroken_clay(30.0));
    StructuredState state;
    state.damage = 1.0;
    state = strained(law, 100, {1e-4, 2e-5, 3e-5, 1e-3}, 0.0, 1e4, state);
    CHECK(std::abs(state.stress.xx) < 1e-3);  // no weight, no cohesion: nothing
    state.stress.zz = 0.0;
    state = strained(law, 1000, {1e-4, 1e-4, 0.0, 0.0}, -1e3, 1e4, state);
    CHECK(state.stress.xx == Approx(-law.active() * 1e3).epsilon(1e-5));
}

TEST_CASE("What a call costs", "[.cost]") {
    const auto measure = [](const StructuredLaw& law, double size, const char* what) {
        constexpr int kCalls = 2000000;
        StructuredStateOf<Double4> state;
        state.stress.zz = all(-1e3);
        const auto start = std::chrono::steady_clock::now();
        for (int n = 0; n < kCalls / 4; ++n) {
            const double d = n / 64 % 2 ? size : -size;
            law.update({all(d), all(0.3 * d), all(0.5 * d), all(1e-4)}, all(-1e3), all(2e4), state);
        }
        const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        fmt::print("{}: {:.1f} ns a particle, xx {:.3g} Pa\n", what, 1e9 * time.count() / kCalls,
                   double{state.stress.xx[0]});
        CHECK(time.count() > 0.0);
    };
    measure(StructuredLaw(unbroken_clay(28.0)), 1e-6, "elastic");
    measure(StructuredLaw(unbroken_clay(28.0)), 1e-3, "yielding, cone");
    measure(StructuredLaw(unbroken_clay(28.0, StructuredYield::hexagon)), 1e-3, "yielding, pyramid");
}
