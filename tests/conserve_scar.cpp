// Later releases that stand in the bed until they go: the bed falls then, as one that was cut at the start.
#include "analytic_scene.h"
#include "catch.h"
#include "coupling/growing_particles.h"
#include "coupling/walled_particles.h"
#include "growing_slope.h"
#include "observe/budget.h"
#include "run/memory_state.h"
#include "same_run.h"
#include "terrain/places.h"

using namespace frana;
using namespace frana::test;

namespace {

/// What the bed's nodes have of a release: its volume in each node's cell.
std::vector<ScarNode> scar_of(const Seeds& seeds, const GridGeometry& g) {
    Raster depth = Raster::filled(g, 0.0);
    for (std::size_t p = 0; p < seeds.x.size(); ++p)
        depth.at(std::lround((seeds.x[p] - g.x0) / g.cell), std::lround((seeds.y[p] - g.y0) / g.cell)) +=
            seeds.volume[p] / (g.cell * g.cell);
    std::vector<ScarNode> scar;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            if (depth.at(i, j) > 0.0) scar.push_back({Vec2(g.x(i), g.y(j)), depth.at(i, j)});
    return scar;
}

/// Adds a release that stands in the bed and goes at a time; nothing for `at`: when it is hit.
void bury(Scene& scene, const std::string& name, std::optional<double> at, const Function& depth) {
    const Seeds before = scene.particles;
    scene.particles = {};
    fill(scene, depth);
    Index id = before.count();
    for (const LateRelease& late : scene.late) id += late.seeds.count();
    scene.late.push_back({name, at, scene.particles, id, scar_of(scene.particles, scene.bed.geometry)});
    scene.particles = before;
}

/// The same release at the start, on a bed that it was cut out of.
void dig(Scene& scene, const Function& depth) {
    Scene alone = scene;
    alone.particles = {};
    fill(alone, depth);
    for (const ScarNode& node : scar_of(alone.particles, scene.bed.geometry)) {
        const GridGeometry& g = scene.bed.geometry;
        scene.bed.at(std::lround((node.at.x() - g.x0) / g.cell), std::lround((node.at.y() - g.y0) / g.cell)) -=
            node.depth;
    }
    fill(scene, depth);
}

double cap(double x, double y, double x0, double y0, double depth, double radius) {
    const double r2 = ((x - x0) * (x - x0) + (y - y0) * (y - y0)) / (radius * radius);
    return depth * std::max(0.0, 1.0 - r2);
}

constexpr Index kAround = 20;  ///< cells around what happens: the bed is smoothed as if none of its sides were near

Scene valley() {
    Scene scene = scene_on(
        110 + 2 * kAround, 45 + 2 * kAround, 1.0,
        [](double x, double y) { return 1500.0 - 0.5 * x + 8e-4 * x * x + 0.006 * (y - 22) * (y - 22); }, -kAround,
        -kAround);
    scene.bed_law = bed::Voellmy{0.15, 400.0};
    scene.scheme.curvature_length = 3.0;  // 18 passes, that reach as many cells
    return scene;
}
Index at(const DepthAveraged& run, Index x, Index y) { return run.flow().grid.at(x + kAround, y + kAround); }
double slab(double x, double y) { return cap(x, y, 25.3, 21.8, 2.0, 11.0); }
double below(double x, double y) { return cap(x, y, 55.1, 22.6, 1.5, 9.0); }

/// Largest difference of a number of nodes: those of the ground, and two beyond its sides.
template <class Number>
double difference(const DepthAveraged& a, const DepthAveraged& b, Number&& number) {
    double most = 0.0;
    const TileGrid& grid = a.flow().grid;
    for (Index j = -2; j < grid.ny() + 2; ++j)
        for (Index i = -2; i < grid.nx() + 2; ++i) {
            const Index k = grid.at(i, j);
            most = std::max(most, std::abs(number(a.flow().bed, k) - number(b.flow().bed, k)));
        }
    return most;
}

/// Elevations within round-off of them. Of the smoothed bed the filter's tails are left out, 1e-10 of the change each.
void check_same_bed(const DepthAveraged& a, const DepthAveraged& b, double high, double tails) {
    const double cell = a.flow().grid.cell(), round_off = 8.0 * 2.2e-16 * high;
    const auto apart = [&](auto field) {
        return difference(a, b, [&](const BedGeometry& bed, Index k) { return (bed.*field)[k]; });
    };
    CHECK(apart(&BedGeometry::ground) <= round_off);
    CHECK(apart(&BedGeometry::z) <= round_off);
    CHECK(apart(&BedGeometry::z_min) <= round_off);
    CHECK(apart(&BedGeometry::slope_x) <= 2.0 * round_off / cell);
    CHECK(apart(&BedGeometry::slope_y) <= 2.0 * round_off / cell);
    CHECK(difference(a, b, [](const BedGeometry& bed, Index k) { return bed.smooth[k].x; }) <= tails / cell);
    CHECK(difference(a, b, [](const BedGeometry& bed, Index k) { return bed.smooth[k].y; }) <= tails / cell);
    for (const auto field : {&BedGeometry::hxx, &BedGeometry::hxy, &BedGeometry::hyy})
        CHECK(apart(field) <= tails / (cell * cell));
}

double most_depth_apart(const DepthAveraged& a, const DepthAveraged& b) {
    double most = 0.0;
    const Flow &f = a.flow(), &g = b.flow();
    for (Index j = 0; j < f.grid.ny(); ++j)
        for (Index i = 0; i < f.grid.nx(); ++i) {
            const double h = f.is_in_reach(i, j) ? f.nodes.depth[f.grid.at(i, j)] : 0.0,
                         other = g.is_in_reach(i, j) ? g.nodes.depth[g.grid.at(i, j)] : 0.0;
            most = std::max(most, std::abs(h - other));
        }
    return most;
}

}  // namespace

