// The vectorised transfers are held to the plain ones, point by point and node by node.
#include <random>

#include "analytic_scene.h"
#include "catch.h"
#include "shallow/transfer.h"
#include "shallow/two_cell_wave.h"
#include "terrain/holes.h"

using namespace frana;

namespace {

constexpr Index kNodesX = 70, kNodesY = 50;
constexpr double kRoundOff = 1e-13;  ///< sums of some tens of terms, each right to a few units in the last place

/// Points of every kind: sheared and needle-like domains, domains wider than a cell, points at the sides, fast and at
/// rest, dry and deep.
struct Crowd {
    explicit Crowd(const Scene& scene, unsigned seed) : flow(scene) {
        std::mt19937 random(seed);
        const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
        Particles& c = flow.particles;
        c.resize(3001);
        for (Index p = 0; p < c.count(); ++p) {
            c.x[p] = p % 50 == 0 ? 0.0 : between(0.0, kNodesX - 1.0);
            c.y[p] = p % 51 == 0 ? kNodesY - 1.0 : between(0.0, kNodesY - 1.0);
            const double speed = p % 7 == 0 ? 0.0 : 3.0;
            c.vx[p] = between(-speed, speed), c.vy[p] = between(-speed, speed);
            for (auto* gradient : {&c.cxx, &c.cxy, &c.cyx, &c.cyy}) (*gradient)[p] = between(-1.0, 1.0);
            c.mass[p] = between(100.0, 5000.0);
            const double size = p % 11 == 0 ? 2.5 : p % 13 == 0 ? 0.01 : 0.6;
            for (auto* edge : {&c.r1x, &c.r1y, &c.r2x, &c.r2y}) (*edge)[p] = between(-size, size);
            c.depth[p] = p % 17 == 0 ? 0.0 : between(0.01, 3.0);
            c.id[p] = p;
        }
        TileSorter().sort(c, flow.grid, {}, flow.active);
    }
    Flow flow;
};

Scene scene_with(Sides sides, bool rheology, bool hole) {
    Scene scene = verify::scene_on(kNodesX, kNodesY, 2.0, [](double x, double y) { return 0.3 * x - 0.2 * y; });
    scene.sides = sides;
    scene.density = 1800.0;
    if (rheology) scene.rheology = rheology::Bingham{50.0, 300.0};
    if (hole) scene.bed.at(20, 20) = std::numeric_limits<double>::quiet_NaN();
    return scene;
}

void check_close(double a, double b, double scale, const char* what, Index k) {
    if (std::abs(a - b) <= kRoundOff * scale) return;
    FAIL_CHECK(what << ' ' << k << ": " << a << " is not " << b);
}

void compare_nodes(Flow& a, Flow& b) {
    const double mass = 5e4, momentum = 3.0 * mass, force = 1e7;
    for (const Index tile : a.active.work)  // one by one: Catch2 knows no threads
        for_each_node_of(a.grid, tile, [&](Index k, Index, Index) {
            check_close(a.nodes.mass[k], b.nodes.mass[k], mass, "mass", k);
            check_close(a.nodes.deposits()[k].px, b.nodes.deposits()[k].px, momentum, "px", k);
            check_close(a.nodes.deposits()[k].py, b.nodes.deposits()[k].py, momentum, "py", k);
            check_close(a.nodes.column_mass[k], b.nodes.column_mass[k], mass, "column", k);
            if (!a.nodes.forced) return;
            check_close(a.nodes.deposits()[k].fx, b.nodes.deposits()[k].fx, force, "force x", k);
            check_close(a.nodes.deposits()[k].fy, b.nodes.deposits()[k].fy, force, "force y", k);
        });
}

void compare_points(Flow& a, Flow& b) {
    std::vector<std::vector<double>> of_b;
    b.particles.each([&](const auto& array) { of_b.emplace_back(array.begin(), array.end()); });
    std::size_t field = 0;
    a.particles.each([&](const auto& array) {
        for (std::size_t p = 0; p < array.size(); ++p)
            check_close(array[p], of_b[field][p], 5e3, "field", static_cast<Index>(field));
        ++field;
    });
}

void compare_sums(const PointSums& a, const PointSums& b) {
    CHECK(a.mass == Approx(b.mass).epsilon(kRoundOff));
    CHECK(a.p_abs == Approx(b.p_abs).epsilon(kRoundOff));
    CHECK(a.px == Approx(b.px).margin(kRoundOff * b.p_abs));
    CHECK(a.stress_power == Approx(b.stress_power).epsilon(1e-12));
    CHECK(a.max_speed == Approx(b.max_speed).epsilon(kRoundOff));
    CHECK(a.max_signal == Approx(b.max_signal).epsilon(kRoundOff));
    CHECK(a.max_shift == Approx(b.max_shift).epsilon(kRoundOff));
    CHECK(a.left_count == b.left_count);
    CHECK(a.left_mass == Approx(b.left_mass).epsilon(kRoundOff));
    CHECK(a.bad == b.bad);
}

/// A smooth velocity field that carries some points over the sides.
void set_motion(Flow& flow) {
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            const double x = static_cast<double>(i), y = static_cast<double>(j);
            flow.nodes.motions()[k] = {3.0 * std::sin(0.1 * x + 0.2 * y), 2.0 * std::cos(0.3 * x), 1.0 + 0.01 * x,
                                       0.2 * std::cos(3.0 * x - 0.2 * y)};
            flow.nodes.velocity_share[k] = 0.5 + 0.5 * std::cos(0.7 * x - 0.2 * y);
            flow.nodes.before[k] = {2.0 * std::sin(0.2 * x), 1.0 + 0.1 * std::cos(0.4 * y)};
        });
    });
}

}  // namespace

