// Material that rests becomes bed: nothing is lost, the surface stays, later flow runs over it and may take it up again.
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analytic_scene.h"
#include "catch.h"
#include "checks/verify/placement.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "run/memory_state.h"
#include "same_run.h"
#include "shallow/depth_averaged.h"
#include "threads_of_test.h"

using namespace frana;
using namespace frana::test;

namespace {

double cap(double x, double y, double x0, double depth) {
    const double r2 = ((x - x0) * (x - x0) + (y - 40.3) * (y - 40.3)) / 144.0;
    return depth * std::max(0.0, 1.0 - r2);
}

/// A slope above a plain where a slide comes to rest; another one follows at 12 s.
Scene slope(const std::function<void(Scene&)>& edit = {}, Index width = 140) {
    Scene scene = scene_on(width, 80, 1.0, [](double x, double y) {
        return (x < 50.0 ? 0.8 * (50.0 - x) : 0.0) + 0.002 * (y - 40) * (y - 40);
    });
    scene.bed_law = bed::Coulomb{0.45};
    fill(scene, [](double x, double y) { return cap(x, y, 22.2, 1.5); });
    const Seeds first = scene.particles;
    scene.particles = {};
    fill(scene, [](double x, double y) { return cap(x, y, 20.1, 2.5); });
    scene.late.push_back({"second", 12.0, scene.particles, first.count()});
    scene.particles = first;
    scene.deposition = Deposition{2.0};
    if (edit) edit(scene);
    return scene;
}

/// Loose ground that is nothing but what came to lie on the rock.
void make_hungry(Scene& scene) {
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.0), scene.density, erosion::Growth{0.05}};
}

/// A flow of points at rest but for one tile, and its bed, without a run around them.
struct Still {
    explicit Still(const Scene& scene) : flow(scene), erosion(scene, flow), transfer(make_transfer(scene)) {
        place(scene.particles);
    }
    void place(const Seeds& seeds) {
        Particles& c = flow.particles;
        c.resize(seeds.count());
        for (Index p = 0; p < seeds.count(); ++p) {
            c.x[p] = seeds.x[p], c.y[p] = seeds.y[p], c.id[p] = p, c.mass[p] = seeds.volume[p] * flow.density;
            c.r1x[p] = c.r2y[p] = 0.5, c.depth[p] = seeds.depth[p];
            c.r1y[p] = c.r2x[p] = c.vx[p] = c.vy[p] = c.cxx[p] = c.cxy[p] = c.cyx[p] = c.cyy[p] = 0.0;
        }
        sorter.sort(c, flow.grid, {}, flow.active);
    }
    std::vector<double> levels() {
        transfer->deposit(flow, 0.1);
        std::vector<double> all;
        for (Index j = 0; j < flow.grid.ny(); ++j)
            for (Index i = 0; i < flow.grid.nx(); ++i) {
                const Index k = flow.grid.at(i, j);
                const bool touched = flow.is_in_reach(i, j);
                all.push_back(flow.bed.z[k] + (touched ? flow.nodes.column_mass[k] / (flow.density * flow.area) : 0.0));
            }
        return all;
    }
    bool settle() {
        Status now;  // where nothing has had a speed, only what does not move at all rests
        now.mass = 1.0, now.mean_speed = mean_speed;
        now.step = ++steps, now.dt = 0.5, now.time = 0.5 * static_cast<double>(steps);
        if (!erosion.settle(flow, now)) return false;
        sorter.drop(flow.particles, erosion.gone(), flow.active);
        return true;
    }

    Flow flow;
    Erosion erosion;
    std::unique_ptr<TransferKernel> transfer;
    TileSorter sorter;
    Index steps = 0;
    double mean_speed = 0.0;  ///< that the flow has had [m/s]
};

Scene puddle() {
    Scene scene =
        scene_on(70, 60, 1.0, [](double x, double y) { return 0.3 * std::sin(0.2 * x) * std::cos(0.15 * y); });
    scene.bed_law = bed::Coulomb{0.5};
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 30) < 20 ? 2.0 : 0.0; },
        verify::Placement::full_jitter, 2);
    make_hungry(scene);
    scene.erodible->momentum = 1.0;  // points are not set back: they reach all that they left
    scene.deposition = Deposition{1.0};
    return scene;
}

double farthest(const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) most = std::max(most, std::abs(a[n] - b[n]));
    return most;
}

}  // namespace

