// Material at rest sleeps: a run with sleep has the same bits as one without, and tiles do fall asleep and wake.
#include <algorithm>
#include <cstring>

#include <omp.h>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/depth_averaged.h"

using namespace frana;

namespace {

/// A slide comes down a ramp (x < 60 m) into a deposit that rests on a gentle slope, wider than the slide: it rests first,
/// is stirred where it is met, comes to rest again.
Scene slide_into_deposit() {
    Scene scene = verify::scene_on(230, 150, 1.0, [](double x, double y) {
        return (x < 60 ? 0.9 * (60 - x) : 0.05 * (60 - x)) + 0.3 * std::sin(0.2 * y);
    });
    scene.density = 1600.0;
    scene.bed_law = bed::Voellmy{0.45, 400.0};
    verify::fill(scene,
                 [](double x, double y) {
                     if (x > 30 && x < 48 && y > 20 && y < 60) return 2.0;
                     return x > 66 && x < 215 && y > 12 && y < 138 ? 1.0 : 0.0;
                 },
                 {2});
    Seeds& seeds = scene.particles;  // the slide is on its way
    for (Index p = 0; p < seeds.count(); ++p)
        if (seeds.x[p] < 60.0) seeds.vx[p] = 10.0;
    return scene;
}

struct Slept {
    Index most = 0, at_end = 0;
    bool woke = false;
};

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

bool same_particles(const Particles& a, const Particles& b) {
    if (a.id != b.id) return false;
    std::vector<std::pair<const void*, std::size_t>> of_b;
    b.each([&](const auto& array) { of_b.push_back({array.data(), array.size() * sizeof array[0]}); });
    std::size_t n = 0;
    bool equal = true;
    a.each([&](const auto& array) {
        const auto [data, bytes] = of_b[n++];
        equal = equal && bytes == array.size() * sizeof array[0] && std::memcmp(array.data(), data, bytes) == 0;
    });
    return equal;
}

bool same_status(const Status& a, const Status& b) {
    return same(a.time, b.time) && same(a.mass, b.mass) && same(a.kinetic, b.kinetic) &&
           same(a.potential, b.potential) && same(a.dissipated, b.dissipated) && same(a.max_speed, b.max_speed) &&
           same(a.max_depth, b.max_depth) && same(a.covered_area, b.covered_area) && same(a.front, b.front) &&
           same(a.momentum[0], b.momentum[0]) && same(a.momentum[1], b.momentum[1]) &&
           same(a.impulse[0], b.impulse[0]) && same(a.impulse[1], b.impulse[1]) &&
           same(a.p2g_mass_error, b.p2g_mass_error) && same(a.p2g_momentum_error, b.p2g_momentum_error) &&
           same(a.mean_speed, b.mean_speed) && same(a.mass_left, b.mass_left) && same(a.energy_left, b.energy_left) &&
           same(a.dt, b.dt) && a.particles == b.particles;
}

std::vector<Index> tiles_asleep(const Flow& flow) {
    std::vector<Index> tiles;
    for (const Index tile : flow.active.tile)
        if (flow.active.quiet[tile] >= kAsleep) tiles.push_back(tile);
    return tiles;
}

/// The time that a step may not pass. Steps of all lengths: what holds must not depend on them.
using Until = double (*)(const Status& now, int step);
double all_lengths(const Status& now, int step) { return step % 5 == 4 ? now.time + 0.3 * now.dt : 1e9; }

Slept compare(Scene scene, int steps, Until until_of = all_lengths) {
    DepthAveraged sleeper(scene);
    scene.scheme.sleep = false;
    DepthAveraged waker(scene);
    Slept slept;
    std::vector<Index> before;
    for (int step = 0; step < steps; ++step) {
        const double until = until_of(sleeper.status(), step);
        sleeper.advance(until);
        waker.advance(until);
        const std::vector<Index> now = tiles_asleep(sleeper.flow());
        slept.at_end = static_cast<Index>(now.size());
        slept.most = std::max(slept.most, slept.at_end);
        slept.woke = slept.woke || !std::includes(now.begin(), now.end(), before.begin(), before.end());
        before = now;
        CAPTURE(step, slept.at_end);
        REQUIRE(same_status(sleeper.status(), waker.status()));
        if (step % 10 == 9 || step == steps - 1)
            REQUIRE(same_particles(sleeper.flow().particles, waker.flow().particles));
        if (step % 60 != 59) continue;
        const Frame a = sleeper.frame(), b = waker.frame();
        for (const auto fields : {&Frame::particles, &Frame::nodes})
            for (std::size_t n = 0; n < (a.*fields).size(); ++n) {
                const Field &of_a = (a.*fields)[n], &of_b = (b.*fields)[n];
                CAPTURE(of_a.name);
                const std::size_t bytes = static_cast<std::size_t>(of_a.count * of_a.components) * sizeof(double);
                REQUIRE(std::memcmp(of_a.data, of_b.data, bytes) == 0);
            }
    }
    CHECK(tiles_asleep(waker.flow()).empty());
    return slept;
}

void check(const Scene& scene, int steps) {
    const Slept slept = compare(scene, steps);
    CAPTURE(slept.most, slept.at_end);
    CHECK(slept.most >= 20);
    CHECK(slept.woke);
}

}  // namespace