TEST_CASE("Four points at a time transfer what one at a time does", "[transfer]") {
    const Sides sides = GENERATE(Sides::open, Sides::wall);
    const bool rheology = GENERATE(false, true), hole = GENERATE(false, true);
    CAPTURE(sides == Sides::wall, rheology, hole);
    const Scene scene = scene_with(sides, rheology, hole);
    const auto plain = make_plain_transfer(scene), packed = make_packed_transfer(scene);
    REQUIRE(packed != nullptr);
    Crowd a(scene, 7), b(scene, 7);
    compare_sums(packed->deposit(a.flow, 0.01), plain->deposit(b.flow, 0.01));
    compare_nodes(a.flow, b.flow);
    set_motion(a.flow), set_motion(b.flow);
    a.flow.carried_share = b.flow.carried_share = GENERATE(0.0, 0.7);
    TransferKernel::Probe seen_a, seen_b;
    packed->probe(a.flow, seen_a), plain->probe(b.flow, seen_b);
    for (std::size_t p = 0; p < seen_b.vx.size(); ++p) {
        check_close(seen_a.vx[p], seen_b.vx[p], 3.0, "vx", static_cast<Index>(p));
        check_close(seen_a.cyx[p], seen_b.cyx[p], 3.0, "cyx", static_cast<Index>(p));
        check_close(seen_a.depth[p], seen_b.depth[p], 3.0, "depth", static_cast<Index>(p));
    }
    compare_sums(packed->gather(a.flow, 0.4), plain->gather(b.flow, 0.4));
    compare_points(a.flow, b.flow);
    CHECK(packed->gone() == plain->gone());
    CHECK((std::count(plain->gone().begin(), plain->gone().end(), 1) > 0) == (sides == Sides::open || hole));
}

TEST_CASE("A point on its way leaves the crests of two-cell waves, by at most half of its way", "[transfer]") {
    const auto shifted = [](double strength, double slope_x, double slope_y, double dx, double dy) {
        off_waves(strength, slope_x, slope_y, std::hypot(dx, dy), dx, dy);
        return std::pair(dx, dy);
    };
    CHECK(shifted(1.0, 0.1, -0.2, 0.3, 0.4) == std::pair(0.3 - 0.5 * 0.1, 0.4 + 0.5 * 0.2));  // its way is 0.5
    CHECK(shifted(1.0, 9.0, -9.0, 0.3, 0.4) == std::pair(0.3 - 0.25, 0.4 + 0.25));
    CHECK(shifted(1.0, 9.0, -9.0, 0.0, 0.0) == std::pair(0.0, 0.0));
    CHECK(shifted(0.0, 9.0, -9.0, 0.3, 0.4) == std::pair(0.3, 0.4));
}

TEST_CASE("A two-cell wave is one of the depth and of the level at once", "[transfer]") {
    CHECK(common_wave(2.0, 1.9, 7.0, 7.0) == 0.0);    // a level surface over a rough bed
    CHECK(common_wave(2.0, 2.0, 7.0, 6.9) == 0.0);    // a sheet as rough as its bed
    CHECK(common_wave(2.0, 1.75, 7.0, 7.25) == 0.0);  // pits that are not full
    CHECK(common_wave(2.0, 1.75, 7.0, 6.875) == 0.0625);
    CHECK(common_wave(2.0, 2.25, 7.0, 7.125) == -0.0625);
    CHECK(common_wave(0.0, 0.0, 7.0, 7.0) == 0.0);  // no material
}

