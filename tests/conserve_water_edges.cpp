// Where free water comes in and goes out: sources, open sides, and sides that hold a level. Exact answers; volume,
// momentum and energy; same bits on any threads and when taken up again.
#include <omp.h>

#include <cmath>

#include "base/discharge.h"
#include "catch.h"
#include "checks/verify/exact_dam_break.h"
#include "checks/verify/water.h"
#include "observe/memory_archive.h"
#include "water_bits.h"

using namespace frana;

namespace {

constexpr double g = 9.81;

/// A discharge [m^3/s] and a speed [m/s] that do not change, across a channel at cell i.
WaterSource across(const GridGeometry& grid, Index i, double discharge, double speed, double end) {
    WaterSource source{{0.0, end}, {discharge, discharge}, {speed, speed}, {}};
    for (Index j = 0; j < grid.ny; ++j)
        source.places.push_back({i, j, 1.0 / static_cast<double>(grid.ny), Vec2(1.0, 0.0)});
    return source;
}

void go_to(WaterFlow& flow, double time) {
    while (flow.status().time < time) flow.advance(time);
}

/// Rises and falls, with a break between.
WaterSource hydrograph() {
    WaterSource source{{0.5, 1.5, 2.25, 3.0, 4.0}, {0.0, 4.0, 0.0, 0.0, 2.5}, {0.5, 2.0, 3.0, 1.0, 0.25}, {}};
    source.places = {{5, 6, 0.25, Vec2(0.6, 0.8)}, {6, 6, 0.5, Vec2(0.6, 0.8)}, {20, 17, 0.25, Vec2(-1.0, 0.0)}};
    return source;
}

/// A basin into which two of them run.
WaterScene fed_basin() {
    WaterScene s;
    s.grid = verify::cells_over(40, 30, 0.5);
    s.bed = [](double x, double y) { return 200.0 + 0.02 * x + 0.1 * std::sin(x) * std::cos(y); };
    s.sources = {hydrograph(), hydrograph()};
    s.sources[1].time = {1.0, 1.2, 2.0, 2.5, 2.6};
    s.friction = {WaterFriction::Law::manning, 0.03};
    return s;
}

/// Of all sources of a scene, by their tables [m3].
double by_tables(const WaterScene& scene, double time) {
    double sum = 0.0;
    for (const WaterSource& source : scene.sources) sum += volume_until(source, time);
    return sum;
}

/// With what went through sources and sides.
std::vector<double> bits_with_ledger(const WaterFlow& flow) {
    std::vector<double> bits = bits_of(flow);
    const WaterLedger& l = flow.status().ledger;
    for (const double number : {l.fed, l.left, l.entered, l.energy_out, l.momentum_left.x()}) bits.push_back(number);
    return bits;
}

/// Depth of uniform flow of q [m^2/s] down a plane, THEORY (12): s^2 b = g_z S with s = q / h.
double normal_depth(double q, double slope, double manning) {
    const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    return std::pow(q * q * manning * manning / (slope * std::pow(cosine, 13.0 / 3.0)), 0.3);
}

}  // namespace

TEST_CASE("What has come through of a table between two times is its integrals there", "[water][inflow]") {
    const WaterSource of = hydrograph();
    const Through all = between(of, -10.0, 10.0);
    CHECK(all.volume == Approx(2.0 + 1.5 + 1.25).epsilon(1e-15));
    CHECK(volume_until(of, 10.0) == Approx(all.volume).epsilon(1e-15));
    // Linear times linear: Simpson's rule is exact.
    const auto simpson = [](double length, double a, double m, double b) { return length * (a + 4.0 * m + b) / 6.0; };
    CHECK(all.momentum == Approx(simpson(1.0, 0.0, 2.0 * 1.25, 4.0 * 2.0) + simpson(0.75, 8.0, 2.0 * 2.5, 0.0) +
                                 simpson(1.0, 0.0, 1.25 * 0.625, 2.5 * 0.25))
                              .epsilon(1e-14));
    CHECK(between(of, 2.3, 2.9).volume == 0.0);
    CHECK(between(of, 5.0, 6.0).volume == 0.0);
    CHECK(between(of, 0.75, 1.25).volume == Approx(0.5 * 2.0).epsilon(1e-15));
}

