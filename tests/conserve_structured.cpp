// Structured solids: mass, momentum, symmetry, the same bits on any number of threads; warm steps need no
// memory.
#include <fmt/core.h>
#include <omp.h>

#include "catch.h"
#include "checks/verify/library.h"
#include "checks/verify/structured_cases.h"
#include "structured/breakage.h"

using namespace frana;

namespace {

/// A block of 40 x 30 cells that runs over an edge into an obstacle's corner and breaks.
StructuredScene breaking(double cohesion = 2e3) {
    StructuredScene s;
    s.material.young = 2e6;
    s.material.critical_strain = 0.05;
    s.bed_law = bed::Coulomb{0.3};
    s.ground = terrain_ground([](double x, double y) { return Vec2(x < 3.0 ? -0.5 : 0.1, 0.05 * y); });
    s.grid = verify::grid_over({-2, -3}, {8, 7}, 0.1);
    Obstacle wall;
    wall.low = {4.1, -10.0}, wall.high = {5.0, 1.0}, wall.friction = 0.3;
    s.obstacles.push_back(wall);
    verify::StructuredBlock block;
    block.high = {4.0, 3.0}, block.depth = 0.5, block.cohesion = cohesion, block.velocity = {3.0, 0.2};
    verify::add_block(s, block);
    return s;
}

}  // namespace

TEST_CASE("A block that breaks conserves its mass, and its momentum is what it was given, to round-off",
          "[structured]") {
    StructuredFlow flow(breaking());
    const double given = flow.status().momentum.norm();
    for (int step = 0; step < 300; ++step) flow.advance(10.0);
    const StructuredStatus& now = flow.status();
    CHECK(now.damage > 0.02);
    CHECK(now.impulse.obstacles.x() < -0.01 * given);
    CHECK(now.impulse.friction.norm() > 0.01 * given);
    CHECK(now.impulse.pressure.norm() > 1e-4 * given);
    CHECK(now.points >= 40 * 30 * 4);  // what is broken may be split
    CHECK(now.mass_left == 0.0);
    CHECK(flow.momentum_residual().norm() < 1e-12 * given);
}

// Nodes around a block were as thin as it is smeared there. Their drag held all of it: by 6 % with Voellmy's law, by 35 %
// with Bingham's, which tore the edges off.
TEST_CASE("Friction that depends on depth slows an intact block as one of its own thickness", "[structured]") {
    const double slope = 0.4, depth = 1.5, end = 1.0, kappa = std::sqrt(1.0 + slope * slope);
    const BedLaw law = GENERATE(
        values<BedLaw>({bed::Voellmy{0.2, 200.0}, bed::Manning{0.08, 0.05}, bed::Bingham{300.0, 2000.0, 0.02}}));
    const bool some_grains = GENERATE(false, true);  // far off: there is a surface of grains then
    StructuredScene s;
    s.density = 2000.0, s.material.young = 5e6, s.bed_law = law;
    s.ground = terrain_ground([=](double, double) { return Vec2(-slope, 0.0); });
    s.grid = verify::grid_over({0, 0}, {60, 24}, 2.0);
    verify::StructuredBlock block;
    block.low = {4, 4}, block.high = {24, 20}, block.depth = depth, block.cohesion = 1e6, block.velocity = {4.0, 0.0};
    verify::add_block(s, block);
    const std::size_t whole = s.points.x.size();
    if (some_grains) {
        block.low = {50, 10}, block.high = {52, 12}, block.cohesion = 0.0, block.damage = 1.0;
        verify::add_block(s, block);
    }
    StructuredFlow flow(s);
    while (flow.status().time < end) flow.advance(end);
    // The block's own way down in small steps, by the same law: speeds are those along the map.
    const double gravity = 9.81, cosine = 1.0 / kappa, steps = 1e5;
    const BedState state{gravity * cosine / kappa, depth * cosine, kappa, cosine, gravity, s.density};
    double speed = 4.0;
    for (int n = 0; n < static_cast<int>(steps); ++n) {
        const double driven = speed + end / steps * gravity * slope * cosine * cosine;
        speed = std::visit([&](const auto& of) { return of.speed_after(state, speed, driven, end / steps); }, law);
    }
    CAPTURE(std::visit([](const auto& of) { return of.name; }, law), some_grains, speed);
    const StructuredPoints& q = flow.body().points;
    for (Index p = 0; p < q.count(); ++p) {
        if (q.id[p] >= static_cast<std::int64_t>(whole)) continue;
        // Velocities of leapfrog are half a step behind: 1e-2 s of 1 m/s2. Without grains steps are exact for a steady drive.
        CHECK(q.vx[p] == Approx(speed).epsilon(some_grains ? 5e-3 : 1e-3));
        CHECK(q.damage[p] == 0.0);
    }
}