TEST_CASE("A release that stands in the bed until it goes is one on a bed that was cut at the start", "[scar][late]") {
    for (const bool early : {false, true}) {  // another one, that is cut at the start
        constexpr double kAt = 3.7;
        Scene now = valley(), later = valley();
        if (early) dig(now, [](double x, double y) { return cap(x, y, 90, 22, 1.0, 6.0); });
        if (early) later = now;
        bury(later, "slab", kAt, slab), dig(now, slab);
        if (early) {  // numbers and order do not matter here
            now.particles = {}, later.particles = {};
            fill(now, slab);
        }
        DepthAveraged from_start(now), late(later);
        const Status first = late.status();
        run_to(late, kAt);
        REQUIRE(late.extras().late.at(0).entered == kAt);
        REQUIRE(late.extras().late.at(0).of_bed);
        check_same_bed(late, from_start, 1600.0, 2e-8);
        CHECK((late.flow().particles.x == from_start.flow().particles.x));
        CHECK(std::abs(budget(first, late.status()).energy_residual) <= 1e-12 * late.status().potential);
        const double above = late.status().potential;
        CHECK(above == Approx(from_start.status().potential).epsilon(1e-13));
        double farthest = 0.0;
        for (int step = 0; step < 60; ++step) {
            late.advance(1e3), from_start.advance(1e3);
            REQUIRE(late.status().particles == from_start.status().particles);
            farthest = std::max(farthest, from_start.status().max_speed_on_map);
        }
        CHECK(farthest > 3.0);
        CHECK(most_depth_apart(late, from_start) < 1e-8);
        CHECK(late.status().kinetic == Approx(from_start.status().kinetic).epsilon(1e-9));
        CHECK(std::abs(budget(first, late.status()).mass_error) < 1e-14);
    }
}

TEST_CASE("A cut at a side is that of a bed that was cut at the start, at walls and open sides", "[scar][late]") {
    for (const Sides sides : {Sides::open, Sides::wall}) {
        const auto corner = [](double x, double y) { return cap(x, y, 2.0 - kAround, 63.0, 1.0, 12.0); };
        Scene now = valley(), later = valley();
        now.sides = later.sides = sides;
        bury(later, "corner", 0.5, corner), dig(now, corner);
        DepthAveraged from_start(now), late(later);
        run_to(late, 0.5);
        const BedGeometry &x = late.flow().bed, &y = from_start.flow().bed;
        const TileGrid& grid = late.flow().grid;
        for (Index j = -4; j < grid.ny() + 4; ++j)
            for (Index i = -4; i < grid.nx() + 4; ++i) {
                const Index k = grid.at(i, j);
                REQUIRE(std::abs(x.z[k] - y.z[k]) < 1e-11);
                REQUIRE(std::abs(x.ground[k] - y.ground[k]) < 1e-11);
            }
        double path = 0.0;
        for (Index j = 0; j < grid.ny(); ++j)
            for (Index i = 0; i < grid.nx(); ++i) {
                const Index k = grid.at(i, j);
                REQUIRE(std::abs(x.slope_x[k] - y.slope_x[k]) < 1e-11);
                REQUIRE(std::abs(x.slope_y[k] - y.slope_y[k]) < 1e-11);
                path = std::max(path, std::abs(x.smooth[k].x - y.smooth[k].x));
            }
        INFO("path " << path);
        CHECK(path < 1e-3);  // 16 nodes beyond a side the smoothing of a bed ends, and that of a change as well
    }
}