TEST_CASE("Sources bring the volume of their tables, however long the steps", "[water][inflow][conserve]") {
    WaterScene s = fed_basin();
    s.cfl = GENERATE(0.45, 0.05);
    WaterFlow flow(s);
    double worst = 0.0;
    while (flow.status().time < 5.0) {
        flow.advance(5.0);
        worst = std::max(worst, std::abs(flow.status().volume - by_tables(s, flow.status().time)));
    }
    const double whole = by_tables(s, 5.0);
    CHECK(whole > 5.0);
    CHECK(worst < 1e-13 * whole);  // round-off of 1200 cells and some hundred steps
    CHECK(flow.status().ledger.fed == Approx(whole).epsilon(1e-13));
    const WaterLedger& l = flow.status().ledger;
    CHECK(flow.momentum_residual().norm() < 1e-12 * (l.ground.norm() + l.walls.norm() + l.friction.norm()));
}

TEST_CASE("The momentum of a source is that of its table, and stays where nothing takes it",
          "[water][inflow][conserve]") {
    WaterScene s = fed_basin();
    s.bed = [](double, double) { return 0.0; };
    s.friction = {};
    s.gravity = 1e-12;  // a free jet: its pressure moves nothing
    WaterFlow flow(s);
    go_to(flow, 1.9);  // before any of it is at a wall
    Vec2 given(0, 0);
    for (const WaterSource& source : s.sources)
        for (const WaterSource::Place& at : source.places)
            given += at.share * between(source, 0.0, 1.9).momentum * at.towards;
    CHECK(flow.status().ledger.walls.norm() < 1e-9 * given.norm());
    CHECK((flow.status().momentum - given).norm() < 1e-9 * given.norm());
    CHECK((flow.status().ledger.momentum_left + given).norm() < 1e-13 * given.norm());
}

TEST_CASE("Energy that sources bring is what the water gains and what is lost as both mix",
          "[water][inflow][conserve]") {
    WaterScene s;
    s.grid = verify::cells_over(30, 20, 0.5);
    s.bed = [](double, double) { return 40.0; };
    s.start = [](double, double) { return WaterState{0.5}; };
    s.sides[1] = WaterSide::free;
    // Over all of it, away from the wall and out of the open side: there is no bore.
    WaterSource rising{{0.0, 4.0}, {3.0, 9.0}, {0.6, 0.6}, {}};
    const Index nx = s.grid.nx, ny = s.grid.ny;
    for (Index j = 0; j < ny; ++j)
        for (Index i = 0; i < nx; ++i)
            rising.places.push_back({i, j, 1.0 / static_cast<double>(nx * ny), Vec2(1.0, 0.0)});
    s.sources = {rising};
    s.gravity = 1e-2;
    WaterFlow flow(s);
    const double start = verify::energy_of(flow);
    go_to(flow, 0.5);
    const WaterLedger& l = flow.status().ledger;
    const double brought = -l.energy_out + s.gravity * 40.0 * (l.fed - l.left);  // 40 m is the datum
    CHECK(l.braked > 0.01 * brought);
    const double gained = verify::energy_of(flow) - start;
    CAPTURE(gained, brought, l.braked, l.left);
    // What is left is the scheme's, at the wall and at the side.
    CHECK(std::abs(gained - (brought - l.braked)) < 0.02 * l.braked);
}

TEST_CASE("Sources: same bits on any number of threads, and when taken up again within a table",
          "[water][inflow][conserve][threads]") {
    const WaterScene s = fed_basin();
    const auto end_of = [&](int threads) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        WaterFlow flow(s);
        go_to(flow, 3.5);
        omp_set_num_threads(before);
        return bits_with_ledger(flow);
    };
    const std::vector<double> one = end_of(1);
    CHECK(end_of(3) == one);
    WaterFlow straight(s), resumed(s);
    while (straight.status().time < 1.7) straight.advance(3.5);  // in the middle of both tables
    MemoryArchive kept;
    straight.serialize(kept);
    resumed.serialize(kept.rewind());
    go_to(resumed, 3.5);
    CHECK(bits_with_ledger(resumed) == one);
}