TEST_CASE("Particles that run off the grid are counted with what they carry", "[structured]") {
    StructuredScene s = breaking(1e9);
    s.obstacles.clear();
    for (double& v : s.points.vy) v = -6.0;
    StructuredFlow flow(s);
    const double mass = flow.status().mass, given = flow.status().momentum.norm();
    while (flow.status().mass_left == 0.0) flow.advance(10.0);
    for (int step = 0; step < 50; ++step) flow.advance(10.0);
    CHECK(flow.status().points < 40 * 30 * 4);
    CHECK(flow.status().mass + flow.status().mass_left == Approx(mass).epsilon(1e-12));
    CHECK(flow.momentum_residual().norm() < 1e-12 * given);
}

TEST_CASE("Structured solids have the same bits for any number of threads", "[structured][threads]") {
    const int threads = omp_get_max_threads();
    std::vector<double> first;
    double damage = 0.0;
    for (const int count : {1, 2, 4}) {
        omp_set_num_threads(count);
        StructuredFlow flow(breaking());
        for (int step = 0; step < 200; ++step) flow.advance(10.0);
        const StructuredPoints& q = flow.body().points;
        std::vector<double> bits = {flow.status().kinetic, flow.status().impulse.friction.x(), flow.status().damage};
        for (const Array* array : {&q.x, &q.y, &q.vx, &q.xx, &q.damage})
            bits.insert(bits.end(), array->begin(), array->end());
        CHECK(flow.body().active.count() >= kTilesForThreads);
        if (count == 1) first = bits;
        CHECK(bits == first);
        damage = flow.status().damage;
    }
    omp_set_num_threads(threads);
    CHECK(damage > 0.0);
}

TEST_CASE("A particle that spreads becomes thinner as its area grows, and stands on its own weight", "[structured]") {
    StructuredScene s;
    s.grid = verify::grid_over({-3, -2}, {3, 2}, 0.1);
    s.ground = [](double, double) { return GroundGravity{0, 0, 2.0}; };
    s.material.young = 1e-3;  // holds nothing together
    verify::StructuredBlock block;
    block.low = {-1, -1}, block.cohesion = 1e9;
    verify::add_block(s, block);
    const double rate_x = 0.5, rate_y = -0.2, end = 0.5;
    for (std::size_t p = 0; p < s.points.x.size(); ++p)
        s.points.vx[p] = rate_x * s.points.x[p], s.points.vy[p] = rate_y * s.points.y[p];
    StructuredFlow flow(s);
    while (flow.status().time < end) flow.advance(end);
    const double depth = 1.0 / ((1.0 + rate_x * end) * (1.0 + rate_y * end));
    const StructuredPoints& q = flow.body().points;
    int inside = 0;
    for (Index p = 0; p < q.count(); ++p) {
        if (flow.position(p).cwiseAbs().maxCoeff() > 0.5) continue;
        CHECK(q.depth[p] == Approx(depth).epsilon(0.01));  // the step is a fiftieth of the time, of first order
        CHECK(q.zz[p] == Approx(-0.5 * 1700.0 * 2.0 * q.depth[p]).epsilon(1e-12));
        ++inside;
    }
    CHECK(inside > 100);
}

