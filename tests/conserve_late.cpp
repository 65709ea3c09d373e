// Releases that enter later: the bits of a run that starts then, the right step, budgets, threads and resumes.
#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "coupling/growing_particles.h"
#include "coupling/walled_particles.h"
#include "growing_slope.h"
#include "observe/budget.h"
#include "run/memory_state.h"
#include "run/run_loop.h"
#include "same_run.h"

using namespace frana;
using namespace frana::test;

namespace {

/// What was filled last becomes a release that enters later; nothing for `at`: when it is hit.
void delay(Scene& scene, const std::string& name, std::optional<double> at, const Function& depth) {
    const Seeds before = scene.particles;
    scene.particles = {};
    fill(scene, depth);
    Index id = before.count();
    for (const LateRelease& late : scene.late) id += late.seeds.count();
    scene.late.push_back({name, at, scene.particles, id});
    scene.particles = before;
}

double cap(double x, double y, double x0, double y0, double depth) {
    const double r2 = ((x - x0) * (x - x0) + (y - y0) * (y - y0)) / 64.0;
    return depth * std::max(0.0, 1.0 - r2);
}

/// Flat in the west, where a cap rests; steeper than the friction holds in the east, where another one starts.
Scene shelf() {
    Scene scene = scene_on(120, 45, 1.0, [](double x, double) { return x < 50.0 ? 0.0 : 0.8 * (x - 50.0); });
    scene.bed_law = bed::Coulomb{0.6};
    return scene;
}
double resting(double x, double y) { return cap(x, y, 20.3, 22.1, 0.5); }
double sliding(double x, double y) { return cap(x, y, 95.2, 21.7, 1.0); }

/// A slab slides onto a second one, and that onto a third one beside it, which overlaps it.
Scene chain() {
    Scene scene =
        scene_on(130, 45, 1.0, [](double x, double y) { return 60.0 - 0.4 * x + 0.004 * (y - 22) * (y - 22); });
    scene.bed_law = bed::Voellmy{0.1, 300.0};
    fill(scene, [](double x, double y) { return cap(x, y, 32, 22, 1.5); });
    delay(scene, "second", {}, [](double x, double y) { return cap(x, y, 60, 22, 1.0); });
    delay(scene, "third", {}, [](double x, double y) { return cap(x, y, 66, 27, 1.0); });
    delay(scene, "far", {}, [](double x, double y) { return cap(x, y, 10, 22, 1.0); });
    return scene;
}

const LateEntry& entry(const Extras& extras, std::size_t n) { return extras.late.at(n); }

/// Places, motion and depth of all particles.
void require_same_particles(const DepthAveraged& a, const DepthAveraged& b) {
    const Particles &c = a.flow().particles, &d = b.flow().particles;
    REQUIRE((c.x == d.x));
    REQUIRE((c.y == d.y));
    REQUIRE((c.mass == d.mass));
    REQUIRE((c.depth == d.depth));
    REQUIRE((c.vx == d.vx));
    REQUIRE((c.vy == d.vy));
    REQUIRE((c.cxx == d.cxx));
    REQUIRE((c.r1x == d.r1x));
}

ErodibleBed loose_ground(const Scene& scene) {
    ErodibleBed bed;
    bed.density = scene.density;
    bed.depth = Raster::filled(scene.bed.geometry, 0.5);
    bed.law = erosion::Growth{1e-3};
    return bed;
}

}  // namespace

TEST_CASE("A release that enters later is a run that starts then, with the same bits", "[late]") {
    for (const bool slab : {false, true})
        for (const char* what : {"", "mud", "loose"}) {
            constexpr double kAt = 3.7;  // no sum of ordinary steps
            Scene now = shelf(), later = shelf();
            const bool mud = std::string(what) == "mud";
            if (std::string(what) == "loose") now.erodible = later.erodible = loose_ground(now);
            if (mud) now.rheology = later.rheology = rheology::Bingham{50.0, 100.0};
            if (slab) fill(now, resting), fill(later, resting);
            fill(now, sliding), delay(later, "slide", kAt, sliding);
            DepthAveraged from_start(now), late(later);
            REQUIRE(late.more_comes());
            REQUIRE_FALSE(late.may_rest());
            const Status first = late.status();
            run_to(late, kAt);
            INFO("slab " << slab << ", " << what);
            REQUIRE(late.status().time == kAt);
            REQUIRE_FALSE(late.more_comes());
            REQUIRE(entry(late.extras(), 0).entered == kAt);
            if (!slab) require_same_particles(late, from_start);  // the slab's carry a depth that they felt meanwhile
            // The balance is closed at once: what came in is what the nodes have.
            CHECK(std::abs(budget(first, late.status()).energy_residual) <= 1e-12 * late.status().potential);
            double farthest = 0.0;
            for (int step = 0; step < 60; ++step) {
                late.advance(1e3), from_start.advance(1e3);
                REQUIRE(late.status().dt == from_start.status().dt);
                REQUIRE((late.flow().particles.id == from_start.flow().particles.id));
                require_same_particles(late, from_start);
                REQUIRE(late.status().kinetic == from_start.status().kinetic);
                REQUIRE(late.status().max_depth == from_start.status().max_depth);
                farthest = std::max(farthest, from_start.status().max_speed_on_map);
            }
            CHECK(farthest > 1.0);
            CHECK(std::abs(budget(first, late.status()).mass_error) < 1e-14);
        }
}