TEST_CASE("Water fed at the head of a plane comes to its normal depth, and leaves as fast as it comes",
          "[water][inflow][conserve]") {
    const double slope = GENERATE(0.01, 0.5), manning = 0.04, q = 0.8;
    WaterScene s;
    s.grid = verify::cells_over(60, 4, 2.0);
    s.bed = [=](double x, double) { return 500.0 - slope * x; };
    s.friction = {WaterFriction::Law::manning, manning};
    s.sides[1] = WaterSide::free;
    const double width = 8.0, depth = normal_depth(q, slope, manning);
    s.sources = {across(s.grid, 2, q * width, q / depth, 1e4)};
    WaterFlow flow(s);
    go_to(flow, 3000.0);  // the front needs 120 m at 0.5 m/s
    CAPTURE(slope, depth);
    // Slow flow feels its outlet upstream; there the ground goes on as it is, and uniform flow with it.
    for (const Index i : {30, 45, 59})
        for (const Index j : {0, 3}) {
            CHECK(flow.at(i, j).depth == Approx(depth).epsilon(1e-9));
            CHECK(flow.at(i, j).u == Approx(q / depth).epsilon(1e-9));
        }
    const WaterLedger before = flow.status().ledger;
    flow.advance(4000.0);
    const double dt = flow.status().dt;
    CHECK(flow.status().ledger.left - before.left == Approx(q * width * dt).epsilon(1e-9));
    const double fed = flow.status().ledger.fed;
    // Sums of 10^4 equal parts, whose round-off is the same each time.
    CHECK(fed == Approx(q * width * flow.status().time).epsilon(1e-12));
    CHECK(std::abs(flow.volume_residual()) < 1e-12 * fed);
    const WaterLedger& l = flow.status().ledger;
    CHECK(flow.momentum_residual().norm() < 1e-12 * (l.ground.norm() + l.friction.norm()));
}

// Fast flow feels nothing from downstream, and after a few metres nothing from upstream: each zone has its own normal depth.
// After 20 m what is left of the source and of the border is 5e-8. (Faster than 1.5 times waves roll waves would grow.)
TEST_CASE("Water that runs from one roughness onto another has the normal depth of each", "[water][inflow][zones]") {
    const double slope = 0.1, q = 0.8, border = 60.0, smooth = 0.06, rough = 0.08;  // Froude numbers of 1.4 and 1.1
    const auto n_at = [=](double x, double) { return x < border ? smooth : rough; };
    WaterScene s;
    s.grid = verify::cells_over(60, 4, 2.0);
    s.bed = [=](double x, double) { return 500.0 - slope * x; };
    s.sides[1] = WaterSide::free;
    s.sources = {across(s.grid, 2, q * 8.0, q / normal_depth(q, slope, smooth), 1e4)};
    const auto check = [&](const char* law) {
        WaterFlow flow(s);
        go_to(flow, 600.0);
        for (const auto& [i, n] : {std::pair<Index, double>{25, smooth}, {45, rough}, {58, rough}}) {
            const double depth = normal_depth(q, slope, n);
            CAPTURE(law, i, depth, flow.at(i, 1).depth);
            CHECK(flow.at(i, 1).depth == Approx(depth).epsilon(1e-6));
            CHECK(flow.at(i, 1).u == Approx(q / depth).epsilon(1e-6));
        }
        CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().ledger.fed);
    };
    s.friction = {WaterFriction::Law::manning, 0.5};  // its number is not asked for
    s.friction_at = n_at;
    check("water.friction");
    std::vector<bed::Manning> laws;
    for (Index j = 0; j < s.grid.ny; ++j)
        for (Index i = 0; i < s.grid.nx; ++i) laws.push_back({n_at(s.grid.x(i), s.grid.y(j))});
    s.bed_laws = std::make_shared<const bed::LawMap>(bed::law_map(laws));
    s.friction_at = {};
    check("material.bed");
}

TEST_CASE("The same roughness in all cells changes no bit of the water; zones none by threads or a new start",
          "[water][zones][threads]") {
    WaterScene s;
    s.grid = verify::cells_over(64, 40, 2.0);
    s.bed = [](double x, double y) { return 500.0 - 0.2 * x + 0.01 * (y - 40.0) * (y - 40.0); };
    s.start = [](double x, double y) {
        return WaterState{std::hypot(x - 30.0, y - 40.0) < 15.0 ? 2.0 : 0.0, 1.0, 0.5};
    };
    for (auto& side : s.sides) side = WaterSide::free;
    s.friction = {WaterFriction::Law::darcy_weisbach, 0.2};
    const auto bits_at_end = [](const WaterScene& scene) {
        WaterFlow flow(scene);
        go_to(flow, 8.0);
        return bits_with_ledger(flow);
    };
    const auto plain = bits_at_end(s);
    s.friction.coefficient = 9.0;  // is not asked for
    s.friction_at = [](double, double) { return 0.2; };
    CHECK(bits_at_end(s) == plain);
    s.friction_at = [](double x, double y) { return x < 50.0 ? 0.1 + 0.001 * y : 0.6; };
    const int before = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto alone = bits_at_end(s);
    CHECK(alone != plain);
    omp_set_num_threads(2);
    CHECK(bits_at_end(s) == alone);
    omp_set_num_threads(before);
    WaterFlow straight(s), resumed(s);
    MemoryArchive kept;
    go_to(straight, 4.0);
    straight.serialize(kept);
    resumed.serialize(kept.rewind());
    go_to(straight, 8.0), go_to(resumed, 8.0);
    CHECK(bits_with_ledger(resumed) == bits_with_ledger(straight));
}