TEST_CASE("The surface does not move when material becomes bed, and what moves stays", "[deposition]") {
    const Scene scene = puddle();
    Still still(scene);
    const Index moving = still.flow.active.tile[4];
    for (Index p = still.flow.active.begin[4]; p < still.flow.active.begin[5]; ++p) still.flow.particles.cxy[p] = 1e-9;
    const Index count = still.flow.particles.count(), stay = still.flow.active.begin[5] - still.flow.active.begin[4];
    REQUIRE((stay > 100 && count > 3 * stay));
    const std::vector<double> before = still.levels();
    REQUIRE_FALSE(still.settle());  // half a second of one
    REQUIRE(still.settle());
    CHECK(still.flow.particles.count() == stay);
    for (Index n = 0; n < still.flow.active.count(); ++n)
        if (still.flow.active.begin[n + 1] > still.flow.active.begin[n]) CHECK(still.flow.active.tile[n] == moving);
    CHECK(farthest(still.levels(), before) <= 4e-15);  // round-off of 2 m
    const Status::Bed bed = still.erosion.status();
    CHECK(bed.deposited > 1000.0);
    CHECK(std::abs(bed.mass - bed.deposited) <= 1e-14 * bed.deposited);
}

// It was slower than a twentieth of the mean speed that the first release had had, so it rested: all of it became bed.
TEST_CASE("A release on a steep slope does not become bed before it has moved", "[deposition]") {
    Scene scene = scene_on(101, 31, 1.0, [](double x, double) { return 60.0 - 0.5 * x; });
    scene.bed_law = bed::Coulomb{0.1};
    const auto block = [](double from) {
        return [from](double x, double y) { return x > from && x < from + 8 && y > 10 && y < 20 ? 1.0 : 0.0; };
    };
    fill(scene, block(6.0));
    const Seeds late = scene.particles;
    const bool on_what_lies_there = GENERATE(false, true);
    scene.particles = {};
    fill(scene, block(on_what_lies_there ? 6.0 : 30.0));
    scene.late.push_back({"late", 2.0, late, scene.particles.count()});
    scene.deposition = Deposition{GENERATE(0.0, 0.05)};
    CAPTURE(scene.deposition->rest, on_what_lies_there);
    scene.end = 3.0;
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    while (run->status().time < scene.end) run->advance(scene.end);
    CHECK(run->status().bed.deposited == 0.0);
}

TEST_CASE("Points stay that deposit on a node in motion, and they alone, until it has rested", "[deposition]") {
    const Scene scene = puddle();
    Still still(scene);
    const Index i = 37, j = 22, moving = still.flow.grid.at(i, j);
    const auto touches = [&](double x, double y) {  // at places half a cell wide, sub-points reach an eighth farther
        return std::abs(x - double(i)) < 1.625 && std::abs(y - double(j)) < 1.625;
    };
    const Particles& c = still.flow.particles;
    const Index near = std::count_if(c.id.begin(), c.id.end(), [&](Index p) { return touches(c.x[p], c.y[p]); });
    REQUIRE((near > 20 && 10 * near < c.count()));
    const std::vector<double> before = still.levels();
    REQUIRE_FALSE(still.settle());
    still.flow.nodes.motions()[moving].vy = -1e-300;
    REQUIRE(still.settle());
    CHECK(c.count() == near);
    for (Index p = 0; p < c.count(); ++p) CHECK(touches(c.x[p], c.y[p]));
    CHECK(farthest(still.levels(), before) <= 4e-15);
    still.flow.nodes.motions()[moving].vy = 0.0;
    REQUIRE_FALSE(still.settle());  // its clock begins anew
    REQUIRE(still.settle());
    CHECK(c.count() == 0);
}