void wall_holes(Scene& scene) {
    scene.holes = holes_of(scene.bed);
    scene.hole_top = 5.0;
}

namespace {

/// Points on nodes that move, before they gather.
struct OnTheirWay {
    OnTheirWay(const Scene& scene, bool one_by_one)
        : transfer(one_by_one ? make_plain_transfer(scene) : make_packed_transfer(scene)), crowd(scene, 7) {
        transfer->deposit(crowd.flow, 0.01);
        set_motion(crowd.flow);
    }
    std::unique_ptr<TransferKernel> transfer;
    Crowd crowd;
};

}  // namespace

TEST_CASE("What a hole's wall sets back counts in how far points came", "[transfer][holes]") {
    Scene scene = scene_with(Sides::open, false, true);
    wall_holes(scene);
    OnTheirWay points(scene, GENERATE(false, true));
    REQUIRE(scene.holes.nodes.size() == 1);
    const auto& transfer = points.transfer;
    const Particles& c = points.crowd.flow.particles;
    const std::vector<double> x(c.x.begin(), c.x.end()), y(c.y.begin(), c.y.end());
    const double longest = transfer->gather(points.crowd.flow, 1e-3).max_shift;
    double came = 0.0;
    for (std::size_t p = 0; p < x.size(); ++p)
        if (!transfer->gone()[p]) came = std::max({came, std::abs(c.x[p] - x[p]), std::abs(c.y[p] - y[p])});
    CHECK(came > 0.1);  // some lay in the wall's pixel: far more than their speed carries them in a millisecond
    CHECK(came <= longest);
}

TEST_CASE("A long step leads over no wall of one pixel", "[transfer][holes]") {
    Scene scene = scene_with(Sides::open, false, false);
    for (Index j = 1; j < kNodesY - 1; ++j) scene.bed.at(20, j) = std::numeric_limits<double>::quiet_NaN();
    wall_holes(scene);
    OnTheirWay points(scene, GENERATE(false, true));
    const auto& transfer = points.transfer;
    const Particles& c = points.crowd.flow.particles;
    const std::vector<double> x(c.x.begin(), c.x.end());
    const auto side_of = [](double place) { return place < 19.5 ? -1 : place > 20.5 ? 1 : 0; };
    CHECK(transfer->gather(points.crowd.flow, 0.8).max_shift > 1.1);
    int met = 0;
    for (std::size_t p = 0; p < x.size(); ++p) {
        if (transfer->gone()[p] || std::abs(c.y[p] - 0.5 * kNodesY) > 0.5 * kNodesY - 4.0)
            continue;  // not round its ends
        CHECK(side_of(c.x[p]) * side_of(x[p]) >= 0);
        met += side_of(x[p]) != 0 && std::abs(c.x[p] - 20.0) < 1.0;
    }
    CHECK(met > 0);
}

TEST_CASE("Gathering and depositing in one sweep gives the bits of two", "[transfer]") {
    const Scene scene = scene_with(GENERATE(Sides::open, Sides::wall), true, true);
    const auto one = make_packed_transfer(scene), two = make_packed_transfer(scene);
    Crowd a(scene, 3), b(scene, 3);
    set_motion(a.flow), set_motion(b.flow);
    a.flow.carried_share = b.flow.carried_share = GENERATE(0.0, 0.7);
    const PointSums swept = one->carry(a.flow, 0.3, 0.01);
    two->gather(b.flow, 0.3);
    CHECK(swept.stress_power == two->deposit(b.flow, 0.01).stress_power);
    CHECK(swept.stress_power > 0.0);
    for (const Index tile : a.flow.active.work)
        for_each_node_of(a.flow.grid, tile, [&](Index k, Index, Index) {
            REQUIRE(std::memcmp(&a.flow.nodes.deposits()[k], &b.flow.nodes.deposits()[k], sizeof(Deposit)) == 0);
            REQUIRE(a.flow.nodes.column_mass[k] == b.flow.nodes.column_mass[k]);
            REQUIRE(a.flow.nodes.mass[k] == b.flow.nodes.mass[k]);
        });
}