TEST_CASE("A bore goes out of a free side as if the channel went on", "[water][conserve]") {
    // Stoker's dam break; what is behind its bore has the middle state, and that has the whole channel in the end.
    const verify::Stoker wave(1.0, 0.2);
    WaterScene s;
    s.grid = verify::cells_over(200, 3, 0.5);
    s.start = [](double x, double) { return WaterState{x < 60.0 ? 1.0 : 0.2}; };
    s.sides[1] = WaterSide::free;
    WaterFlow flow(s);
    go_to(flow, 18.0);  // the bore is at the side after 40 m / 2.9 m/s = 14 s; the fan's head is at the wall after 19 s
    double error = 0.0, sum = 0.0;
    for (Index i = 0; i < 200; ++i) {
        const double exact = wave.at((s.grid.x(i) - 60.0) / 18.0).depth;
        error += std::abs(flow.at(i, 1).depth - exact), sum += exact;
    }
    CHECK(60.0 + 18.0 * wave.shock > 100.0);
    CHECK(error < 0.005 * sum);  // verification.txt: 5.9e-3 on 100 cells with the bore inside, 3.1e-3 on 200
    // As it passes the side it leaves a slower wave, which goes back by |u - c| = 0.4 m/s.
    for (Index i = 150; i < 190; ++i) CHECK(flow.at(i, 1).depth == Approx(wave.hm).epsilon(1e-3));
    for (Index i = 190; i < 200; ++i) CHECK(flow.at(i, 1).depth == Approx(wave.hm).epsilon(0.04));
    CHECK(flow.status().ledger.entered == 0.0);
}

namespace {

/// A bump in a channel, smooth enough for its cells.
double bump(double x) { return 0.2 * std::exp(-0.05 * (x - 40.0) * (x - 40.0)); }

/// Depth over ground b of the slow flow of q with the energy height of depth h0 over none, by Newton's method.
double bernoulli(double q, double h0, double b) {
    const double head = h0 + q * q / (2.0 * g * h0 * h0) - b;
    double h = h0;
    for (int n = 0; n < 50; ++n) h -= (h + q * q / (2.0 * g * h * h) - head) / (1.0 - q * q / (g * h * h * h));
    return h;
}

/// Fed at one end, held at a level of 1 m at the other.
WaterScene over_a_bump(Index cells, double q) {
    WaterScene s;
    s.grid = verify::cells_over(cells, 3, 80.0 / static_cast<double>(cells));
    s.bed = [](double x, double) { return bump(x); };
    s.steep = false;
    s.start = [](double x, double) { return WaterState{1.0 - bump(x)}; };
    s.sides = {WaterSide::wall, WaterSide::level, WaterSide::wall, WaterSide::wall};
    s.side_levels[1] = 1.0;
    s.sources = {across(s.grid, 1, q * 3.0 * s.grid.cell, q, 1e5)};
    return s;
}

}  // namespace