TEST_CASE("A heap becomes bed while a film slides within the same 16 cells", "[deposition]") {
    Scene scene = scene_on(40, 16, 1.0, [](double x, double) { return 0.8 * std::max(0.0, x - 9.0); });
    scene.bed_law = bed::Coulomb{0.45};
    const auto heap = [](double x, double y) {
        return std::max(0.0, 0.5 - 0.05 * ((x - 4.1) * (x - 4.1) + (y - 7.6) * (y - 7.6)));
    };
    const auto film = [](double x, double y) { return x > 12.0 && x < 14.5 && y > 5.0 && y < 10.0 ? 0.05 : 0.0; };
    fill(scene, heap);
    double of_heap = 0.0;
    for (const double volume : scene.particles.volume) of_heap += volume * scene.density;
    fill(scene, film);
    scene.deposition = Deposition{0.5};
    DepthAveraged simulation(scene);
    const Flow& flow = simulation.flow();
    const auto surface = [&] {
        std::vector<double> all;
        for (Index j = 0; j < 16; ++j)
            for (Index i = 0; i < 9; ++i) {
                const Index k = flow.grid.at(i, j);
                all.push_back(flow.bed.z[k] + (flow.is_in_reach(i, j) ? flow.nodes.depth[k] : 0.0));
            }
        return all;
    };
    const std::vector<double> before = surface();
    double slowest = 1.0;
    while (simulation.status().time < 1.2) {
        simulation.advance(1.2);
        if (simulation.status().time > 0.4) slowest = std::min(slowest, simulation.status().max_speed);
    }
    REQUIRE(slowest > 0.5);  // the film never rested
    for (const double x : flow.particles.x) REQUIRE((x > 9.0 && x < 15.0));
    CHECK(simulation.status().bed.deposited == Approx(of_heap).epsilon(1e-12));
    CHECK(farthest(surface(), before) <= 1e-15);
}

TEST_CASE("What has become bed is taken up again to the last crumb: the bed is that of the start", "[deposition]") {
    const Scene scene = puddle();
    Still still(scene);
    std::vector<double> start;
    const auto heights = [&] {
        std::vector<double> all;
        for (Index j = 0; j < still.flow.grid.ny(); ++j)
            for (Index i = 0; i < still.flow.grid.nx(); ++i) all.push_back(still.flow.bed.z[still.flow.grid.at(i, j)]);
        return all;
    };
    const std::vector<double> rock = heights();
    still.levels(), still.settle(), still.settle();
    REQUIRE(still.flow.particles.count() == 0);
    CHECK(farthest(heights(), rock) > 1.5);
    // The same points come again, in motion.
    still.place(scene.particles);
    for (double& vx : still.flow.particles.vx) vx = 1.0;
    still.transfer->deposit(still.flow, 0.1);
    double taken = 0.0;
    for (int n = 0; n < 60; ++n) {
        still.erosion.wait(1.0);
        taken += still.erosion.exchange(still.flow, {1.0}).taken;
    }
    const Status::Bed bed = still.erosion.status();
    CHECK(taken == Approx(bed.deposited).epsilon(1e-11));
    CHECK(std::abs(bed.mass - (bed.deposited - bed.eroded)) <= 1e-13 * bed.deposited);
    CHECK(farthest(heights(), rock) <= 2e-12);  // a crumb of 1e-12 of a cell stays, and round-off
    CHECK(bed.deepest == 0.0);                  // nothing of the rock
}

namespace {

double sum_of(const Frame& frame, const char* field) {
    const double* data = frame.node(field)->data;
    return std::accumulate(data, data + frame.grid.size(), 0.0);
}

/// A slab that comes down an even slope at 8 m/s, which holds it: 30 m long, 20 m wide, 1 m deep.
Scene slab(const std::function<double(double, double)>& rough = {}) {
    Scene scene =
        scene_on(150, 40, 1.0, [&](double x, double y) { return 30.0 - 0.15 * x + (rough ? rough(x, y) : 0.0); });
    scene.bed_law = bed::Voellmy{0.3, 500.0};
    fill(scene, [](double x, double y) { return x > 20.0 && x < 50.0 && y > 10.0 && y < 30.0 ? 1.0 : 0.0; });
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), 8.0);
    scene.deposition = Deposition{3.0};
    return scene;
}

}  // namespace

TEST_CASE("What a flow lays down on loose ground stays there, whatever law its stress erodes by", "[deposition]") {
    // Before a deposit bore what had held it, a creeping rest took it up and laid it down for ever.
    const ErosionLaw law = GENERATE(as<ErosionLaw>(), erosion::Jump{500.0}, erosion::Shear{0.025, 500.0, 1e-4},
                                    erosion::Mechanical{0.1, 0.1});
    CAPTURE(law.index());
    Scene scene = slab();
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.3), scene.density, law};
    DepthAveraged simulation(scene);
    const Status first = simulation.frame().status;
    while (simulation.status().time < 60.0 && simulation.status().particles > 0) {
        simulation.advance(60.0);
        REQUIRE(std::abs(budget(first, simulation.status()).mass_error) <= 1e-13);
        REQUIRE(std::abs(budget(first, simulation.status()).bed_error) <= 1e-13);
    }
    const Status& now = simulation.status();
    CHECK(now.particles == 0);
    CHECK(now.bed.eroded > 0.01 * first.mass);
    CHECK(now.bed.mass == Approx(first.bed.mass + first.mass).epsilon(1e-12));
    const double again = now.bed.eroded - scene.density * sum_of(simulation.frame(), "eroded_depth");
    CHECK(again <= 0.02 * now.bed.deposited);
}

