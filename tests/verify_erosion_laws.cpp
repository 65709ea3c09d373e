// Erosion laws without a problem of their own in `frana verify`, against closed forms of a slab on a plane.
#include <cmath>
#include <functional>
#include <vector>

#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"
#include "checks/verify/ode.h"
#include "shallow/depth_averaged.h"

using namespace frana;
using namespace frana::test;

namespace {

using constants::kGravity;

constexpr double kSlope = 0.5235987755982988, kMu = 0.3;

/// A slab of 200 m with Coulomb friction on a strip between walls that falls along x by 30 degrees; loose ground from
/// `begin` on, `loose` deep along gravity.
Scene slab(double thickness, double speed, double begin, double loose) {
    const double cell = 4.0, cosine = std::cos(kSlope);
    Scene scene = scene_on(
        131, 7, cell, [](double x, double) { return -std::tan(kSlope) * x; }, -100.0);
    scene.sides = Sides::wall;
    scene.gravity = kGravity;
    scene.bed_law = bed::Coulomb{kMu};
    fill(scene, [&](double x, double) { return x > 0.0 && x < 200.0 ? thickness / cosine : 0.0; });
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), speed * cosine);
    ErodibleBed bed;
    bed.density = 1.2 * scene.density, bed.min_depth = 0.0, bed.evolves = false;
    bed.depth = Raster::filled(scene.bed.geometry, 0.0);
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) bed.depth.at(i, j) = g.x(i) > begin ? loose : 0.0;
    scene.erodible = bed;
    return scene;
}

/// Thickness [m] and speed along the bed [m/s].
using State = verify::State<2>;

/// Of the points that began within two cells of the slab's middle.
State middle_of(DepthAveraged& run, const Seeds& seeds) {
    const Frame frame = run.frame();
    const double *speed = frame.particle("speed")->data, *id = frame.particle("id")->data,
                 *thickness = frame.particle("thickness")->data;
    State sum{0.0, 0.0};
    double count = 0.0;
    for (Index p = 0; p < frame.particle("id")->count; ++p) {
        const auto first = static_cast<Index>(id[p]);
        if (first >= seeds.count() || std::abs(seeds.x[first] - 100.0) > 8.0) continue;
        sum[0] += thickness[p], sum[1] += speed[p], count += 1.0;
    }
    REQUIRE(count > 0.0);
    return {sum[0] / count, sum[1] / count};
}

}  // namespace

// With Coulomb friction E = c sqrt(h), so sqrt(h) = sqrt(h0) + k t, k = (rho_b / rho) c / 2. Then h du/dt = a h - 2 k sqrt(h) u
// is (u h)' = a h, and u h = u0 h0 + a (h^(3/2) - h0^(3/2)) / (3 k).
TEST_CASE("A slab that takes its bed by the mechanical law", "[erosion][verify]") {
    const double h0 = 1.5, u0 = 2.0, end = 6.0, mu_b = 0.15, nu = 0.03, beta = 1.2;
    const double normal = kGravity * std::cos(kSlope), a = kGravity * std::sin(kSlope) - kMu * normal;
    const double c = nu * std::sqrt(normal * (kMu - beta * mu_b) * (1.0 + beta)), k = 0.5 * beta * c;
    const double root = std::sqrt(h0) + k * end, h = root * root;
    const double u = (u0 * h0 + a * (h * root - h0 * std::sqrt(h0)) / (3.0 * k)) / h;
    const State integrated = verify::integrate(
        [&](double, const State& y) {
            const double grows = beta * c * std::sqrt(y[0]);
            return State{grows, a - grows * y[1] / y[0]};
        },
        0.0, end, State{h0, u0}, 1e-3);
    CHECK(integrated[0] == Approx(h).epsilon(1e-10));
    CHECK(integrated[1] == Approx(u).epsilon(1e-10));
    REQUIRE(h > 1.2 * h0);  // it matters
    Scene scene = slab(h0, u0, -1e9, 10.0);
    scene.erodible->law = erosion::Mechanical{mu_b, nu};
    DepthAveraged run(scene);
    run_to(run, end);
    const State found = middle_of(run, scene.particles);
    CHECK(found[0] == Approx(h).epsilon(1e-3));
    CHECK(found[1] == Approx(u).epsilon(1e-3));
}