TEST_CASE("A deposit sleeps until a slide reaches it, with the bits of a run without sleep",
          "[solver][sleep][threads]") {
    check(slide_into_deposit(), 240);
}

TEST_CASE("Sleep changes no bit with walls, a yield stress, or any shape and transfer", "[solver][sleep]") {
    SECTION("walls") {
        Scene scene = slide_into_deposit();
        scene.sides = Sides::wall;
        check(scene, 130);
    }
    SECTION("deposits that lean on walls") {
        Scene scene = slide_into_deposit();
        scene.sides = Sides::wall;
        verify::fill(scene,
                     [](double x, double y) {
                         if (x > 30 && x < 48 && y > 20 && y < 60) return 2.0;
                         return x > 66 ? 1.0 : 0.0;
                     },
                     {2});
        for (Index p = 0; p < scene.particles.count(); ++p)
            if (scene.particles.x[p] < 60.0) scene.particles.vx[p] = 10.0;
        check(scene, 130);
    }
    SECTION("Bingham points on a Bingham bed") {
        Scene scene = slide_into_deposit();
        scene.rheology = rheology::Bingham{50.0, 300.0};
        scene.bed_law = bed::Bingham{20.0, 800.0, 0.3};
        check(scene, 130);
    }
    SECTION("held by a yield stress alone, on a bent bed") {
        Scene scene = slide_into_deposit();
        scene.bed_law = bed::Bingham{20.0, 3000.0, 0.0};
        compare(scene, 130);
    }
    SECTION("points leave") {
        Scene scene = slide_into_deposit();
        for (double& vx : scene.particles.vx) vx = vx > 0.0 ? -14.0 : 0.0;
        CHECK(compare(scene, 130).most >= 20);
    }
    SECTION("single precision") {
        Scene scene = slide_into_deposit();
        scene.scheme.precision = Precision::single;
        check(scene, 240);
    }
    SECTION("cubic") {
        Scene scene = slide_into_deposit();
        scene.scheme.shape = Shape::cubic;
        check(scene, 130);
    }
    SECTION("linear, FLIP, Pouliquen") {
        Scene scene = slide_into_deposit();
        scene.scheme.shape = Shape::linear;
        scene.scheme.transfer = Transfer::flip;
        scene.bed_law = bed::Pouliquen{0.45, 0.7, 0.3, 0.002, 0.6};
        compare(scene, 130);
    }
    SECTION("two threads") {
        omp_set_num_threads(2);
        check(slide_into_deposit(), 130);
        omp_set_num_threads(1);
    }
}

TEST_CASE("A pile that holds by less than a step's rounding is not left alone", "[solver][sleep]") {
    // A uniform sheet on a plane whose slope is the friction coefficient itself.
    Scene scene = verify::scene_on(120, 60, 1.0, [](double x, double) { return 100.0 - 0.3 * x; });
    scene.bed_law = bed::Coulomb{0.3};
    verify::fill(scene, [](double x, double y) { return x > 20 && x < 100 && y > 10 && y < 50 ? 1.0 : 0.0; }, {2});
    compare(scene, 120);
}

