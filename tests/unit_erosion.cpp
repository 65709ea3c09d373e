// A flow that takes up its bed: nothing is lost, nothing is taken that is not there, and rock stays as it was.
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

ErodibleBed loose(const Scene& scene, ErosionLaw law, const std::function<double(double, double)>& depth) {
    ErodibleBed bed;
    bed.law = law;
    bed.density = 1.2 * scene.density;
    bed.depth = Raster::filled(scene.bed.geometry, 0.0);
    const GridGeometry& g = scene.bed.geometry;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) bed.depth.at(i, j) = depth(g.x(i), g.y(j));
    return bed;
}

/// A slide into a gully with a bump; loose ground lies in a band across it, less than the flow would take.
Scene slide(const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(90, 60, 2.0, [](double x, double y) {
        return 90 - 0.5 * x + 0.01 * (y - 59) * (y - 59) +
               3 * std::exp(-((x - 90) * (x - 90) + (y - 59) * (y - 59)) / 60);
    });
    scene.bed_law = bed::Voellmy{0.2, 400};
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 59) < 20 ? 3.0 : 0.0; }, verify::Placement::r2,
        2);
    scene.erodible = loose(scene, erosion::Growth{0.01},
                           [](double x, double y) { return x > 50 && x < 130 && y > 40 && y < 78 ? 0.3 : 0.0; });
    if (edit) edit(scene);
    return scene;
}

void run(DepthAveraged& simulation, double end) {
    while (simulation.status().time < end) simulation.advance(end);
}

const ErosionLaw kLaws[] = {erosion::Growth{0.02},         erosion::Steady{0.2}, erosion::Shear{0.2, 500.0, 1e-4},
                            erosion::Energy{300.0},        erosion::Jump{300.0}, erosion::Front{},
                            erosion::Mechanical{0.05, 0.1}};

}  // namespace

TEST_CASE("Flow, bed and what left have the mass of the start, and no node lies below its rock", "[erosion]") {
    for (const ErosionLaw& law : kLaws)  // every pair of law, kappa and sides
        for (const double kappa : {0.0, 0.7}) {
            const Sides sides = (law.index() % 2 == 0) == (kappa == 0.0) ? Sides::open : Sides::wall;
            INFO("law " << law.index() << ", kappa " << kappa << ", walls " << (sides == Sides::wall));
            const Scene scene = slide([&](Scene& s) {
                s.erodible->law = law;
                s.erodible->momentum = kappa;
                s.sides = sides;
            });
            DepthAveraged simulation(scene);
            const Status first = simulation.frame().status;
            run(simulation, 12.0);
            const Frame frame = simulation.frame();
            const Budget left_over = budget(first, frame.status);
            CHECK(std::abs(left_over.mass_error) <= 1e-13);
            CHECK(std::abs(left_over.bed_error) <= 1e-13);
            REQUIRE(frame.status.bed.eroded > 1e-3 * first.mass);
            double momentum = 0.0;
            for (const double part : frame.status.impulse) momentum = std::max(momentum, std::abs(part));
            for (const double residual : left_over.momentum_residual) CHECK(std::abs(residual) <= 1e-11 * momentum);
            const double *eroded = frame.node("eroded_depth")->data, *z = frame.node("elevation")->data;
            const DepthAveraged rock([&] {
                Scene s = scene;
                s.erodible.reset();
                return s;
            }());
            const Flow& before = rock.flow();
            double worst = 0.0, off = 0.0;
            for (Index j = 0; j < frame.grid.ny; ++j)
                for (Index i = 0; i < frame.grid.nx; ++i) {
                    const Index n = j * frame.grid.nx + i;
                    worst = std::max({worst, eroded[n] - scene.erodible->depth.at(i, j), -eroded[n]});
                    off = std::max(off, std::abs(z[n] + eroded[n] - before.bed.z[before.grid.at(i, j)]));
                }
            CHECK(worst <= 0.0);
            CHECK(off <= 1e-12);  // of 90 m, in some hundred steps
        }
}

