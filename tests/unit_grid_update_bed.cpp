// The terrain under a grid update, at one node, against its formulas.
#include <limits>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/grid_update_bed.h"

using namespace frana;

namespace {
constexpr double kRoundOff = 1e-12;  ///< differences of elevations near 10 m over a cell of 2 m

/// A bowl on a plane: slopes 0.3 and -0.2 in its middle, node (20, 15), second derivatives 0.004, 0.002 (xy), -0.006.
Scene bent() {
    return verify::scene_on(41, 31, 2.0, [](double x, double y) {
        const double a = x - 40.0, b = y - 30.0;
        return 0.3 * a - 0.2 * b + 0.002 * a * a + 0.002 * a * b - 0.003 * b * b;
    });
}
}  // namespace

TEST_CASE("The drive divides by 1 + q where the surface falls with the bed and not where against it", "[grid_update]") {
    const Flow flow(bent());
    const SteepBed<double, Curvature::none, false> bed(flow, flow.grid.at(20, 15));
    REQUIRE(bed.bx == Approx(0.3).epsilon(kRoundOff));
    REQUIRE(bed.by == Approx(-0.2).epsilon(kRoundOff));
    const double q = 0.3 * 0.5 + 0.2 * 0.1;
    CHECK(bed.drive(0.5, -0.1, 1.0).x == Approx(0.5 / (1.0 + q)).epsilon(kRoundOff));
    CHECK(bed.drive(0.5, -0.1, 1.0).y == Approx(-0.1 / (1.0 + q)).epsilon(kRoundOff));
    CHECK(bed.drive(-0.5, 0.1, 1.0).x == -0.5);
    CHECK(bed.drive(-0.5, 0.1, 1.0).y == 0.1);
}

TEST_CASE("The linear drive is that to first order in the depth's gradient", "[grid_update]") {
    const Flow flow(bent());
    const Index k = flow.grid.at(20, 15);
    const SteepBed<double, Curvature::none, false> whole(flow, k);
    const SteepBed<double, Curvature::none, true> linear(flow, k);
    const double cosine = 1.0 / std::sqrt(1.0 + 0.09 + 0.04), small = 1e-6;
    const double ex = 0.3 + 0.7 * small, ey = -0.2 + 0.4 * small;
    // The terms left out are of second order, with factors below one.
    CHECK(linear.drive(ex, ey, cosine).x == Approx(whole.drive(ex, ey, cosine).x).margin(small * small));
    CHECK(linear.drive(ex, ey, cosine).y == Approx(whole.drive(ex, ey, cosine).y).margin(small * small));
}

TEST_CASE("The bed's bend adds v.H.v to gravity, and never turns it", "[grid_update]") {
    Scene scene = bent();
    scene.scheme.curvature_length = 0.0;  // averages keep a quadratic bed's second derivatives
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    for (const auto& [vx, vy] : {std::pair{3.0, 4.0}, std::pair{3.0, -4.0}, std::pair{0.0, 5.0}})
        CHECK(bed.gravity(9.81, vx, vy) ==
              Approx(9.81 + 0.004 * vx * vx + 2.0 * 0.002 * vx * vy - 0.006 * vy * vy).epsilon(1e-10));
    CHECK(bed.gravity(9.81, 0.0, 100.0) == 0.0);
}

TEST_CASE("A bend turns what is higher than half its radius, and adds nothing to its pressure", "[grid_update]") {
    Scene scene = bent();
    scene.scheme.curvature_length = 0.0;
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    const double g = 9.81, vx = 3.0, vy = 4.0, cosine = 1.0 / std::sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
    const double k = bed.gravity(g, vx, vy) - g, wide = (vx * vx + vy * vy) / std::abs(k);
    const Drive<double> slope = bed.drive(bed.bx - 7.0, bed.by + 2.0, cosine);  // of a steep depth
    const auto driving = [&](double high) { return bed.driving(slope, g, high, vx, vy, cosine); };
    for (const double high : {0.0, 0.1 * wide, 0.249 * wide}) {
        CHECK(driving(high).x == (g + k) * slope.x);
        CHECK(driving(high).y == (g + k) * slope.y);
    }
    const double c2 = cosine * cosine;
    for (const double high : {0.5 * wide, 100.0 * wide}) {
        CHECK(driving(high).x == Approx(g * slope.x + k * c2 * bed.bx).epsilon(kRoundOff));
        CHECK(driving(high).y == Approx(g * slope.y + k * c2 * bed.by).epsilon(kRoundOff));
    }
    CHECK(driving(0.375 * wide).x == Approx(0.5 * (driving(0.25 * wide).x + driving(0.5 * wide).x)).epsilon(kRoundOff));
    // What is left of the bend works on the velocity along the bed, of which w = B.v is the vertical part, as much as the
    // bend changes w: dw/dt = B.a + k.
    const double ax = driving(2.0 * wide).x - g * slope.x, ay = driving(2.0 * wide).y - g * slope.y;
    const double w = bed.bx * vx + bed.by * vy, work = -(vx * ax + vy * ay) + w * (k - (bed.bx * ax + bed.by * ay));
    CHECK(std::abs(work) <= kRoundOff * (g + std::abs(k)) * 5.0 * 7.0);  // speed, slope of the surface
}

