// Sides of free water where it falls out, and where a lake beyond is held at its level: exact discharges and levels.
#include <omp.h>

#include <cmath>

#include "catch.h"
#include "checks/verify/water.h"
#include "observe/memory_archive.h"
#include "water_bits.h"

using namespace frana;

namespace {

constexpr double g = 9.81;
/// Of sqrt(g H^3): what flows over a broad weir from a lake H above it.
const double kWeir = std::pow(2.0 / 3.0, 1.5);

void go_to(WaterFlow& flow, double time) {
    while (flow.status().time < time) flow.advance(time);
}

/// A channel without steep slopes, closed but for its ends.
WaterScene channel(double length, Index cells) {
    WaterScene s;
    s.grid = verify::cells_over(cells, 3, length / static_cast<double>(cells));
    s.steep = false;
    return s;
}

double width(const WaterScene& s) { return 3.0 * s.grid.cell; }

/// Between two times, per width [m^2/s].
double left_between(WaterFlow& flow, const WaterScene& s, double from, double to) {
    go_to(flow, from);
    const double before = flow.status().ledger.left;
    go_to(flow, to);
    return (flow.status().ledger.left - before) / (width(s) * (to - from));
}

/// A weir of 0.2 m in the middle of 80 m, smooth enough for its cells.
double weir(double x) { return 0.2 * std::exp(-0.05 * (x - 40.0) * (x - 40.0)); }

/// Depth [m] of flow q [m^2/s] in a level channel with Manning's n, a way up from where it is h deep: the head rises by
/// n^2 q^2 / h^(10/3) a metre. By the midpoint rule.
double depth_above(double q, double h, double way, double n) {
    constexpr int kParts = 20000;
    const double dx = way / kParts;
    const auto rises = [&](double at) {
        return q * q * n * n / std::pow(at, 10.0 / 3.0) / (1.0 - q * q / (g * at * at * at));
    };
    for (int part = 0; part < kParts; ++part) h += dx * rises(h + 0.5 * dx * rises(h));
    return h;
}

double head_of(double q, double h) { return h + q * q / (2.0 * g * h * h); }

}  // namespace

// It was a wall to still water: nothing left.
TEST_CASE("Still water falls out where the ground ends as from a dam that breaks there", "[water][conserve]") {
    const WaterSide is = GENERATE(WaterSide::open, WaterSide::level);
    const std::size_t side = GENERATE(0, 1);
    WaterScene s = channel(100.0, 200);
    s.bed = [](double, double) { return 50.0; };
    s.start = [](double, double) { return WaterState{1.0}; };
    s.sides[side] = is;
    s.side_levels[side] = GENERATE(49.999, 10.0, 50.3);  // the critical depth is 4/9 m
    CAPTURE(side, s.side_levels[side]);
    WaterFlow flow(s);
    const double c = std::sqrt(g), exact = 8.0 / 27.0 * c * c * c / g;
    // The fan reaches the wall after 32 s. On a grid it starts as a wave of some cells.
    CHECK(left_between(flow, s, 10.0, 30.0) == Approx(exact).epsilon(1e-3));
    CHECK(flow.status().ledger.left == Approx(exact * 30.0 * width(s)).epsilon(7.6e-3));  // as water_ritter's depth
    const Index last = side == 0 ? 0 : 199;
    CHECK(flow.at(last, 1).depth == Approx(4.0 / 9.0).epsilon(0.03));  // the middle of a cell in a fan
    CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().volume_given);
    const WaterLedger& l = flow.status().ledger;
    CHECK(flow.momentum_residual().norm() < 1e-12 * l.walls.norm());
    CHECK(l.entered == 0.0);
}