TEST_CASE("A law beyond all measure takes what is there, and mass stays exact", "[erosion]") {
    for (const ErosionLaw& law : {ErosionLaw(erosion::Growth{100.0}), ErosionLaw(erosion::Steady{1000.0})}) {
        Scene scene = slide();
        scene.erodible = loose(scene, law, [](double, double) { return 0.5; });
        DepthAveraged simulation(scene);
        const Status first = simulation.frame().status;
        run(simulation, 12.0);
        const Budget left_over = budget(first, simulation.frame().status);
        CHECK(simulation.status().bed.eroded > 0.1 * first.mass);
        CHECK(std::abs(left_over.mass_error) <= 1e-13);
        CHECK(std::abs(left_over.bed_error) <= 1e-13);
    }
}

TEST_CASE("A bed without anything loose changes no bit of a run", "[erosion]") {
    DepthAveraged rock(slide([](Scene& s) { s.erodible.reset(), s.scheme.cfl = 0.5; }));
    DepthAveraged bare(
        slide([](Scene& s) { std::fill(s.erodible->depth.values.begin(), s.erodible->depth.values.end(), 0.0); }));
    run(rock, 6.0);
    run(bare, 6.0);
    auto of_bare = state_bits(bare);
    for (const auto& [name, entry] : state_bits(rock)) {
        INFO(name);
        if (name != "status/numbers") CHECK((of_bare.at(name) == entry));
    }
    CHECK(bare.status().kinetic == rock.status().kinetic);
    CHECK(bare.status().potential == rock.status().potential);
}

TEST_CASE("Loose ground next to a flow that does not reach it changes no bit of a run", "[erosion]") {
    const ErosionLaw law = GENERATE(from_range(std::begin(kLaws), std::end(kLaws)));
    CAPTURE(law.index());
    DepthAveraged rock(slide([](Scene& s) { s.erodible.reset(), s.scheme.cfl = 0.5; }));
    DepthAveraged far(slide([&](Scene& s) {
        s.erodible = loose(s, law, [](double, double y) { return y > 88 ? 1.0 : 0.0; });
        s.erodible->momentum = 0.0;
    }));
    run(rock, 3.0);
    run(far, 3.0);
    REQUIRE(far.status().bed.eroded == 0.0);
    CHECK(far.status().kinetic == rock.status().kinetic);
    CHECK(far.status().potential == rock.status().potential);
    auto of_far = state_bits(far);
    for (const auto& [name, entry] : state_bits(rock)) {
        INFO(name);
        // "sums" have how far points may have gone since they were sorted. Those that want something may go farther.
        if (name != "status/numbers" && name != "sums") CHECK((of_far.at(name) == entry));
    }
}

TEST_CASE("An eroding run has the same bits on any number of threads and after it is taken up again",
          "[erosion][threads]") {
    const int before = omp_get_max_threads();
    const Scene scene = slide();
    omp_set_num_threads(1);
    DepthAveraged straight(scene);
    MemoryArchive kept;
    run(straight, 5.0);
    straight.serialize(kept);
    run(straight, 10.0);
    REQUIRE(straight.status().bed.eroded > 0.0);
    for (const int threads : {2, 4}) {
        omp_set_num_threads(threads);
        DepthAveraged again(scene);
        run(again, 5.0);
        run(again, 10.0);
        check_same(again, straight, "bed/left");
    }
    DepthAveraged resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    run(resumed, 10.0);
    check_same(resumed, straight, "bed/left");
    omp_set_num_threads(before);
}

TEST_CASE("A hungry flow takes all of a thin layer where it passes, and no more", "[erosion]") {
    const Scene scene = slide([](Scene& s) {
        s.erodible = loose(s, erosion::Growth{1.0},
                           [](double x, double y) { return x > 60 && x < 80 && y > 50 && y < 70 ? 0.02 : 0.0; });
    });
    DepthAveraged simulation(scene);
    run(simulation, 15.0);
    const Flow& flow = simulation.flow();
    double left = 0.0, had = 0.0;
    for (Index j = 0; j < flow.grid.ny(); ++j)
        for (Index i = 0; i < flow.grid.nx(); ++i) {
            left += simulation.erosion()->left(flow.grid.at(i, j));
            had += scene.erodible->depth.at(i, j) * flow.area * scene.erodible->density;
        }
    REQUIRE(had > 0.0);
    CHECK(left <= 2e-12 * had);  // a node keeps a 1e-12 of what it had
    CHECK(left >= 0.0);
}