TEST_CASE("What enters next to a flow in motion closes the budgets", "[late]") {
    Scene scene = chain();
    scene.late[0].at = 2.0, scene.late[1].at = 2.0, scene.late[2].at = 2.5;
    for (double& v : scene.late[1].seeds.vx) v = 3.0;
    for (const Sides sides : {Sides::open, Sides::wall}) {
        scene.sides = sides;
        DepthAveraged run(scene);
        const Status first = run.status();
        double came = 0.0;
        while (run.status().time < 6.0) {
            run.advance(6.0);
            const Status& now = run.status();
            CHECK(std::abs(budget(first, now).mass_error) < 1e-13);
            came = 0.0;
            for (const LateEntry& late : run.extras().late)
                if (late.entered) came += late.volume;
            CHECK(now.mass_in / scene.density == Approx(came).epsilon(1e-14));
        }
        CHECK(came > 0.0);
        const Status now = run.frame().status;
        const Budget b = budget(first, now);
        // Of a momentum of the order of mass times 10 m/s: round-off of the sums.
        CHECK(std::hypot(b.momentum_residual[0], b.momentum_residual[1]) < 1e-11 * now.mass * 10.0);
        for (std::size_t n = 0; n < 3; ++n) CHECK(entry(run.extras(), n).entered == (n < 2 ? 2.0 : 2.5));
    }
}

TEST_CASE("Energy that the scheme loses is not changed by what enters", "[late]") {
    // Where nothing else is, as in a run that starts then; what moves meanwhile loses half a step's at most.
    Scene scene = chain();
    scene.late.resize(1), scene.late[0].at = 2.0;
    DepthAveraged run(scene);
    const Status first = run.frame().status;
    run_to(run, 2.0);
    const double at_entry = budget(first, run.frame().status).energy_residual;
    Scene alone = scene;
    alone.late.clear();
    DepthAveraged reference(alone);
    run_to(reference, 2.0);
    const Status now = reference.frame().status;
    const double without = budget(first, now).energy_residual;
    CHECK(at_entry == Approx(without).margin(1e-3 * now.kinetic));
}

TEST_CASE("A state put aside before a release enters comes back with all that it touches", "[late][erosion][resume]") {
    Scene scene = shelf();
    fill(scene, resting);
    delay(scene, "late", 1.0, sliding);  // tiles away from what is there
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, 0.5), scene.density, erosion::Steady{0.5}};
    DepthAveraged simulation(scene);
    while (simulation.status().time < 0.9) simulation.advance(0.9);
    // The bed is kept for the tiles that may have changed, so more of them after a load: its numbers are compared by node.
    const auto bed = [&] {
        const Flow& flow = simulation.flow();
        std::vector<double> numbers;
        for (Index k = 0; k < flow.grid.size(); ++k)
            for (const double number :
                 {flow.bed.z[k], flow.bed.ground[k], flow.bed.slope_x[k], simulation.erosion()->left(k)})
                numbers.push_back(number);
        return numbers;
    };
    const auto before = state_bits(simulation);
    const std::vector<double> bed_before = bed();
    MemoryState aside;
    aside.save(simulation);
    for (int n = 0; n < 3; ++n) simulation.advance(1.0 + 0.1 * n);
    REQUIRE(simulation.status().time > 1.0);
    REQUIRE(simulation.status().bed.eroded > 0.0);
    CHECK((bed() != bed_before));
    aside.load(simulation);
    CHECK((bed() == bed_before));
    const auto after = state_bits(simulation);
    REQUIRE(after.size() == before.size());
    for (const auto& [name, entry] : before) {
        INFO(name);
        if (name.rfind("bed/", 0) != 0) CHECK((after.at(name) == entry));
    }
    CHECK(simulation.erosion()->status().mass == simulation.erosion()->status().initial);
}

