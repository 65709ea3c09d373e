// Trees take mass out of a flow: nothing is lost, the surface stays, momentum and energy go with what is taken.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "checks/verify/placement.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "same_run.h"
#include "shallow/depth_averaged.h"

using namespace frana;
using namespace frana::test;

namespace {

Forest forest(const Scene& scene, const Function& pressure) {
    Forest trees;
    trees.pressure = Raster::filled(scene.bed.geometry, 0.0);
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) trees.pressure.at(i, j) = pressure(g.x(i), g.y(j));
    return trees;
}

double cap(double x, double y, double x0, double depth) {
    return depth * std::max(0.0, 1.0 - (std::pow(x - x0, 2) + std::pow(y - 40.3, 2)) / 144.0);
}

/// A slide of snow runs down a slope into a forest; the ground levels out behind its edge.
Scene slope(const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(140, 80, 1.0, [](double x, double y) {
        return (x < 60.0 ? 0.7 * (60.0 - x) : 0.0) + 0.002 * (y - 40) * (y - 40);
    });
    scene.density = 300.0;
    scene.bed_law = bed::Voellmy{0.25, 1500.0};
    fill(scene, [](double x, double y) { return cap(x, y, 22.2, 1.5); });
    scene.forest = forest(scene, [](double x, double y) { return x > 40.0 && y > 20.0 ? 60.0 : 0.0; });
    if (edit) edit(scene);
    return scene;
}

void make_hungry(Scene& scene) {
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.1), 350.0, erosion::Growth{0.02}};
}

/// A sheet that glides over level ground without friction. Where it has no weight to speak of all of it keeps its velocity: on
/// gentle terrain what it leaves behind does not turn it upwards.
Scene sheet(double gravity, const Function& pressure) {
    Scene scene = scene_on(160, 40, 1.0, [](double, double) { return 0.0; });
    scene.density = 300.0, scene.gravity = gravity;
    scene.bed_law = bed::Coulomb{0.0};
    scene.terrain = TerrainModel::shallow, scene.curvature = Curvature::none;
    fill(scene, [](double x, double y) { return x > 20 && x < 50 && y > 10 && y < 30 ? 1.0 : 0.0; });
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), 4.0);
    std::fill(scene.particles.vy.begin(), scene.particles.vy.end(), 0.5);
    scene.forest = forest(scene, pressure);
    return scene;
}

double worst_mass_error(DepthAveraged& simulation, double end, double* of_bed) {
    const Status first = simulation.frame().status;
    double worst = 0.0;
    while (simulation.status().time < end && simulation.status().particles > 0) {
        simulation.advance(end);
        const Budget now = budget(first, simulation.status());
        worst = std::max(worst, std::abs(now.mass_error));
        *of_bed = std::max(*of_bed, std::abs(now.bed_error));
    }
    return worst;
}

}  // namespace

TEST_CASE("Trees take K/u, and at most all, of flow between their limits", "[forest]") {
    Detrainment trees;
    CHECK(trees.share({50.0, 300.0, 2.2, 2.0, 20.0}, 0.1) == Approx(50.0 * 0.1 / 20.0 / 600.0).epsilon(1e-15));
    CHECK(trees.share({50.0, 300.0, 1e-9, 1e-9, 20.0}, 0.1) == 1.0);
    CHECK(trees.share({50.0, 300.0, 2.2, 2.0, 0.099}, 0.1) == 0.0);
    CHECK(trees.share({50.0, 300.0, 2.2, 2.0, 0.1}, 0.1) > 0.0);
    CHECK(trees.share({0.0, 300.0, 0.0, 0.0, 1.0}, 0.1) == 1.0);  // of nothing
    trees.max_speed = 6.0, trees.max_depth = 0.6;
    CHECK(trees.share({50.0, 300.0, 0.5, 0.5, 6.1}, 0.1) == 0.0);
    CHECK(trees.share({50.0, 300.0, 0.7, 0.5, 5.0}, 0.1) == 0.0);
    CHECK(trees.share({50.0, 300.0, 0.6, 0.5, 6.0}, 0.1) == Approx(5.0 / 900.0).epsilon(1e-15));
}