TEST_CASE("A slab that stops on rough ground becomes bed with all that still creeps in it", "[deposition]") {
    const Scene scene = slab([](double x, double y) { return 0.15 * std::sin(0.7 * x) * std::cos(0.9 * y); });
    DepthAveraged simulation(scene);
    const Status first = simulation.frame().status;
    double momentum = 0.0;
    while (simulation.status().time < 60.0 && simulation.status().particles > 0) {
        simulation.advance(60.0);
        momentum = std::max(momentum, std::abs(simulation.status().momentum[0]));
    }
    const Status& now = simulation.status();
    CHECK(now.particles == 0);
    CHECK(now.bed.mass == Approx(first.mass).epsilon(1e-13));
    for (const double residual : budget(first, now).momentum_residual) CHECK(std::abs(residual) <= 1e-11 * momentum);
    const double volume = std::accumulate(scene.particles.volume.begin(), scene.particles.volume.end(), 0.0);
    CHECK(sum_of(simulation.frame(), "deposited_depth") == Approx(volume).epsilon(1e-12));
}

TEST_CASE("What creeps more slowly than a run's rest becomes bed, and what begins to move does not", "[deposition]") {
    const Scene scene = puddle();
    Still still(scene);
    still.flow.particles.vx.assign(still.flow.particles.vx.size(), 1e-3);
    const double peak = GENERATE(0.019, 0.021);  // a twentieth of it is above 1e-3 m/s, or below
    still.mean_speed = peak;
    still.levels();
    const bool driven = GENERATE(false, true);  // from rest, by forces that nothing holds
    for (Index k = 0; k < still.flow.grid.size(); ++k) {
        still.flow.nodes.motions()[k].vx = 1e-3;
        still.flow.nodes.before[k] = {driven ? 0.0 : 1e-3, 0.0};
    }
    for (int n = 0; n < 3; ++n) still.settle();
    CHECK((still.flow.particles.count() == 0) == (peak > 0.02 && !driven));
}

TEST_CASE("A lens at rest becomes bed with the energy that it had", "[deposition]") {
    Scene scene = scene_on(60, 80, 1.0, [](double x, double) { return 10.0 + 0.01 * x; });
    scene.bed_law = bed::Coulomb{0.45};  // its sides have a quarter at most
    fill(scene, [](double x, double y) { return cap(x, y, 30.2, 1.5); });
    scene.deposition = Deposition{1.0};
    DepthAveraged simulation(scene);
    const Status first = simulation.frame().status;
    while (simulation.status().time < 5.0 && simulation.status().particles > 0) simulation.advance(5.0);
    const Status& now = simulation.status();
    REQUIRE(now.particles == 0);
    CHECK(now.bed.deposited == Approx(first.mass).epsilon(1e-13));
    CHECK(std::abs(budget(first, now).energy_residual) <= 1e-12 * std::abs(first.potential));
}

TEST_CASE("Flow, bed and what left have the mass of the start when flow becomes bed", "[deposition]") {
    for (const bool hungry : {false, true})
        for (const Sides sides : {Sides::open, Sides::wall}) {
            INFO("hungry " << hungry << ", walls " << (sides == Sides::wall));
            const Scene scene = slope([&](Scene& s) {
                if (hungry) make_hungry(s);
                s.sides = sides;
            });
            DepthAveraged simulation(scene);
            const Status first = simulation.frame().status;
            double momentum = 0.0;
            while (simulation.status().time < 30.0) {
                simulation.advance(30.0);
                const Status now = simulation.status();
                momentum = std::max(momentum, std::hypot(now.momentum[0], now.momentum[1]));
                REQUIRE(std::abs(budget(first, now).mass_error) <= 1e-13);
                REQUIRE(std::abs(budget(first, now).bed_error) <= 1e-13);
            }
            const Frame frame = simulation.frame();
            const Status& now = frame.status;
            REQUIRE(now.bed.deposited > 0.05 * (now.mass + now.bed.mass));
            CHECK((now.bed.eroded > 0.0) == hungry);
            for (const double residual : budget(first, now).momentum_residual)
                CHECK(std::abs(residual) <= 1e-11 * momentum);
            const double *change = frame.node("bed_change")->data, *deposit = frame.node("deposited_depth")->data;
            const double* z = frame.node("elevation")->data;
            const DepthAveraged rock(scene);
            double off = 0.0, deepest = 0.0;
            for (Index j = 0; j < frame.grid.ny; ++j)
                for (Index i = 0; i < frame.grid.nx; ++i) {
                    const Index n = j * frame.grid.nx + i;
                    off = std::max(off, std::abs(z[n] - change[n] - rock.flow().bed.z[rock.flow().grid.at(i, j)]));
                    deepest = std::max(deepest, deposit[n]);
                    REQUIRE(change[n] == deposit[n]);  // below it is rock
                }
            CHECK(off <= 1e-12);  // of 40 m, some hundred times
            CHECK(deepest > 0.3);
        }
}