TEST_CASE("A release that is hit enters when one of its nodes is first deeper than the footprint depth", "[late]") {
    const Scene scene = chain();
    Scene bare = scene;
    bare.late.clear();
    DepthAveraged run(scene), flow(bare);
    std::vector<Index> nodes;  // of the second one
    for (std::size_t p = 0; p < scene.late[0].seeds.x.size(); ++p)
        nodes.push_back(flow.flow().grid.nearest(scene.late[0].seeds.x[p], scene.late[0].seeds.y[p]));
    const auto depth_there = [&] {
        double deepest = 0.0;
        for (const Index k : nodes) deepest = std::max(deepest, flow.flow().nodes.depth[k]);
        return deepest;
    };
    while (depth_there() <= bare.output.footprint_depth) {
        REQUIRE_FALSE(entry(run.extras(), 0).entered.has_value());
        require_same_particles(run, flow);
        REQUIRE(flow.status().time < 20.0);
        flow.advance(20.0), run.advance(20.0);
    }
    CHECK(flow.status().step > 5);
    CHECK(run.status().step == flow.status().step);
    CHECK(entry(run.extras(), 0).entered == flow.status().time);
    CHECK(entry(run.extras(), 1).entered == flow.status().time);  // by what entered
    CHECK(run.status().particles > flow.status().particles);
    run_to(run, 8.0);
    CHECK_FALSE(entry(run.extras(), 2).entered.has_value());
    CHECK(run.may_rest());  // nothing else comes by itself
    REQUIRE(run.remarks().size() == 1);
    CHECK(run.remarks()[0].rfind("far: its ", 0) == 0);
}

TEST_CASE("What is hit at the start enters at the start", "[late]") {
    Scene scene = chain();
    delay(scene, "under it", {}, [](double x, double y) { return cap(x, y, 34, 22, 0.5); });
    const DepthAveraged run(scene);
    CHECK(entry(run.extras(), 3).entered == 0.0);
    CHECK(run.status().mass_in == Approx(scene.density * scene.late[3].volume()).epsilon(1e-14));
    CHECK(mass_came_in(run.status(), run.status()) == 0.0);  // it was there in the first frame
}

TEST_CASE("Late releases have the same bits on any number of threads, and when a run goes on between them",
          "[late][resume][threads]") {
    Scene scene = chain();
    delay(scene, "timed", 4.3, [](double x, double y) { return cap(x, y, 90, 20, 1.0); });
    const Extras extras =
        check_resumed_often(scene, 7.0, 8, [](auto& run, auto& straight) { check_same(run, straight); });
    for (const std::size_t n : {0, 1, 3}) REQUIRE(entry(extras, n).entered.has_value());
}

TEST_CASE("A run waits for a release with a time, and is over without one that nothing hits", "[late]") {
    Scene scene = shelf();
    fill(scene, resting);
    delay(scene, "slide", 6.0, sliding);
    delay(scene, "never", {}, [](double x, double y) { return cap(x, y, 110, 5, 1.0); });
    DepthAveraged simulation(scene);
    Observers observers;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    RunPlan plan{300.0, 7.0, true};
    plan.cell = 1.0;
    const RunSummary summary = run(simulation, plan, observers, Interrupt(), progress);
    CHECK(summary.reason == "rest");
    CHECK(summary.last.time > 6.0);
    CHECK(summary.last.time < 300.0);
    CHECK(entry(simulation.extras(), 0).entered == 6.0);
    CHECK(std::abs(budget(summary.first, summary.last).mass_error) < 1e-13);
}

TEST_CASE("Late releases go along where the terrain grows, and next to barriers", "[late][terrain]") {
    Scene scene = growing_slope(NodeBox{180, 20, 200, 160});
    const auto heap = [](double x, double y) { return std::hypot(x - 1240, y - 400) < 40 ? 2.0 : 0.0; };
    fill(scene, heap);
    delay(scene, "early", 3.0, heap), delay(scene, "late", 16.0, heap), delay(scene, "hit", {}, heap);
    GrowingParticles part(scene);
    CHECK(grows_before_all_is_in(part, 18.0));
    const Extras extras = part.extras();
    CHECK(entry(extras, 0).entered == 3.0);
    CHECK(entry(extras, 1).entered == 16.0);
    CHECK(entry(extras, 2).entered == 0.0);

    Scene walled = chain();
    Barrier wall;
    wall.name = "wall";
    wall.line = {{100, 10}, {100, 35}};
    wall.height = 2.0;
    walled.barriers = {wall};
    WalledParticles run(walled);
    run_to(run, 9.0);
    CHECK(run.extras().late[0].entered.has_value());
    CHECK(run.loads()->barriers[0].run_up > 0.0);
}

TEST_CASE("An inflow's budget is not that of a late release", "[late][inflow]") {
    Scene scene = chain();
    Inflow inflow;
    inflow.name = "flood", inflow.line = {{20, 14}, {20, 30}}, inflow.to_right = true, inflow.spacing = 0.5;
    inflow.time = {0.5, 2.0, 5.0}, inflow.discharge = {0.0, 20.0, 0.0}, inflow.speed = {4.0, 4.0, 4.0};
    scene.inflows = {inflow};
    DepthAveraged run(scene);
    run_to(run, 6.0);
    const Extras extras = run.extras();
    REQUIRE(entry(extras, 0).entered.has_value());
    CHECK(extras.inflow->expected == Approx(45.0).epsilon(1e-14));
    CHECK(extras.inflow->volume == Approx(45.0).epsilon(1e-12));  // a difference of sums a few times larger
}