TEST_CASE("The surface does not move when trees take mass, which goes with its velocity", "[forest]") {
    Scene scene =
        scene_on(70, 60, 1.0, [](double x, double y) { return 0.3 * std::sin(0.2 * x) * std::cos(0.15 * y); });
    scene.density = 300.0;
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 30) < 20 ? 2.0 : 0.0; },
        verify::Placement::full_jitter, 2);
    scene.forest = forest(scene, [](double x, double) { return x < 35.0 ? 100.0 : 0.0; });
    Flow flow(scene);
    Erosion erosion(scene, flow);
    Particles& c = flow.particles;
    const Seeds& seeds = scene.particles;
    c.resize(seeds.count());
    for (Index p = 0; p < seeds.count(); ++p) {
        c.x[p] = seeds.x[p], c.y[p] = seeds.y[p], c.id[p] = p, c.mass[p] = seeds.volume[p] * flow.density;
        c.r1x[p] = c.r2y[p] = 0.5, c.depth[p] = seeds.y[p] < 15.0 ? 0.01 : 2.0;
        c.r1y[p] = c.r2x[p] = c.cxx[p] = c.cxy[p] = c.cyx[p] = c.cyy[p] = 0.0;
        c.vx[p] = 2.0 + 0.1 * seeds.y[p], c.vy[p] = -1.0;
    }
    TileSorter sorter;
    sorter.sort(c, flow.grid, {}, flow.active);
    const auto transfer = make_transfer(scene);
    const auto levels = [&] {
        transfer->deposit(flow, 0.1);
        std::vector<double> all;
        for (Index j = 0; j < flow.grid.ny(); ++j)
            for (Index i = 0; i < flow.grid.nx(); ++i) {
                const Index k = flow.grid.at(i, j);
                all.push_back(flow.bed.z[k] + flow.nodes.column_mass[k] / (flow.density * flow.area));
            }
        return all;
    };
    double mass = 0.0, px = 0.0, py = 0.0;
    const auto count = [&](double sign) {
        for (Index p = 0; p < c.count(); ++p)
            mass += sign * c.mass[p], px += sign * c.mass[p] * c.vx[p], py += sign * c.mass[p] * c.vy[p];
    };
    const std::vector<double> before = levels();
    count(-1.0);
    const Index points = c.count();
    const ExchangeSums sums = erosion.detrain(flow, 0.2);
    REQUIRE(erosion.any_gone());
    sorter.drop(c, erosion.gone(), flow.active);
    CHECK(c.count() < points);
    CHECK(c.count() > points / 2);
    count(1.0);
    REQUIRE(sums.taken < -100.0);
    CHECK(std::abs(mass - sums.taken) <= 1e-9);  // sums of 7e5 kg
    CHECK(std::abs(px - sums.px) <= 1e-7);
    CHECK(std::abs(py - sums.py) <= 1e-9);
    CHECK(sums.lost > 0.5 * -sums.taken * (3.0 * 3.0 + 1.0));  // the slowest of them on level ground
    const Status::Bed bed = erosion.status();
    CHECK(bed.deposited == Approx(-sums.taken).epsilon(1e-14));
    CHECK(bed.mass == Approx(-sums.taken).epsilon(1e-13));
    const std::vector<double> after = levels();
    double moved = 0.0;
    for (std::size_t n = 0; n < before.size(); ++n) moved = std::max(moved, std::abs(after[n] - before[n]));
    CHECK(moved <= 4e-15);  // round-off of 2 m
}

TEST_CASE("Momentum and energy of a sheet, with what trees got of them, are those of the start", "[forest]") {
    DepthAveraged simulation(sheet(1e-12, [](double x, double y) { return x > 30 && y > 15.0 ? 40.0 : 0.0; }));
    const Status first = simulation.frame().status;
    const double initial = std::hypot(first.momentum[0], first.momentum[1]);
    run_to(simulation, 8.0);
    const Status now = simulation.frame().status;
    REQUIRE(now.bed.deposited > 0.05 * first.mass);
    const double mass = now.mass + now.bed.mass;
    CHECK(std::abs(mass - first.mass) <= 1e-13 * mass);
    for (const double residual : budget(first, now).momentum_residual) CHECK(std::abs(residual) <= 1e-13 * initial);
    // Nothing else pushes: each kilogram left with 4 and 0.5 m/s. With a weight of 1e-12 m/s2, to that.
    CHECK(now.impulse[0] == Approx(-4.0 * now.bed.deposited).epsilon(1e-9));
    CHECK(now.impulse[1] == Approx(-0.5 * now.bed.deposited).epsilon(1e-9));
    CHECK(now.dissipated == Approx(0.5 * 16.25 * now.bed.deposited).epsilon(1e-9));
    CHECK(std::abs(budget(first, now).energy_residual) <= 1e-9 * first.kinetic);
    DepthAveraged heavy(sheet(9.81, [](double x, double y) { return x > 30 && y > 15.0 ? 40.0 : 0.0; }));
    run_to(heavy, 5.0);
    REQUIRE(heavy.status().bed.deposited > 0.05 * first.mass);
    for (const double residual : budget(first, heavy.frame().status).momentum_residual)
        CHECK(std::abs(residual) <= 1e-13 * initial);
}