TEST_CASE("Under the inside of its footprint a hungry flow leaves nothing of a thin layer", "[erosion]") {
    // A layer all over the slope: at the flow's edge only a part is reached, so nodes count that are well inside.
    constexpr Index kInside = 3;     // cells from what the flow did not cover
    constexpr double kCovers = 0.3;  // [m]
    for (const ErosionLaw& law : {ErosionLaw{erosion::Growth{1.0}}, ErosionLaw{erosion::Steady{5.0}},
                                  ErosionLaw{erosion::Shear{2.0, 10.0, 1e-3}}, ErosionLaw{erosion::Energy{10.0}},
                                  ErosionLaw{erosion::Jump{10.0}}, ErosionLaw{erosion::Mechanical{0.01, 1.0}}}) {
        const Scene scene = slide([&](Scene& s) { s.erodible = loose(s, law, [](double, double) { return 0.02; }); });
        DepthAveraged simulation(scene);
        run(simulation, 15.0);
        const Frame frame = simulation.frame();
        const double* peak = frame.node("peak_depth")->data;
        const Flow& flow = simulation.flow();
        const Index nx = flow.grid.nx(), ny = flow.grid.ny();
        double left = 0.0, had = 0.0;
        for (Index j = kInside; j < ny - kInside; ++j)
            for (Index i = kInside; i < nx - kInside; ++i) {
                bool inside = true;
                for (Index b = j - kInside; b <= j + kInside; ++b)
                    for (Index a = i - kInside; a <= i + kInside; ++a) inside = inside && peak[b * nx + a] > kCovers;
                if (!inside) continue;
                left += simulation.erosion()->left(flow.grid.at(i, j));
                had += scene.erodible->depth.at(i, j) * flow.area * scene.erodible->density;
            }
        INFO("law " << law.index() << ": " << left / had << " of " << had << " kg is left");
        REQUIRE(had > 0.1 * 0.02 * static_cast<double>(nx * ny) * flow.area * scene.erodible->density);
        CHECK(left <= 1.001e-12 * had);  // a node keeps a 1e-12 of what it had, within the round-off of that
        CHECK(left >= 0.0);
    }
}

TEST_CASE("The surface of flow and bed does not move when mass changes sides", "[erosion]") {
    Scene scene =
        scene_on(60, 50, 1.0, [](double x, double y) { return 0.3 * std::sin(0.2 * x) * std::cos(0.15 * y); });
    scene.bed_law = bed::Coulomb{0.5};
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 30, y - 25) < 12 ? 2.0 : 0.0; },
        verify::Placement::full_jitter, 2);
    scene.erodible = loose(scene, erosion::Growth{0.05}, [](double, double) { return 1.0; });
    scene.erodible->density = scene.density;
    scene.erodible->momentum = 1.0;  // points are not set back: what is looked at is the exchange alone
    Flow flow(scene);
    Erosion erosion(scene, flow);
    Particles& c = flow.particles;
    const Seeds& seeds = scene.particles;
    c.resize(seeds.count());
    for (Index p = 0; p < seeds.count(); ++p) {
        c.x[p] = seeds.x[p], c.y[p] = seeds.y[p], c.id[p] = p, c.mass[p] = seeds.volume[p] * flow.density;
        c.r1x[p] = c.r2y[p] = 0.5, c.depth[p] = seeds.depth[p];
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
    const std::vector<double> before = levels();
    erosion.wait(0.2);
    REQUIRE(erosion.exchange(flow, {0.2}).taken > 100.0);
    const std::vector<double> after = levels();
    double moved = 0.0;
    for (std::size_t n = 0; n < before.size(); ++n) moved = std::max(moved, std::abs(after[n] - before[n]));
    CHECK(moved <= 4e-15);  // round-off of 2 m
}

