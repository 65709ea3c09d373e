// The shape functions against what B-splines are (V17 of the structured model; Steffen, Kirby and Berzins 2008).
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "checks/verify/structured.h"
#include "mpm/stencil.h"
#include "structured/structured_flow.h"

using namespace frana;

namespace {

/// Weight of the node at 0 for a point at u cells.
template <class S>
double weight(double u) {
    const S s(u);
    return s.base <= 0 && s.base + S::kNodes > 0 ? s.w[-s.base] : 0.0;
}
template <class S>
double slope(double u) {
    const S s(u);
    return s.base <= 0 && s.base + S::kNodes > 0 ? s.slope(static_cast<int>(-s.base)) : 0.0;
}

}  // namespace

TEMPLATE_TEST_CASE("V17: a node's weight has integral 1, falls away from it, and its slope is its derivative", "[grid]",
                   Linear, Quadratic, Cubic) {
    constexpr int kPieces = 4000;
    constexpr double kReach = 2.5, kStep = 2.0 * kReach / kPieces;
    double integral = 0.0, worst = 0.0;
    for (int n = 0; n < kPieces; ++n) {
        const double u = -kReach + (n + 0.5) * kStep, w = weight<TestType>(u);  // no kink lies between u - d and u + d
        integral += kStep * w;
        constexpr double d = 1e-4;
        worst = std::max(
            worst, std::abs((weight<TestType>(u + d) - weight<TestType>(u - d)) / (2.0 * d) - slope<TestType>(u)));
        CHECK(w >= 0.0);
        CHECK(slope<TestType>(u) * u <= 0.0);
        if (w > 0.0) CHECK(slope<TestType>(u) * u < 0.0);
    }
    // Midpoints of a function with a kink in its third derivative at worst of the first: step^2 / 12.
    CHECK(integral == Approx(1.0).epsilon(2e-7));
    CHECK(worst < 1e-8);  // d^2 / 6 of the third derivative, 1 for the cubic, and round-off 1e-16 / d
}

TEMPLATE_TEST_CASE("V17: weights at a point are 1 together, and give a linear field and its slope back", "[grid]",
                   Linear, Quadratic, Cubic) {
    for (int n = 0; n <= 1000; ++n) {
        const double u = 5.0 + n / 500.0;  // whole and half cells too
        const TestType s(u);
        double sum = 0.0, slopes = 0.0, place = 0.0, rise = 0.0;
        for (int k = 0; k < TestType::kNodes; ++k) {
            sum += s.w[k], slopes += s.slope(k);
            place += s.w[k] * static_cast<double>(s.base + k), rise += s.slope(k) * static_cast<double>(s.base + k);
        }
        CHECK(std::abs(sum - 1.0) < 4e-16);
        CHECK(std::abs(slopes) < 1e-15);
        CHECK(std::abs(place - u) < 8e-15);  // round-off of 7
        CHECK(std::abs(rise - 1.0) < 8e-15);
    }
}

TEMPLATE_TEST_CASE("V17: weights and slopes go on without a jump from one stencil to the next", "[grid]", Quadratic,
                   Cubic) {
    constexpr double d = 1e-9;
    for (double u = -2.5; u <= 2.5; u += 0.5) {
        CHECK(std::abs(weight<TestType>(u + d) - weight<TestType>(u - d)) < 2.0 * d + 1e-15);  // slopes are below 1
        CHECK(std::abs(slope<TestType>(u + d) - slope<TestType>(u - d)) < 5.0 * d);            // and theirs at most 2
    }
}

TEST_CASE("V17: particles take a linear velocity from the nodes, and its gradient, exactly", "[structured]") {
    StructuredScene scene;
    scene.grid = verify::grid_over({0, 0}, {4, 3}, 0.1);
    scene.ground = [](double, double) { return GroundGravity{0, 0, 0}; };
    scene.material.young = 1.0;  // holds nothing together
    verify::StructuredBlock block;
    block.high = {4.0, 3.0}, block.cohesion = 1e9;
    verify::add_block(scene, block);
    const double xx = 0.3, xy = -0.7, yx = 0.2, yy = 0.5;
    StructuredSeeds& q = scene.points;
    for (std::size_t p = 0; p < q.x.size(); ++p) {
        q.vx[p] = 1.0 + xx * q.x[p] + xy * q.y[p];
        q.vy[p] = 2.0 + yx * q.x[p] + yy * q.y[p];
    }
    const StructuredSeeds seeds = q;
    StructuredFlow flow(scene);
    flow.advance(
        1e-9);  // particles stand on a lattice: what nodes get is linear too, but for those at the block's edge
    const StructuredPoints& now = flow.body().points;
    int inside = 0;
    for (Index p = 0; p < now.count(); ++p) {
        const std::size_t n = static_cast<std::size_t>(now.id[p]);
        if (seeds.x[n] < 0.3 || seeds.x[n] > 3.7 || seeds.y[n] < 0.3 || seeds.y[n] > 2.7) continue;
        ++inside;
        // Velocities up to 5 m/s in round-off 1e-16; a gradient is their difference over a cell of 0.1 m. Stress of 1 Pa
        // in a nanosecond is nothing beside it.
        CHECK(now.vx[p] == Approx(seeds.vx[n]).margin(1e-14));
        CHECK(now.vy[p] == Approx(seeds.vy[n]).margin(1e-14));
        CHECK(now.cxx[p] == Approx(xx).margin(2e-13));
        CHECK(now.cxy[p] == Approx(xy).margin(2e-13));
        CHECK(now.cyx[p] == Approx(yx).margin(2e-13));
        CHECK(now.cyy[p] == Approx(yy).margin(2e-13));
    }
    CHECK(inside == 68 * 48);
}