TEST_CASE("Neighbours that part unbroken are numerical fracture, and pieces are counted by mass", "[structured]") {
    StructuredScene s;
    s.grid = verify::grid_over({-1, -1}, {6, 3}, 0.1);
    s.ground = [](double, double) { return GroundGravity{0, 0, 0}; };
    verify::StructuredBlock block;
    block.cohesion = 1e9, block.high = {2.0, 1.0};
    verify::add_block(s, block);
    block.low = {2.0, 0.0}, block.high = {3.0, 1.0}, block.velocity = {1.0, 0.0};
    s.material.young = 1.0;  // holds nothing together
    verify::add_block(s, block);
    StructuredFlow flow(s);
    const Neighbours neighbours(flow, 0.055);
    CHECK(neighbours.pairs() == 59 * 20 + 60 * 19);
    CHECK(neighbours.torn(flow, 0.15).all == 0);
    CHECK(pieces(flow, {0.125, 2.0, 0.02}).size() == 1);
    while (flow.status().time < 1.0) flow.advance(1.0);
    const Neighbours::Torn torn = neighbours.torn(flow, 0.15);
    CHECK(torn.all >= 20);
    CHECK(torn.numerical == torn.all);
    const std::vector<double> two = pieces(flow, {0.125, 2.0, 0.02});
    REQUIRE(two.size() >= 2);
    CHECK(two[0] == Approx(2.0 / 3.0).margin(0.05));
    CHECK(two[1] == Approx(1.0 / 3.0).margin(0.05));
    CHECK(pieces(flow, {0.125, 0.0, 0.02}).empty());  // nothing is that whole
}

TEST_CASE("An obstacle's corner lets by what leaves it, and takes what enters by the nearest face", "[structured]") {
    Obstacle box;
    box.low = {0.0, 0.0}, box.high = {2.0, 1.0}, box.friction = 0.5;
    const auto met = [](const std::vector<Obstacle>& all, const Vec2& x, Vec2 v) {
        for (std::size_t n = 0; n < all.size(); ++n)
            if (const FaceBehind at = nearest_face(all, n, x, 1e-3); at.face >= 0) v = all[n].stopped(at.face, v);
        return v;
    };
    CHECK(met({box}, {-0.1, 0.5}, {1.0, 0.0}) == Vec2(1.0, 0.0));          // outside
    CHECK(met({box}, {0.1, 0.5}, {1.0, 2.0}) == Vec2(0.0, 1.5));           // braked along the face
    CHECK(met({box}, {0.1, 0.5}, {1.0, -0.3}) == Vec2(0.0, 0.0));          // stopped along it
    CHECK(met({box}, {0.1, 0.5}, {-1.0, 2.0}) == Vec2(-1.0, 2.0));         // leaves
    CHECK(met({box}, {1.0, 0.9}, {1.0, -1.0}) == Vec2(0.5, 0.0));          // through the top
    CHECK(met({box}, {2.0 + 1e-12, 0.5}, {-1.0, 0.0}) == Vec2(0.0, 0.0));  // the face itself
    // Of two side by side the seam is no face: there the front counts.
    Obstacle next = box;
    next.low.y() = 1.0, next.high.y() = 2.0;
    CHECK(met({box, next}, {0.4, 0.95}, {1.0, 0.0}) == Vec2(0.0, 0.0));
    CHECK(met({box, next}, {0.4, 1.0}, {1.0, 0.0}) == Vec2(0.0, 0.0));
    CHECK(met({box, next}, {0.4, 1.95}, {1.0, 0.0}) == Vec2(1.0, 0.0));  // an end is a face
    // In the corner of two walls both count.
    Obstacle west, south;
    west.high.x() = 0.0, south.high.y() = 0.0;
    CHECK(met({west, south}, {-0.2, -0.1}, {-1.0, -2.0}) == Vec2(0.0, 0.0));
}