TEST_CASE("Where a flow sets off what stands in the bed, the surface stays and the budgets close", "[scar][late]") {
    Scene scene = valley();
    fill(scene, slab);
    bury(scene, "below", {}, below);
    DepthAveraged run(scene);
    const Status first = run.frame().status;
    const auto& hit = [&] { return run.extras().late.at(0).entered.has_value(); };
    const auto surface_at = [](const DepthAveraged& of, Index x, Index y) {
        const Index k = at(of, x, y);
        return of.flow().bed.z[k] + (of.flow().is_in_reach(x + kAround, y + kAround) ? of.flow().nodes.depth[k] : 0.0);
    };
    Scene bare = scene;
    bare.late.clear();
    DepthAveraged without(bare);
    while (!hit()) {
        REQUIRE(run.status().time < 20.0);
        run.advance(20.0), without.advance(20.0);
    }
    // The bed and the depth are averages of the cap over a node's surroundings, whose variances differ by 1/4 of a cell's
    // square in each direction: half of the cap's Laplacian, 2 h / r^2 in each, comes with it.
    const double curved = 2.0 * 1.5 / 81.0;
    double most = 0.0;
    for (Index y = 12; y < 33; ++y)
        for (Index x = 45; x < 66; ++x)
            if (std::hypot(double(x) - 55.1, double(y) - 22.6) < 6.0)
                most = std::max(most, std::abs(surface_at(run, x, y) - surface_at(without, x, y)));
    CHECK(most < 0.25 * curved);
    CHECK(run.status().max_depth > 1.0);
    double worst = 0.0;
    while (run.status().time < 9.0) {
        run.advance(9.0);
        worst = std::max(worst, std::abs(budget(first, run.status()).mass_error));
    }
    CHECK(worst < 1e-13);
    const Status now = run.frame().status;
    const Budget b = budget(first, now);
    CHECK(std::hypot(b.momentum_residual[0], b.momentum_residual[1]) < 1e-11 * now.mass * 10.0);
    // The scheme loses some percent of what is set free, and gains nothing.
    const double turned = now.kinetic + now.dissipated;
    CHECK(b.energy_residual < 1e-9 * turned);
}

TEST_CASE("What is loose below a release that stands in the bed stays until that goes", "[scar][erosion][late]") {
    Scene scene = valley();
    fill(scene, slab);
    bury(scene, "below", 6.0, below);
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.02), 1600.0, erosion::Growth{0.05}};
    DepthAveraged run(scene);
    const Status first = run.status();
    const Index k = at(run, 55, 22), upstream = at(run, 40, 22);
    const double z = run.flow().bed.z[k];
    bool passed = false;
    while (run.status().time < 6.0) {
        run.advance(6.0);
        if (run.status().time == 6.0) break;
        passed = passed || run.flow().nodes.depth[k] > 0.3;
        CHECK(run.erosion()->eroded_depth(k) == 0.0);
        CHECK(run.flow().bed.z[k] == z);
    }
    CHECK(passed);
    CHECK(run.erosion()->eroded_depth(upstream) > 0.01);
    double worst = 0.0;
    while (run.status().time < 12.0) {
        run.advance(12.0);
        worst = std::max(worst, std::abs(budget(first, run.status()).mass_error));
    }
    CHECK(run.erosion()->eroded_depth(k) > 0.01);
    CHECK(worst < 1e-13);
    const double fell = scene.late[0].scar.empty() ? 0.0 : z - run.flow().bed.z[k] - run.erosion()->eroded_depth(k);
    CHECK(fell == Approx(below(55, 22)).epsilon(0.02));  // averaged over the node's shape
    const Frame frame = run.frame();
    const auto array = [&](const char* name) {
        return frame.node(name)->data[(22 + kAround) * frame.grid.nx + 55 + kAround];
    };
    CHECK(array("elevation") == run.flow().bed.z[k]);
    CHECK(array("bed_change") == Approx(-run.erosion()->eroded_depth(k) - below(55, 22)).epsilon(0.02));
}

TEST_CASE("A bed that falls has the same bits on any number of threads, and when a run goes on before or after",
          "[scar][late][resume][threads]") {
    for (const bool loose : {false, true}) {
        Scene scene = valley();
        fill(scene, slab);
        bury(scene, "below", {}, below);
        bury(scene, "timed", 5.0, [](double x, double y) { return cap(x, y, 60, 20, 1.0, 8.0); });  // overlaps it
        if (loose) {
            scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.1), 1600.0, erosion::Growth{0.01}};
            scene.deposition = Deposition{0.5};
        }
        const Extras extras = check_resumed_often(
            scene, 8.0, 12, [](auto& run, auto& straight) { check_same(run, straight, "bed/left"); });
        for (const std::size_t n : {0, 1}) REQUIRE(extras.late.at(n).entered.has_value());
    }
}