TEST_CASE("Slow flow over a bump conserves its energy, and stands at its outlet's level there", "[water][conserve]") {
    const double q = 1.0;
    double last = 0.0;
    for (const Index cells : {40, 80}) {
        WaterFlow flow(over_a_bump(cells, q));
        go_to(flow, 600.0);  // some eight times there and back at sqrt(g h)
        const Index first = cells / 4;
        double error = 0.0, change = 0.0;
        for (Index i = first; i < cells; ++i) {
            const double x = flow.body().grid.geometry().x(i), exact = bernoulli(q, 1.0, bump(x));
            error += std::abs(flow.at(i, 1).depth - exact), change += exact;
            CHECK(flow.at(i, 1).depth * flow.at(i, 1).u == Approx(q).epsilon(4e-2));  // of cells, not of faces
        }
        error /= change;
        CAPTURE(cells, error, flow.at(cells / 2, 1).depth, bernoulli(q, 1.0, 0.2));
        CHECK(flow.surface(cells - 1, 1) == Approx(1.0).epsilon(1e-4));
        CHECK(error < (cells == 40 ? 6e-3 : 2e-3));
        if (last > 0.0) CHECK(last / error > 2.5);  // second order, on a bump of a few cells
        last = error;
        const WaterLedger before = flow.status().ledger;
        flow.advance(700.0);
        CHECK(flow.status().ledger.left - before.left ==
              Approx(q * 3.0 * flow.body().grid.cell() * flow.status().dt).epsilon(1e-3));
        CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().ledger.fed);
    }
}

TEST_CASE("Sides that hold the level of a lake leave it at rest; a lower one drains it to that level",
          "[water][conserve]") {
    WaterScene s;
    s.grid = verify::cells_over(60, 45, 0.5);
    s.bed = [](double x, double y) { return 999.0 + 0.4 * std::sin(x) * std::cos(0.7 * y); };
    s.start = [bed = s.bed](double x, double y) { return WaterState{std::max(0.0, 1000.0 - bed(x, y))}; };
    s.sides.fill(WaterSide::level);
    s.side_levels.fill(1000.0);
    {
        WaterFlow flow(s);
        for (int step = 0; step < 200; ++step) flow.advance(1e3);
        CHECK(flow.status().max_speed < 1e-11);  // round-off of 1 m at 1000 m above the sea
        CHECK(std::abs(flow.status().volume - flow.status().volume_given) < 1e-11 * flow.status().volume_given);
    }
    s.grid = verify::cells_over(60, 4, 0.5);
    s.side_levels[1] = 999.8;
    s.sides = {WaterSide::wall, WaterSide::level, WaterSide::wall, WaterSide::wall};
    s.friction = {WaterFriction::Law::manning, 0.1};
    WaterFlow flow(s);
    go_to(flow, 300.0);
    for (Index i = 0; i < 60; ++i) CHECK(flow.surface(i, 2) == Approx(999.8).margin(1e-3));
    CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().volume_given);
    const WaterLedger& l = flow.status().ledger;
    CHECK(flow.momentum_residual().norm() < 1e-12 * (l.ground.norm() + l.walls.norm() + l.friction.norm()));
    // A level below the ground holds nothing back: all runs out there.
    s.side_levels[1] = 990.0;
    s.bed = [](double x, double) { return 999.0 - 0.02 * x; };
    WaterFlow falls(s);
    go_to(falls, 300.0);
    CHECK(falls.status().volume < 0.01 * falls.status().volume_given);
    CHECK(falls.status().ledger.entered == 0.0);
}

TEST_CASE("A side at a level lets water in until it stands at that level", "[water][conserve]") {
    WaterScene s;
    s.grid = verify::cells_over(40, 3, 1.0);
    s.bed = [](double x, double) { return 10.0 + 0.05 * x; };  // above the level from x = 20 m on
    s.sides[0] = WaterSide::level;
    s.side_levels[0] = 11.0;
    s.friction = {WaterFriction::Law::manning, 0.1};
    WaterFlow flow(s);
    go_to(flow, 3000.0);  // the side gives waves back: they swing until friction has stopped them
    for (Index i = 0; i < 18; ++i) CHECK(flow.surface(i, 1) == Approx(11.0).margin(1e-3));
    CHECK(flow.at(30, 1).depth < 1e-3);
    const WaterLedger& l = flow.status().ledger;
    CHECK(l.entered - l.left == Approx(flow.status().volume).epsilon(1e-12));
}

TEST_CASE("A lake that comes in where the last tile is a cell wide loses nothing to the next", "[water][conserve]") {
    WaterScene s;
    s.grid = verify::cells_over(2 * kTile + 1, 5, 1.0);
    const bool held = GENERATE(true, false);
    s.sides[1] = held ? WaterSide::level : WaterSide::open;
    s.side_levels[1] = 2.0;
    if (!held) s.level = 2.0;
    WaterFlow flow(s);
    for (int step = 0; step < 20; ++step) {
        flow.advance(1e3);
        CHECK(std::abs(flow.volume_residual()) < 1e-13 * flow.status().volume);
    }
    CHECK(flow.status().ledger.entered > 10.0);
}