TEST_CASE("The open share of nodes next to walls is the integral of their shape functions", "[structured]") {
    std::vector<Obstacle> walls(2);
    walls[0].high.x() = 0.0, walls[1].high.y() = 0.0;
    CHECK(open_share(walls, {0.0, 5.0}, 1.0, 0.0) == Approx(0.5).epsilon(1e-14));
    CHECK(open_share(walls, {1.0, 5.0}, 1.0, 0.0) == Approx(47.0 / 48.0).epsilon(1e-14));
    CHECK(open_share(walls, {-1.0, 5.0}, 1.0, 0.0) == Approx(1.0 / 48.0).epsilon(1e-12));
    CHECK(open_share(walls, {0.0, 0.0}, 1.0, 0.0) == Approx(0.25).epsilon(1e-14));  // the corner is covered once
    CHECK(open_share(walls, {5.0, 5.0}, 1.0, 0.0) == 1.0);
    CHECK(open_share(walls, {-5.0, 5.0}, 1.0, 0.25) == 0.25);
}

TEST_CASE("Pressure of grains is Ka where they spread and towards Kp where squeezed, along principal axes",
          "[structured]") {
    const Rankine k{1.0 / 3.0, 3.0};
    const Sym2 rest = earth_pressure({0, 0, 0}, 1.0, 9.81, k), spread = earth_pressure({1.0, 2.0, 0.0}, 1.0, 9.81, k),
               fast = earth_pressure({-50.0, 1.0, 0.0}, 1.0, 9.81, k),
               shear = earth_pressure({0, 0, 50.0}, 1.0, 9.81, k);
    CHECK(rest.xx == k.active);
    CHECK((rest.yy == k.active && rest.xy == 0.0));
    CHECK(spread.xx == Approx(k.active).epsilon(1e-14));
    CHECK(fast.xx == Approx(k.passive).epsilon(1e-9));
    CHECK(fast.yy == Approx(k.active).epsilon(1e-9));
    // Pure shear: spread along the diagonal, squeezed across it.
    CHECK(shear.xx == Approx(0.5 * (k.active + k.passive)).epsilon(1e-9));
    CHECK(shear.xy == Approx(0.5 * (k.active - k.passive)).epsilon(1e-9));
}

TEST_CASE("Four hyperbolic tangents at once are the library's to round-off", "[structured]") {
    double worst = 0.0;
    for (int n = -2000; n < 40000; n += 4) {
        Double4 x;
        for (int k = 0; k < 4; ++k) x[k] = 1e-3 * (n + k);
        const Double4 t = tanh_above_zero(x);
        for (int k = 0; k < 4; ++k) worst = std::max(worst, std::abs(t[k] - tanh_above_zero(x[k])));
        if (n + 3 <= 0) CHECK(!any(t != 0.0));
    }
    CHECK(worst < 3e-16);
}

TEST_CASE("What a step costs compared with the depth-averaged flow's", "[.cost]") {
    omp_set_num_threads(1);
    const auto cost = [](const char* what, double per, const verify::Measurement& m) {
        const double ns = 1e9 * m.wall_seconds / static_cast<double>(m.particles * m.steps);
        fmt::print("{}: {:.0f} ns a particle and step, {:.2f} of the flow's\n", what, ns, per > 0.0 ? ns / per : 1.0);
        return ns;
    };
    verify::Setup setup;
    setup.cells = 160;
    const verify::Measurement flow = verify::find_problem("radial_dam")->run(setup);
    const double per = cost("depth-averaged flow (radial_dam)", 0.0, flow);
    const auto run = [&](const char* what, const StructuredScene& scene, double end) {
        StructuredFlow body(scene);
        CHECK(cost(what, per, verify::run_structured(body, end)) > 0.0);
    };
    run("structured, elastic (2A)", verify::convex_block(200e3, 1.25), 3.0);
    run("structured, breaking (2B)", verify::convex_block(60e3, 1.25), 9.0);
    run("structured, grains (3C)", verify::valley_block(15e3, 0.1, 1.25), 8.0);
}