TEST_CASE("A state put aside before a bed falls comes back with all of it", "[scar][late][resume]") {
    Scene scene = valley();
    fill(scene, [](double x, double y) { return cap(x, y, 10, 22, 1.0, 6.0); });
    bury(scene, "far", 1.0, [](double x, double y) { return cap(x, y, 90, 22, 2.0, 8.0); });
    DepthAveraged simulation(scene);
    while (simulation.status().time < 0.9) simulation.advance(0.9);
    const auto bed = [&] {
        const Flow& flow = simulation.flow();
        std::vector<double> numbers;
        for (Index k = 0; k < flow.grid.size(); ++k)
            for (const double number : {flow.bed.z[k], flow.bed.ground[k], flow.bed.slope_x[k], flow.bed.smoothed[k],
                                        flow.bed.hxx[k], simulation.erosion()->bed_change(k)})
                numbers.push_back(number);
        return numbers;
    };
    const std::vector<double> before = bed();
    MemoryState aside;
    aside.save(simulation);
    simulation.advance(1.0), simulation.advance(1.1);
    REQUIRE(simulation.status().time > 1.0);
    CHECK((bed() != before));
    aside.load(simulation);
    CHECK((bed() == before));
}

TEST_CASE("A bed that fell stays so where the terrain grows, and next to barriers", "[scar][late][terrain]") {
    const auto heap = [](double x, double y) { return std::hypot(x - 1240, y - 400) < 40 ? 2.0 : 0.0; };
    Scene scene = growing_slope(NodeBox{180, 20, 200, 160});
    fill(scene, heap);
    bury(scene, "early", 3.0, [](double x, double y) { return std::hypot(x - 1300, y - 400) < 40 ? 3.0 : 0.0; });
    bury(scene, "late", 16.0, [](double x, double y) { return std::hypot(x - 1150, y - 420) < 40 ? 3.0 : 0.0; });
    GrowingParticles part(scene);
    Scene whole_scene = scene;
    whole_scene.wider.reset();
    whole_scene.bed = scene.wider->read(NodeBox::all(scene.wider->grid));
    DepthAveraged whole(whole_scene);
    CHECK(grows_before_all_is_in(part, 18.0));
    run_to(whole, 18.0);
    const Frame shown = part.frame(), all = whole.frame();
    const auto of = [](const Frame& frame, const char* name) { return frame.node(name)->data; };
    const auto change = of(shown, "bed_change"), expected = of(all, "bed_change"), z = of(shown, "elevation"),
               z_of_all = of(all, "elevation");
    double deepest = 0.0;
    for (Index j = 0; j < shown.grid.ny; ++j)
        for (Index i = 0; i < shown.grid.nx; ++i) {
            const Index n = j * shown.grid.nx + i, m = pixel_of(all.grid, shown.grid.x(i), shown.grid.y(j));
            deepest = std::max(deepest, -expected[m]);
            REQUIRE(std::abs(change[n] - expected[m]) < 1e-12);
            REQUIRE(std::abs(z[n] - z_of_all[m]) < 1e-10);
        }
    CHECK(deepest == Approx(3.0));

    Scene walled = valley();
    fill(walled, slab);
    bury(walled, "below", {}, below);
    Barrier wall;
    wall.name = "wall";
    wall.line = {{56, 15}, {56, 30}};
    wall.height = 1.0;
    walled.barriers = {wall};
    WalledParticles run(walled);
    const Status start = run.status();
    const Frame before = run.frame();
    const double* z0 = of(before, "elevation");
    const auto row = [&](Index x) { return (22 + kAround) * before.grid.nx + x + kAround; };
    Index top_node = row(54);
    for (Index x = 54; x <= 58; ++x)  // what stands out most of the slope
        if (z0[row(x)] - 0.43 * double(56 - x) > z0[top_node] - 0.43 * double(56 - (top_node - row(0))))
            top_node = row(x);
    run_to(run, 9.0);
    CHECK(run.extras().late[0].entered.has_value());
    CHECK(std::abs(budget(start, run.status()).mass_error) < 1e-13);
    const Frame after = run.frame();
    const auto change_at_wall = of(after, "bed_change");
    CHECK(change_at_wall[top_node] == 0.0);  // the barrier does not fall with the ground around it
    double around = 0.0;
    for (Index n = 0; n < static_cast<Index>(after.grid.nx * after.grid.ny); ++n)
        around = std::max(around, -change_at_wall[n]);
    CHECK(around > 1.0);
}