TEST_CASE("Still water on level ground stays at a free side, on ground that falls it leaves", "[water][conserve]") {
    WaterScene s = channel(40.0, 40);
    s.start = [](double, double) { return WaterState{1.0}; };
    s.sides[1] = WaterSide::free;
    WaterFlow stays(s);
    go_to(stays, 20.0);
    CHECK((stays.status().ledger.left == 0.0 && stays.status().max_speed == 0.0));
    s.bed = [](double x, double) { return -0.01 * x; };
    s.start = [](double x, double) { return WaterState{1.0 + 0.01 * x}; };
    WaterFlow leaves(s);
    go_to(leaves, 20.0);
    CHECK(leaves.status().ledger.left > 0.01 * leaves.status().volume_given);
}

TEST_CASE("Where friction holds what stands, an open side lets go only what moves", "[water][conserve]") {
    WaterScene s = channel(40.0, 40);
    s.start = [](double, double) { return WaterState{1.0}; };
    s.sides[1] = WaterSide::open;
    s.bed_law = bed::Coulomb{0.4};
    WaterFlow flow(s);
    go_to(flow, 5.0);
    CHECK(flow.status().ledger.left == 0.0);
}

// It let a third of it in: the water beyond was at rest, so u + 2 c came in instead of the energy.
TEST_CASE("From a held lake over a weir flows what Bernoulli has", "[water][conserve]") {
    const double exact = kWeir * std::sqrt(g);  // 1 m above the weir
    double last = INFINITY;
    for (const Index cells : {80, 160}) {
        WaterScene s = channel(80.0, cells);
        s.bed = [](double x, double) { return weir(x); };
        s.start = [](double x, double) { return WaterState{1.0 - weir(x)}; };
        s.sides = {WaterSide::level, WaterSide::open, WaterSide::wall, WaterSide::wall};
        s.side_levels[0] = 1.2;
        WaterFlow flow(s);
        const double q = left_between(flow, s, 500.0, 510.0), error = std::abs(q / exact - 1.0);
        const WaterState in = flow.at(0, 1);
        CAPTURE(cells, q, exact, in.depth, in.u);
        CHECK(error < 0.01);
        CHECK(error < 0.5 * last);
        last = error;
        CHECK(in.depth + in.u * in.u / (2.0 * g) == Approx(1.2).epsilon(1e-3));
        const WaterLedger& l = flow.status().ledger;
        CHECK(std::abs(flow.volume_residual()) < 1e-12 * l.entered);
        CHECK(flow.momentum_residual().norm() < 1e-12 * (l.walls.norm() + l.ground.norm()));
    }
}

TEST_CASE("A channel between two held lakes carries what friction and backwater let it", "[water][conserve]") {
    const double length = 200.0, n = 0.03, upper = 1.2, lower = 0.6;
    double q = 0.1, most = 1.4;  // critical over the lower depth: 1.46
    for (int halved = 0; halved < 50; ++halved) {
        const double middle = 0.5 * (q + most);
        (head_of(middle, depth_above(middle, lower, length, n)) > upper ? most : q) = middle;
    }
    WaterScene s = channel(length, 100);
    s.start = [](double, double) { return WaterState{1.0}; };
    const bool mirrored = GENERATE(false, true);
    const std::size_t up = mirrored ? 1 : 0;
    s.sides[0] = s.sides[1] = WaterSide::level;
    s.side_levels[up] = upper, s.side_levels[1 - up] = lower;
    s.friction = {WaterFriction::Law::manning, n};
    WaterFlow flow(s);
    const double found = left_between(flow, s, 900.0, 910.0);
    CAPTURE(q, found);
    CHECK(found == Approx(q).epsilon(0.01));  // a cell is 1 % of the channel
    const WaterState in = flow.at(mirrored ? 99 : 0, 1), out = flow.at(mirrored ? 0 : 99, 1);
    CHECK(in.depth == Approx(depth_above(q, lower, length - 1.0, n)).epsilon(5e-3));  // half a cell before the sides
    CHECK(out.depth == Approx(depth_above(q, lower, 1.0, n)).epsilon(5e-3));
    // What enters has the energy of the lake's level.
    const WaterLedger before = flow.status().ledger;
    flow.advance(1e3);
    const WaterLedger& l = flow.status().ledger;
    const double brought = g * upper * (l.entered - before.entered),
                 taken = (g * out.depth + 0.5 * out.u * out.u) * (l.left - before.left);
    CHECK(l.energy_out - before.energy_out == Approx(taken - brought).epsilon(1e-2));
}