TEST_CASE("Where the bed falls away faster than what flies would, a flow keeps its direction and wins nothing",
          "[grid_update]") {
    Scene scene = bent();
    scene.scheme.curvature_length = 0.0;
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    const double g = 9.81, cosine = 1.0 / std::sqrt(1.0 + bed.bx * bed.bx + bed.by * bed.by);
    for (const double turn : {1.0, -1.0})
        for (const double high : {0.0, 1e3}) {
            const double vx = turn * 10.0, vy = turn * 100.0, w = bed.bx * vx + bed.by * vy;
            const double k = 0.004 * vx * vx + 2.0 * 0.002 * vx * vy - 0.006 * vy * vy;
            REQUIRE(g + k < 0.0);
            CHECK(bed.gravity(g, vx, vy) == 0.0);
            const Drive<double> a = bed.driving(bed.drive(bed.bx, bed.by, cosine), g, high, vx, vy, cosine);
            const double held = (g + k) * w / (vx * vx + vy * vy + w * w);
            CHECK(a.x == Approx(held * vx).epsilon(1e-10));
            CHECK(a.y == Approx(held * vy).epsilon(1e-10));
            // The speed along the bed changes by what gravity does on the way down, and by nothing else.
            const double power = -(vx * a.x + vy * a.y) + w * (k - (bed.bx * a.x + bed.by * a.y));
            CHECK(power == Approx(-g * w).epsilon(1e-9));
        }
}

TEST_CASE("A step in the bed that only the raw bed has gives no speed to a flow that would fly", "[grid_update]") {
    // A ramp of 1 m/m over three cells of 2 m on a crest that bends by 0.02 1/m; smoothed over 40 m it is next to nothing.
    Scene scene = verify::scene_on(41, 31, 2.0, [](double x, double) {
        return std::min(std::max(x - 38.0, 0.0), 6.0) - 0.01 * (x - 40.0) * (x - 40.0);
    });
    scene.scheme.curvature_length = 40.0;
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    const double g = 9.81, cosine = 1.0 / std::sqrt(1.0 + bed.bx * bed.bx), v = 60.0, smooth = bed.smooth->x;
    REQUIRE(bed.bx > 0.9);
    REQUIRE(g + bed.hxx * v * v < 0.0);
    REQUIRE(smooth < 0.1 * bed.bx);
    const Drive<double> slope = bed.drive(bed.bx, 0.0, cosine);
    const double up = bed.driving(slope, g, 0.0, v, 0.0, cosine).x,
                 down = bed.driving(slope, g, 0.0, -v, 0.0, cosine).x;
    // Speed is won (a = -drive) by no more than the smoothed slope allows; the way down is whole.
    const double whole = (g + bed.hxx * v * v) * bed.bx / (1.0 + bed.bx * bed.bx);
    CHECK(up == Approx(whole * std::max(0.0, smooth) / bed.bx).epsilon(1e-10));
    CHECK(down == Approx(whole).epsilon(1e-10));
}

TEST_CASE("A climb costs what it lifts where the bed is sharper than its smoothed curvature", "[grid_update]") {
    // A ramp of 1 m/m over three cells of 2 m in a plain; smoothed over 40 m it is next to nothing.
    Scene scene =
        verify::scene_on(41, 31, 2.0, [](double x, double) { return std::min(std::max(x - 38.0, 0.0), 6.0); });
    scene.scheme.curvature_length = 40.0;
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    REQUIRE(bed.bx > 0.9);
    const double g = 9.81, dt = 0.01, own = bed.smooth->x / bed.bx, cosine = 1.0;
    REQUIRE(own < 0.1);
    double vx = 8.0 - dt * g * bed.drive(bed.bx, 0.0, cosine).x, vy = 3.0;
    bed.climb(bed.bx, 0.0, 0.0, g, flow.cell, g, dt, vx, vy);
    // All of g e but for the square of the share that the smoothed bed has, below 1.2 %.
    CHECK(8.0 - vx <= dt * g * bed.bx * (1.0 + 1e-12));
    CHECK(8.0 - vx >= 0.988 * dt * g * bed.bx);
    CHECK(vy == 3.0);

    // A front on the bank, whose surface was mended to that of the pool before it.
    double front = 8.0;
    vy = 3.0;
    bed.climb(0.0, 0.0, 1.0, g, flow.cell, g, dt, front, vy);
    CHECK(8.0 - front <= dt * g * bed.bx * (1.0 + 1e-12));
    CHECK(8.0 - front >= 0.97 * dt * g * bed.bx);  // that square enters twice
    double inner = 8.0;
    bed.climb(0.0, 0.0, 0.0, g, flow.cell, g, dt, inner, vy);
    CHECK(inner == 8.0);

    double down = -8.0, across = 3.0;
    bed.climb(bed.bx, 0.0, 0.0, g, flow.cell, g, dt, down, across);
    CHECK(down == -8.0);
    double slow = 1e-6, still = 0.0;
    bed.climb(bed.bx, 0.0, 0.0, g, flow.cell, g, dt, slow, still);
    CHECK(slow == 0.0);  // it stops, and is not turned
    CHECK(still == 0.0);
}