// A run that stops earlier keeps the state two steps before, to go on from (run/run_loop.cpp).
TEST_CASE("What ends a run early has changed nothing two steps before", "[erosion][resume]") {
    Scene scene = slide();
    scene.erodible = loose(scene, erosion::Growth{1e-3}, [](double, double) { return 0.5; });
    DepthAveraged whole(scene);
    std::vector<Status> steps;
    std::vector<Array> x, mass;
    const auto note = [](const DepthAveraged& run, std::vector<Array>& xs, std::vector<Array>& masses) {
        xs.push_back(run.flow().particles.x), masses.push_back(run.flow().particles.mass);
    };
    for (int n = 0; n < 30; ++n) {
        whole.advance(1e3);
        steps.push_back(whole.status());
        note(whole, x, mass);
    }
    REQUIRE(whole.status().bed.eroded > 0.0);
    for (std::size_t n = 0; n < steps.size(); ++n) {
        CAPTURE(n);
        DepthAveraged cut(scene);
        for (std::size_t step = 0; step <= n; ++step) cut.advance(steps[n].time + 1.02 * steps[n].dt);
        REQUIRE(cut.status().time == steps[n].time);
        CHECK((cut.flow().particles.x == x[n]));
        CHECK((cut.flow().particles.mass == mass[n]));
    }
}

TEST_CASE("A flow down the middle of a valley takes as much on both sides", "[erosion]") {
    Scene scene = slide([](Scene& s) {
        s.particles = {};
        verify::place(
            s, [](double x, double y) { return std::hypot(x - 35, y - 59) < 20 ? 3.0 : 0.0; },
            verify::Placement::aligned, 2);
    });
    scene.erodible =
        loose(scene, erosion::Growth{0.01}, [](double x, double) { return x > 50 && x < 130 ? 0.3 : 0.0; });
    DepthAveraged simulation(scene);
    run(simulation, 6.0);
    const Frame frame = simulation.frame();
    const double* eroded = frame.node("eroded_depth")->data;
    double most = 0.0, apart = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const double here = eroded[j * frame.grid.nx + i];
            most = std::max(most, here);
            apart = std::max(apart, std::abs(here - eroded[(frame.grid.ny - 1 - j) * frame.grid.nx + i]));
        }
    REQUIRE(most > 0.1);
    CHECK(apart <= 1e-10 * most);  // round-off, as it grows in some sixty steps
}

TEST_CASE("No point gathers what lies on its way: grown ones spread over as many cells as their mass fills",
          "[erosion]") {
    // A slide of snow runs down a rough slope that is loose all over and takes up many times its mass.
    const auto rough = [](double x, double y) {
        const auto i = static_cast<std::uint64_t>(x), j = static_cast<std::uint64_t>(y);
        return 300.0 - 0.3 * x + 0.02 * static_cast<double>((i * 7919 + j * 104729) % 53);
    };
    Scene scene = scene_on(280, 60, 2.0, rough);
    scene.density = 300.0;
    scene.bed_law = bed::Voellmy{0.12, 400};
    verify::place(
        scene, [](double x, double y) { return std::abs(x - 30) < 20 && std::abs(y - 59) < 20 ? 0.8 : 0.0; },
        verify::Placement::shifted, 2);
    scene.erodible = loose(scene, erosion::Growth{0.008}, [](double, double) { return 0.2; });
    scene.erodible->density = 200.0;
    DepthAveraged simulation(scene);
    const Status first = simulation.status();
    const double largest = *std::max_element(scene.particles.volume.begin(), scene.particles.volume.end());
    double fullest = 0.0;  // cells that a grown point's mass would fill at the depth around it
    while (simulation.status().time < 60.0) {
        simulation.advance(60.0);
        const Particles& c = simulation.flow().particles;
        for (Index p = 0; p < c.count(); ++p)
            // At margins the depth around a point says little.
            if (c.mass[p] > 2.0 * largest * scene.density && c.depth[p] > 0.5)
                fullest = std::max(fullest, c.mass[p] / (scene.density * simulation.flow().area * c.depth[p]));
    }
    CHECK(fullest > 0.0);
    CHECK(simulation.status().mass > 3.0 * first.mass);
    // Domains that do not split are shorter than split_length; four times what one holds is not widened.
    CHECK(fullest < 4.0 * scene.scheme.split_length * scene.scheme.split_length);
}