TEST_CASE("Onto dry ground a held lake flows as over a broad weir", "[water][conserve]") {
    WaterScene s = channel(100.0, 100);
    s.sides[0] = WaterSide::level;
    s.side_levels[0] = 1.0;
    WaterFlow flow(s);
    go_to(flow, 10.0);
    CHECK(flow.status().ledger.entered ==
          Approx(kWeir * std::sqrt(g) * 10.0 * width(s)).epsilon(1e-3));  // the fan starts as a wave of some cells
    const double c = std::sqrt(g * 2.0 / 3.0);
    CHECK(flow.status().max_speed < 3.0 * c);  // its front is that of a dam break
}

TEST_CASE("A wave that meets the inflow of a held lake comes back as its Froude number has it", "[water][conserve]") {
    const double froude = GENERATE(0.2, 0.5), c = std::sqrt(g), u = froude * c;
    WaterScene s = channel(200.0, 400);
    s.sides[0] = WaterSide::level, s.sides[1] = WaterSide::free;
    s.side_levels[0] = 1.0 + u * u / (2.0 * g);
    const double high = 1e-3;
    s.start = [=](double x, double) {  // runs against the flow
        const double h = 1.0 + high * std::exp(-std::pow((x - 60.0) / 8.0, 2));
        return WaterState{h, u - 2.0 * (std::sqrt(g * h) - c)};
    };
    WaterFlow flow(s);
    go_to(flow, 60.0 / (c - u) + 60.0 / (c + u));  // there and back
    double found = 0.0;
    for (Index i = 80; i < 160; ++i) found = std::min(found, flow.at(i, 1).depth - 1.0);
    const double exact = -(1.0 - froude) / (1.0 + froude) * high;
    CAPTURE(froude, found, exact);
    CHECK(found == Approx(exact).epsilon(0.03));  // the limiter takes some off a crest that runs 240 cells
}

TEST_CASE("Held lakes around rough ground: same bits on any threads and when taken up again, all of it counted",
          "[water][conserve][threads]") {
    WaterScene s;
    s.grid = verify::cells_over(60, 45, 0.5);
    s.bed = [](double x, double y) { return 999.0 + 0.4 * std::sin(x) * std::cos(0.7 * y); };
    s.sides = {WaterSide::level, WaterSide::level, WaterSide::open, WaterSide::level};
    s.side_levels = {1000.0, 999.2, 0.0, 999.7};
    s.friction = {WaterFriction::Law::manning, 0.03};
    const auto bits_at_end = [&](int threads) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        WaterFlow flow(s);
        go_to(flow, 10.0);
        omp_set_num_threads(before);
        CHECK((flow.status().ledger.entered > 0.0 && flow.status().ledger.left > 0.0));
        CHECK(std::abs(flow.volume_residual()) < 1e-12 * flow.status().ledger.entered);
        const WaterLedger& l = flow.status().ledger;
        CHECK(flow.momentum_residual().norm() < 1e-12 * (l.ground.norm() + l.walls.norm() + l.friction.norm()));
        return bits_of(flow);
    };
    const auto one = bits_at_end(1);
    CHECK(bits_at_end(3) == one);
    WaterFlow straight(s), resumed(s);
    MemoryArchive kept;
    while (straight.status().time < 4.0) straight.advance(10.0);
    straight.serialize(kept);
    resumed.serialize(kept.rewind());
    go_to(resumed, 10.0);
    CHECK(bits_of(resumed) == one);
}