TEST_CASE("A dense forest takes all of a thin flow: the bed has the mass of the release", "[forest]") {
    Scene scene = slope([](Scene& s) {
        s.bed_law = bed::Coulomb{0.25};  // drag would leave a film that is slower than 0.1 m/s
        for (double& volume : s.particles.volume) volume *= 0.02;
        for (double& depth : s.particles.depth) depth *= 0.02;
        s.forest = forest(s, [](double x, double) { return x > 35.0 ? 5000.0 : 0.0; });
    });
    DepthAveraged simulation(scene);
    const Status first = simulation.frame().status;
    double of_bed = 0.0;
    CHECK(worst_mass_error(simulation, 60.0, &of_bed) <= 1e-13);
    CHECK(of_bed <= 1e-13);
    const Status& now = simulation.status();
    CHECK(now.particles == 0);
    CHECK(now.time < 30.0);
    CHECK(now.mass == 0.0);
    CHECK(now.mass_left == 0.0);
    CHECK(std::abs(now.bed.mass - first.mass) <= 1e-13 * first.mass);
    CHECK(std::abs(now.bed.deposited - first.mass) <= 1e-13 * first.mass);
    CHECK_FALSE(simulation.more_comes());
}

TEST_CASE("Flow, bed and what left have the mass of the start in each step among trees", "[forest]") {
    for (const bool hungry : {false, true})  // every pair of the three
        for (const bool rests : {false, true}) {
            const Sides sides = hungry == rests ? Sides::open : Sides::wall;
            INFO("hungry " << hungry << ", rests " << rests << ", walls " << (sides == Sides::wall));
            const Scene scene = slope([&](Scene& s) {
                if (hungry) make_hungry(s);
                if (rests) s.deposition = Deposition{1.0};
                s.sides = sides;
            });
            DepthAveraged simulation(scene);
            const Status first = simulation.frame().status;
            double of_bed = 0.0;
            CHECK(worst_mass_error(simulation, 6.0, &of_bed) <= 1e-13);
            CHECK(of_bed <= 1e-13);
            const Status now = simulation.frame().status;
            CHECK(now.bed.deposited > 0.02 * first.mass);
            CHECK((now.bed.eroded > 0.0) == hungry);
            const double momentum = first.mass;  // at 1 m/s
            for (const double residual : budget(first, now).momentum_residual)
                CHECK(std::abs(residual) <= 1e-11 * momentum);
        }
}

TEST_CASE("A forest has the same bits on any number of threads, and after the run is taken up again",
          "[forest][threads]") {
    const int before = omp_get_max_threads();
    const bool alone = GENERATE(true, false);
    const Scene scene = slope([&](Scene& s) {
        if (alone) return;
        make_hungry(s);
        s.deposition = Deposition{1.0};
    });
    omp_set_num_threads(1);
    DepthAveraged straight(scene);
    std::vector<MemoryArchive> kept;
    for (const double at : {3.0, 5.0}) {
        run_to(straight, at);
        straight.serialize(kept.emplace_back());
    }
    run_to(straight, 7.0);
    REQUIRE(straight.status().bed.deposited > 0.0);
    for (const int threads : {2, 4}) {
        omp_set_num_threads(threads);
        DepthAveraged again(scene);
        for (const double at : {3.0, 5.0, 7.0}) run_to(again, at);
        check_same(again, straight, "bed/fresh");
    }
    for (MemoryArchive& archive : kept) {
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(archive.rewind());
        for (const double at : {3.0, 5.0, 7.0}) run_to(resumed, at);
        check_same(resumed, straight, "bed/fresh");
    }
    omp_set_num_threads(before);
}

TEST_CASE("Trees where no flow comes change no bit of it, and sleep changes none among trees", "[forest][sleep]") {
    DepthAveraged with(
        slope([](Scene& s) { s.forest = forest(s, [](double x, double) { return x > 135.0 ? 60.0 : 0.0; }); }));
    DepthAveraged without(slope([](Scene& s) { s.forest.reset(); }));
    run_to(with, 6.0);
    run_to(without, 6.0);
    auto of_with = state_bits(with);
    for (const auto& [name, entry] : state_bits(without)) {
        INFO(name);
        if (name != "status/numbers") CHECK((of_with.at(name) == entry));
    }
    CHECK(with.status().kinetic == without.status().kinetic);
    CHECK(with.status().potential == without.status().potential);
    DepthAveraged sleeps(slope());
    DepthAveraged awake(slope([](Scene& s) { s.scheme.sleep = false; }));
    run_to(sleeps, 12.0);
    run_to(awake, 12.0);
    REQUIRE(sleeps.status().bed.deposited > 0.0);
    auto of_awake = state_bits(awake);
    for (const char* name : {"bed/fresh", "bed/z", "points/x", "points/mass", "status/numbers"}) {
        INFO(name);
        CHECK((of_awake.at(name) == state_bits(sleeps).at(name)));
    }
}

TEST_CASE("The denser the forest, the more of a slide stays in it", "[forest]") {
    std::vector<double> taken;
    for (const double pressure : {0.0, 20.0, 60.0, 200.0}) {
        DepthAveraged simulation(slope(
            [&](Scene& s) { s.forest = forest(s, [&](double x, double) { return x > 40.0 ? pressure : 0.0; }); }));
        run_to(simulation, 7.0);
        taken.push_back(simulation.status().bed.deposited);
    }
    CHECK(taken[0] == 0.0);
    CHECK(std::is_sorted(taken.begin(), taken.end()));
    CHECK(taken[3] > taken[1]);
}