TEST_CASE("A flow that grows more than a hundredfold is remarked upon", "[erosion]") {
    const Scene scene =
        slide([](Scene& s) { s.erodible = loose(s, erosion::Steady{1.0}, [](double, double) { return 30.0; }); });
    DepthAveraged simulation(scene);
    const double released = simulation.status().mass;
    const auto says = [&] {
        for (const std::string& remark : simulation.remarks())
            if (remark.find("erodible: the flow took up") == 0) return true;
        return false;
    };
    const auto until_taken = [&](double times) {
        while (simulation.status().bed.eroded < times * released && simulation.status().time < 20.0)
            simulation.advance(20.0);
        return simulation.status().bed.eroded >= times * released;
    };
    REQUIRE(until_taken(50.0));
    CHECK_FALSE(says());
    REQUIRE(until_taken(101.0));
    CHECK(says());
}

TEST_CASE("What rests on loose ground sleeps and takes nothing", "[erosion][sleep]") {
    Scene scene = scene_on(80, 60, 1.0, [](double x, double) { return 0.05 * x; });
    scene.bed_law = bed::Coulomb{0.6};
    verify::place(
        scene, [](double x, double y) { return std::max(0.0, 2.0 - 0.1 * std::hypot(x - 40, y - 30)); },
        verify::Placement::r2, 2);
    scene.erodible = loose(scene, erosion::Shear{0.1, 0.0, 1.0}, [](double, double) { return 1.0; });
    DepthAveraged simulation(scene);
    for (int step = 0; step < 12; ++step) simulation.advance(100.0);
    CHECK(simulation.status().bed.eroded == 0.0);
    CHECK(simulation.status().max_speed_on_map == 0.0);
    const ActiveTiles& active = simulation.flow().active;
    REQUIRE(active.count() > 4);
    for (const Index tile : active.tile) CHECK(active.quiet[tile] == kAsleep);
}

TEST_CASE("Erosion laws give what their papers' numbers say", "[erosion]") {
    erosion::State s;
    s.thickness = 2.0, s.speed = 5.0, s.stress = 3000.0, s.density = 2000.0, s.bed_density = 1600.0, s.dt = 1.0;
    CHECK(erosion::Growth{1e-3}.rate(s) == Approx(1e-3 * 2.0 * 5.0 * 1.25));
    CHECK(erosion::Steady{0.05}.rate(s) == Approx(0.05 * 2.0 * 1.25));
    CHECK(erosion::Energy{5000.0}.rate(s) == Approx(3000.0 * 5.0 / (1600.0 * 5000.0)));
    CHECK(erosion::Jump{1000.0}.rate(s) == Approx(2000.0 / (2000.0 * 5.0)));
    CHECK(erosion::Jump{4000.0}.rate(s) == 0.0);
    // Frank et al. 2015: 0.025 m/s down to 0.1 m for each kilopascal above 1 kPa, here 0.2 m.
    CHECK(erosion::Shear{}.rate(s) == Approx(0.025));
    s.eroded = 0.19;
    CHECK(erosion::Shear{}.rate(s) == Approx(0.01));
    s.eroded = 0.21;
    CHECK(erosion::Shear{}.rate(s) == 0.0);
    s.eroded = 0.0, s.stress = 900.0;
    CHECK(erosion::Shear{}.rate(s) == 0.0);
    // A strip as wide as the particle, over a layer of 0.3 m.
    s.left = 0.3, s.edge = 2.5;
    CHECK(erosion::Front{}.rate(s) == Approx(0.3 * 5.0 / 2.5));
    s.left = 0.0;
    CHECK(erosion::Front{}.rate(s) == 0.0);
    // Coulomb friction of 0.4 on a slope with g cos = 8 m/s2: rho mu - rho_b mu_b = 800 - 320 kg/m3, and rho lambda_m -
    // rho_b lambda_b = 2000 - 1600 / 1.8 with the drift of the bed.
    s.normal_gravity = 8.0, s.stress = 2000.0 * 0.4 * 8.0 * 2.0;
    CHECK(erosion::Mechanical{0.2, 0.5}.rate(s) ==
          Approx(0.5 * std::sqrt(8.0 * 2.0 * (800.0 - 320.0) / (2000.0 - 1600.0 / 1.8))));
    CHECK(erosion::Mechanical{0.6, 0.5}.rate(s) == 0.0);
    // r.avaflow's second model of entrainment (January 2023) for one phase, whose tan(delta_b) is mu_b - mu: the drift of
    // the flow is 1, that of the bed 1 / (1 + rho_b / rho), and (1 / nu)^2 stands below the line.
    const double bed_drift = 1.0 / (1.0 + 1600.0 / 2000.0), above = 8.0 * 2.0 * (2000.0 * 0.4 - 1600.0 * 0.2),
                 below = std::pow(1.0 / 0.05, 2) * (2000.0 * 1.0 - 1600.0 * bed_drift);
    CHECK(erosion::Mechanical{0.2, 0.05}.rate(s) == Approx(std::sqrt(above) / std::sqrt(below)).epsilon(1e-14));
}