TEST_CASE("Deposition has the same bits on any number of threads and after it is taken up again",
          "[deposition][threads]") {
    const Threads restore;
    const Scene scene = slope([](Scene& s) { make_hungry(s); });
    omp_set_num_threads(1);
    DepthAveraged straight(scene);
    std::vector<MemoryArchive> kept;
    for (const double at : {8.0, 11.0, 15.0, 22.0}) {
        run_to(straight, at);
        straight.serialize(kept.emplace_back());
    }
    run_to(straight, 26.0);
    REQUIRE(straight.status().bed.deposited > 0.0);
    REQUIRE(straight.status().bed.eroded > 0.0);
    for (const int threads : {2, 4}) {
        omp_set_num_threads(threads);
        DepthAveraged again(scene);
        for (const double at : {8.0, 11.0, 15.0, 22.0, 26.0}) run_to(again, at);
        check_same(again, straight, "bed/fresh");
    }
    for (std::size_t n = 0; n < kept.size(); ++n) {
        INFO("kept " << n);
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(kept[n].rewind());
        for (const double at : {8.0, 11.0, 15.0, 22.0, 26.0}) run_to(resumed, at);
        check_same(resumed, straight, "bed/fresh");
    }
}

TEST_CASE("A second surge runs over what the first one left, and takes some of it up", "[deposition]") {
    const Scene scene = slope([](Scene& s) { make_hungry(s); });
    DepthAveraged simulation(scene);
    run_to(simulation, 11.9);
    const Status before = simulation.status();
    REQUIRE(before.bed.deposited > 0.05 * before.mass);
    CHECK(before.bed.mass == Approx(before.bed.deposited - before.bed.eroded).epsilon(1e-12));
    run_to(simulation, 18.0);
    const Status after = simulation.status();
    CHECK(after.bed.eroded - before.bed.eroded > 0.01 * before.bed.deposited);
    // Over rock, that the first one lies on, the second one takes nothing.
    const Scene plain = slope();
    DepthAveraged other(plain);
    run_to(other, 18.0);
    CHECK(other.status().bed.eroded == 0.0);
    CHECK(other.status().bed.mass == Approx(other.status().bed.deposited).epsilon(1e-12));
}

TEST_CASE("A deposition that nothing has rested long enough for changes no bit of the flow", "[deposition][sleep]") {
    DepthAveraged with(slope([](Scene& s) { s.deposition->rest = 1e6; }));
    DepthAveraged without(slope([](Scene& s) { s.deposition.reset(); }));
    run_to(with, 20.0);
    run_to(without, 20.0);
    auto of_with = state_bits(with);
    for (const auto& [name, entry] : state_bits(without)) {
        INFO(name);
        if (name != "status/numbers") CHECK((of_with.at(name) == entry));
    }
    CHECK(with.status().kinetic == without.status().kinetic);
}