// In the middle of the slab nothing depends on the cell: what is left is of second order in the step.
TEST_CASE("Each law's growth of a slab is of second order in time", "[erosion][verify]") {
    const double h0 = 1.5, u0 = 8.0, end = 4.0, beta = 1.2, c = kMu * kGravity * std::cos(kSlope);
    const double a = kGravity * std::sin(kSlope) - c;
    struct Case {
        const char* name;
        ErosionLaw law;
        std::function<double(double h, double u)> share_rate;  ///< of the mass, that is taken [1/s]
    };
    const double mu_b = 0.15, force = kGravity * std::cos(kSlope) * (kMu - beta * mu_b) * (1.0 + beta);
    const auto growth = [&](double share) {
        return Case{"growth", erosion::Growth{share}, [=](double, double u) { return share * u; }};
    };
    const auto energy = [&](double needed) {
        return Case{"energy", erosion::Energy{needed}, [=](double, double u) { return c * u / needed; }};
    };
    const auto mechanical = [&](double nu) {
        return Case{"mechanical", erosion::Mechanical{mu_b, nu},
                    [=](double h, double) { return beta * nu * std::sqrt(force / h); }};
    };
    const Case jump{"jump", erosion::Jump{0.0}, [=](double, double u) { return beta * c / u; }};
    // Those that grow fast exchange in each step, the others in every third.
    const std::vector<Case> cases = {growth(0.05), energy(50.0), mechanical(0.3), jump,
                                     growth(5e-4), energy(5e3),  mechanical(3e-3)};
    for (const Case& one : cases) {
        const State exact = verify::integrate(
            [&](double, const State& y) {
                const double rate = one.share_rate(y[0], y[1]);
                return State{rate * y[0], a - rate * y[1]};
            },
            0.0, end, State{h0, u0}, 1e-3);
        REQUIRE(exact[0] > 1.01 * h0);
        std::vector<State> errors;
        for (const double cfl : {0.5, 0.25, 0.125}) {
            Scene scene = slab(h0, u0, -1e9, 10.0);
            scene.erodible->law = one.law;
            scene.scheme.cfl = cfl;
            DepthAveraged run(scene);
            run_to(run, end);
            const State found = middle_of(run, scene.particles);
            errors.push_back({found[0] / exact[0] - 1.0, found[1] / exact[1] - 1.0});
        }
        for (std::size_t n = 0; n < 2; ++n) {
            CAPTURE(one.name, n, errors[0][n], errors[1][n], errors[2][n]);
            constexpr double kExact = 1e-9;  // below it, rounding and what the ends send count
            if (std::abs(errors[1][n]) > kExact)
                CHECK(std::abs(errors[1][n]) > 2.8 * std::abs(errors[2][n]));  // the second order has 4, the first 2
            CHECK(std::abs(errors[2][n]) < 2e-3);
        }
    }
}

// h du/dt = a h - (1 - kappa) E u. With kappa = 1 the bed brings what momentum friction takes, and no more. By E u = c h it is
// as much as it needs.
TEST_CASE("A bed that friction sets in motion slows no slab", "[erosion][verify]") {
    const double u0 = 8.0, end = 4.0, c = kMu * kGravity * std::cos(kSlope), a = kGravity * std::sin(kSlope) - c;
    Scene scene = slab(1.5, u0, -1e9, 10.0);
    scene.erodible->law = erosion::Jump{0.0};
    scene.erodible->momentum = 1.0, scene.erodible->density = scene.density;
    DepthAveraged run(scene);
    run_to(run, end);
    const State found = middle_of(run, scene.particles);
    REQUIRE(found[0] > 2.0 * 1.5);  // it matters
    // Each exchange errs by its fourth power of the growth, so the sum by the third.
    constexpr double kGrowth = 0.02;
    CHECK(found[1] == Approx(u0 + a * end).epsilon(kGrowth * kGrowth * kGrowth));
}

TEST_CASE("A bed whose friction holds more than the flow's stress is not taken mechanically", "[erosion]") {
    Scene scene = slab(1.5, 2.0, -1e9, 10.0);
    scene.erodible->law = erosion::Mechanical{0.3, 1.0};  // of 1.2 the flow's density
    DepthAveraged run(scene);
    run_to(run, 1.0);
    CHECK(run.status().bed.eroded == 0.0);
}

// m = m0 + l s and m du/dt = m a - l u^2, all of the layer behind the front taken: u^2 = ((m0 u0)^2 + 2 a (m^3 - m0^3) /
// (3 l)) / m^2. A slab is no rigid block, its front runs ahead; so its own front tells the mass, and the momentum is that of
// the mass.
TEST_CASE("A slab ploughs all of a layer, to its front", "[erosion][verify]") {
    const double loose = 0.1, begin = 220.0;
    Scene scene = slab(0.8, 6.0, begin, loose);
    scene.erodible->law = erosion::Front{};
    DepthAveraged run(scene);
    const Status first = run.status();
    const double along = (kGravity * std::sin(kSlope) - kMu * kGravity * std::cos(kSlope)) * std::cos(kSlope);
    double pushed = 0.0, before = 0.0;  // [kg m/s]
    while (run.status().time < 7.0) {
        const double mass = run.status().mass;
        run.advance(7.0);
        pushed += 0.5 * (mass + run.status().mass) * along * (run.status().time - before);
        before = run.status().time;
    }
    const Frame frame = run.frame();
    double front = 0.0;
    for (Index p = 0; p < frame.particle("id")->count; ++p)
        front = std::max(front, frame.particle("position")->data[3 * p]);
    const double width = 24.0, per_way = 1.2 * scene.density * loose * width;
    REQUIRE(run.status().mass_left == 0.0);
    REQUIRE(run.status().bed.eroded > 40.0 * per_way);  // it matters: ten cells
    // The layer begins within a cell of where its nodes do; the front lies two cells or so ahead of what is all taken.
    CHECK(run.status().bed.eroded == Approx(per_way * (front - begin)).margin(3.0 * 4.0 * per_way));
    // Every particle is pushed by a alone, its pressures cancel: the sum of all momentum is exact but for the steps.
    CHECK(run.frame().status.momentum[0] == Approx(first.momentum[0] + pushed).epsilon(2e-3));
}