TEST_CASE("What a step in the bed stops stands still, whichever way the step rises", "[grid_update]") {
    // Along the rise, too slow for a step's climb; what round-off left would have a direction of its own.
    int moving = 0;
    for (int n = 0; n < 100; ++n) {
        const double turn = 0.06283 * n, rise_x = std::cos(turn), rise_y = std::sin(turn);
        Scene scene = verify::scene_on(31, 31, 2.0, [&](double x, double y) {
            return std::clamp(5.0 * ((x - 30.0) * rise_x + (y - 30.0) * rise_y), 0.0, 20.0);
        });
        scene.scheme.curvature_length = 40.0;
        const Flow flow(scene);
        const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(15, 15));
        double vx = 1e-3 * bed.bx, vy = 1e-3 * bed.by;
        bed.climb(bed.bx, bed.by, 0.0, 9.81, flow.cell, 9.81, 0.1, vx, vy);
        moving += vx != 0.0 || vy != 0.0;
    }
    CHECK(moving == 0);
}

// Heights of 1650 m have a round-off of 2e-13 m, and slopes of cells of 0.3 m have it three times.
TEST_CASE("What a step stops high above the sea stands still too", "[grid_update]") {
    const double cell = 0.3, height = 1650.0;
    Scene scene = verify::scene_on(31, 31, cell, [&](double x, double y) {
        return height + std::clamp(5.0 * (x + y - 30.0 * cell), 0.0, 10.0 * cell);
    });
    scene.scheme.curvature_length = 20.0 * cell;
    Flow flow(scene);
    const Index k = flow.grid.at(15, 15);
    flow.nodes.surface[k] = height;
    const SteepBed<double, Curvature::full, false> bed(flow, k);
    const double off = std::numeric_limits<double>::epsilon() * height / cell;
    for (const double turned : {-off, off}) {
        double vx = 1e-3 * bed.bx, vy = 1e-3 * bed.by;
        bed.climb(bed.bx + turned, bed.by - turned, 0.0, 9.81, cell, 9.81, 0.1, vx, vy);
        CHECK(vx == 0.0);
        CHECK(vy == 0.0);
    }
    double vx = 1e-3 * bed.bx, vy = 1.001e-3 * bed.by;  // what goes along the step goes on
    bed.climb(bed.bx, bed.by, 0.0, 9.81, cell, 9.81, 0.1, vx, vy);
    CHECK(std::hypot(vx, vy) > 1e-7 * bed.by);
}

// Round-off of the height is large against a slope of nothing. What is left of the speed is no round-off.
TEST_CASE("High above the sea a surface that is next to level stops nothing", "[grid_update]") {
    const Scene scene = verify::scene_on(31, 31, 1.0, [](double x, double) { return 1650.0 + 0.5 * x; });
    Flow flow(scene);
    const Index k = flow.grid.at(12, 15);
    flow.nodes.surface[k] = 1657.0;
    const SteepBed<double, Curvature::full, false> bed(flow, k);
    for (const double slope : {1e-300, 1e-20, 1e-12, 1e-9}) {
        double vx = 2.0, vy = 1.0;
        bed.climb(slope, 0.0, 0.0, 9.81, 1.0, 9.81, 0.01, vx, vy);
        CHECK(vx == Approx(2.0).epsilon(1e-9));
        CHECK(vy == 1.0);
    }
}

TEST_CASE("A climb on a smooth bed costs nothing more", "[grid_update]") {
    Scene scene = bent();
    scene.scheme.curvature_length = 0.0;
    const Flow flow(scene);
    const SteepBed<double, Curvature::full, false> bed(flow, flow.grid.at(20, 15));
    double vx = 8.0, vy = -3.0;
    bed.climb(bed.bx + 0.1, bed.by - 0.2, 1.0, 9.81, flow.cell, 12.0, 0.01, vx, vy);
    CHECK(vx == Approx(8.0).epsilon(kRoundOff));
    CHECK(vy == Approx(-3.0).epsilon(kRoundOff));
}