TEST_CASE("What sleeps becomes bed in the same step as what does not", "[deposition][sleep]") {
    // After five seconds tiles sleep whose particles have not all rested for as long. Far away a heap sleeps meanwhile.
    const double rest = GENERATE(2.0, 5.0);
    INFO("rest " << rest);
    const auto scene = [&](bool sleep) {
        const auto edit = [&](Scene& s) {
            const Seeds slide = s.particles;
            const Index id = slide.count() + s.late[0].seeds.count();
            s.particles = {};
            fill(s, [](double x, double y) { return cap(x, y, 230.2, 1.5); });
            s.late.push_back({"far", 9.0, s.particles, id});
            s.late[0].at = 18.0;  // wakes all
            s.particles = slide, s.deposition->rest = rest, s.scheme.sleep = sleep;
        };
        return slope(edit, 250);
    };
    DepthAveraged sleeps(scene(true)), awake(scene(false));
    Index partly = 0;
    while (sleeps.status().time < 25.0) {
        const std::vector<std::uint8_t> quiet = sleeps.flow().active.quiet;
        const double had = sleeps.status().bed.mass;
        sleeps.advance(25.0);
        const ActiveTiles& active = sleeps.flow().active;
        const bool some = some_asleep(sleeps.flow());
        for (Index n = 0; some && sleeps.status().bed.mass > had && n < active.count(); ++n)
            partly += active.begin[n + 1] > active.begin[n] && quiet[active.tile[n]] >= kAsleep &&
                      active.quiet[active.tile[n]] == 0;
        awake.advance(25.0);
        CHECK(awake.status().bed.mass == sleeps.status().bed.mass);
        REQUIRE(awake.status().mass == sleeps.status().mass);
        REQUIRE(awake.status().potential == sleeps.status().potential);
    }
    REQUIRE(sleeps.status().bed.deposited > 0.0);
    CHECK((partly > 0 || rest < 5.0));
    auto of_awake = state_bits(awake);
    for (const char* name : {"bed/fresh", "bed/z", "points/x", "points/mass", "status/numbers"}) {
        INFO(name);
        CHECK((of_awake.at(name) == state_bits(sleeps).at(name)));
    }
}

TEST_CASE("A state put aside before material becomes bed is taken up with the bed that it had", "[deposition]") {
    DepthAveraged simulation(slope());
    run_to(simulation, 5.0);
    MemoryState aside;
    aside.save(simulation);
    const double had = simulation.status().bed.mass;
    const auto bed = [&] {
        std::vector<double> numbers;
        for (Index k = 0; k < simulation.flow().grid.size(); ++k)
            for (const double number : {simulation.flow().bed.z[k], simulation.erosion()->fresh(k)})
                numbers.push_back(number);
        return numbers;
    };
    const std::vector<double> before = bed();
    for (int n = 0; n < 400 && simulation.status().bed.mass == had; ++n) simulation.advance(11.0);
    REQUIRE(simulation.status().bed.mass > had);
    CHECK((bed() != before));
    aside.load(simulation);
    CHECK((bed() == before));
    CHECK(simulation.erosion()->status().mass == had);
}

TEST_CASE("Where nothing can rest, a run that is taken up again has the same bits of the bed's rest", "[deposition]") {
    const Scene scene = slope([](Scene& s) {
        s.bed_law = bed::None{};
        s.deposition->rest.reset();  // as the reader of cases does then
    });
    DepthAveraged straight(scene);
    run_to(straight, 3.0);
    MemoryArchive kept;
    straight.serialize(kept);
    DepthAveraged resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    for (const double at : {3.0, 6.0}) run_to(straight, at), run_to(resumed, at);  // onto ground that was dry at 3 s
    check_same(resumed, straight, "bed/fresh");
}

TEST_CASE("What enters next to a wall rests as long as what enters elsewhere before it is bed", "[deposition][late]") {
    // Nodes at walls are always taken to be touched: they do not rest before something lies on them.
    Scene scene = scene_on(40, 30, 1.0, [](double, double) { return 0.0; });
    scene.sides = Sides::wall;
    scene.bed_law = bed::Coulomb{0.6};
    scene.deposition = Deposition{5.0};
    const auto heap = [&](double x, double y) {
        scene.particles = {};
        fill(scene, [=](double i, double j) { return std::max(0.0, 0.4 - 0.1 * std::hypot(i - x, j - y)); });
        return scene.particles;
    };
    const Seeds late = heap(4.0, 12.0), first = heap(4.0, 4.0);
    scene.late.push_back({"late", 3.0, late, static_cast<Index>(first.x.size())});
    DepthAveraged run(scene);
    double entered = 0.0, gone = 0.0;
    while (run.status().time < 20.0 && gone == 0.0) {
        run.advance(20.0);
        if (entered == 0.0 && run.status().mass_in > 0.0) entered = run.status().time;
        if (entered > 0.0 && run.flow().particles.count() == 0) gone = run.status().time;
    }
    REQUIRE(entered >= 3.0);
    REQUIRE(gone > 0.0);
    CHECK(gone - entered >= 5.0);
}