TEST_CASE("A deposit is taken up only by more stress than the law's threshold and what the deposit bears",
          "[erosion]") {
    erosion::State s;
    s.thickness = 2.0, s.speed = 5.0, s.density = 2000.0, s.bed_density = 1600.0, s.dt = 1.0;
    s.lies = 0.3, s.stress = 900.0;  // below the 1000 Pa of the law
    CHECK(erosion::Shear{}.rate(s) == 0.0);
    CHECK(erosion::Jump{}.rate(s) == 0.0);
    s.stress = 3000.0;  // 0.2 m of the 0.3 m: two thirds of the rate
    CHECK(erosion::Shear{}.rate(s) == Approx(0.025 * 0.2 / 0.3));
    s.lies = 0.02, s.dt = 0.1;
    CHECK(erosion::Shear{}.rate(s) == Approx(0.025));
    s.eroded = 0.3, s.lies = 1e-3;  // below it the law has taken all that it can: a millimetre in a tenth of a second
    CHECK(erosion::Shear{}.rate(s) == Approx(0.01));
    s.eroded = 0.0, s.lies = 0.3, s.bears = 2800.0;
    CHECK(erosion::Jump{}.rate(s) == Approx(200.0 / (2000.0 * 5.0)));
    CHECK(erosion::Shear{}.rate(s) == Approx(0.025 * 0.02 / 0.3));
    s.bears = 3000.0;
    CHECK(erosion::Jump{}.rate(s) == 0.0);
    CHECK(erosion::Shear{}.rate(s) == 0.0);
    s.normal_gravity = 8.0;
    CHECK(erosion::Mechanical{0.01, 0.5}.rate(s) == 0.0);
}

TEST_CASE("Erosion laws give four points what they give each", "[erosion]") {
    erosion::StateOf<Double4> four;
    four.thickness = Double4{0.1, 2.0, 0.5, 7.0}, four.speed = Double4{30.0, 5.0, 0.01, 1.0};
    four.stress = Double4{100.0, 3000.0, 900.0, 20000.0}, four.normal_gravity = Double4{8.0, 9.8, 3.0, 9.0};
    four.eroded = Double4{0.0, 0.19, 0.3, 0.05}, four.left = Double4{0.3, 0.0, 1e-9, 2.0};
    four.edge = Double4{1.0, 2.5, 0.3, 10.0}, four.lies = Double4{0.0, 0.2, 1e-9, 0.4};
    four.bears = Double4{0.0, 2000.0, 1000.0, 19000.0};
    four.density = 2000.0, four.bed_density = 1600.0, four.dt = 0.1;
    for (const ErosionLaw& any_law : kLaws)
        std::visit(
            [&](const auto& law) {
                const Double4 rates = law.rate(four);
                for (int n = 0; n < 4; ++n) {
                    INFO(law.name << ", point " << n);
                    const erosion::State one{four.thickness[n], four.speed[n], four.stress[n],   four.normal_gravity[n],
                                             four.eroded[n],    four.left[n],  four.edge[n],     four.lies[n],
                                             four.bears[n],     four.density,  four.bed_density, four.dt};
                    CHECK(rates[n] == law.rate(one));
                }
            },
            any_law);
}