TEST_CASE("A sheet that a yield stress alone holds on a bent bed is not left alone when steps grow",
          "[solver][sleep]") {
    // A hollow: over a step the path bends and weighs more, by v.H.v with v = dt g / 4 where the slope is 1, the steepest
    // drive (g s / (1 + s^2)). That is 4e-5 g in steps of 0.4 s, 2.5e-4 g in steps of 1 s and 1e-3 g in the longest ones.
    Scene scene = verify::scene_on(80, 50, 50.0, [](double x, double) { return 2e-4 * (x - 5500.0) * (x - 5500.0); });
    const double depth = 0.5;
    scene.density = 1600.0;
    scene.bed_law = bed::Bingham{20.0, scene.density * depth * 0.5 * scene.gravity * (1.0 + 5e-4), 0.0};
    verify::fill(scene, [&](double x, double y) { return x > 1500 && x < 3800 && y > 400 && y < 2100 ? depth : 0.0; },
                 {2});
    const Slept slept =
        compare(scene, 60, [](const Status& now, int step) { return step < 30 ? now.time + 0.4 : 1e9; });
    CHECK(slept.most >= 4);
    CHECK(slept.woke);
}

TEST_CASE("Material asleep at an exit that opens leaves, and what stays has the bits of a run without sleep",
          "[solver][sleep]") {
    Scene scene = verify::scene_on(60, 40, 1.0, [](double x, double) { return 10.0 - 0.05 * x; });
    scene.bed_law = bed::Coulomb{0.45};
    verify::fill(scene, [](double x, double y) { return x > 12 && x < 48 && y > 8 && y < 32 ? 1.0 : 0.0; }, {2});
    DepthAveraged sleeper(scene);
    scene.scheme.sleep = false;
    DepthAveraged waker(scene);
    while (tiles_asleep(sleeper.flow()).empty()) {
        REQUIRE(sleeper.status().step < 3000);
        sleeper.advance(1e9), waker.advance(1e9);
    }
    // A window over the middle of a tile that sleeps, as far as the deposit goes.
    const Index tile = tiles_asleep(sleeper.flow()).front();
    const TileGrid& grid = sleeper.flow().grid;
    const Index i0 = grid.tile_i(tile) + kTile / 2, j0 = grid.tile_j(tile);
    std::vector<std::uint8_t> marks(static_cast<std::size_t>(scene.bed.geometry.size()), 0);
    for (Index j = j0; j < std::min(j0 + kTile, grid.ny()); ++j)
        for (Index i = i0; i < grid.nx(); ++i) marks[static_cast<std::size_t>(j * grid.nx() + i)] = 1;
    double inside = 0.0;
    const Particles& c = sleeper.flow().particles;
    for (Index p = 0; p < c.count(); ++p) {
        const auto near = [](double u) { return static_cast<Index>(std::floor(u + 0.5)); };
        if (marks[static_cast<std::size_t>(near(c.y[p]) * grid.nx() + near(c.x[p]))]) inside += c.mass[p];
    }
    REQUIRE(inside > 0.0);
    const NodeBox window{i0, j0, grid.nx() - i0, std::min(kTile, grid.ny() - j0)};
    sleeper.open_exits(window, true), waker.open_exits(window, true);
    CHECK(sleeper.status().mass_left == Approx(inside).epsilon(1e-13));
    CHECK(same_particles(sleeper.flow().particles, waker.flow().particles));
    double fastest = 0.0;
    for (int step = 0; step < 30; ++step) {
        sleeper.advance(1e9), waker.advance(1e9);
        CAPTURE(step);
        fastest = std::max(fastest, waker.status().max_speed_on_map);
        REQUIRE(same_status(sleeper.status(), waker.status()));
        REQUIRE(same_particles(sleeper.flow().particles, waker.flow().particles));
    }
    CHECK(fastest > 0.1);  // banks of 1 m fall into the gap
}
