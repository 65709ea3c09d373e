// Material that comes in through lines: volume, momentum, the same bits whatever the steps, threads and resumes.
#include <omp.h>

#include <sstream>

#include "analytic_scene.h"
#include "base/compensated_sum.h"
#include "catch.h"
#include "coupling/growing_particles.h"
#include "coupling/walled_particles.h"
#include "growing_slope.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"
#include "same_run.h"
#include "threads_of_test.h"

using namespace frana;
using namespace frana::test;

namespace {

Inflow flood() {
    Inflow inflow;
    inflow.name = "flood";
    inflow.line = {{12, 14}, {20, 22}, {20, 30}};
    inflow.spacing = 0.5;
    inflow.time = {0.5, 2.0, 3.0, 6.0}, inflow.discharge = {0.0, 60.0, 25.0, 0.0}, inflow.speed = {1.0, 6.0, 4.0, 2.0};
    return inflow;
}
constexpr double kFlood = 45.0 + 42.5 + 37.5;  // [m3]

/// A flood onto a slope where nothing is, or where a slab slides already.
Scene slope(bool slab) {
    Scene scene =
        scene_on(90, 45, 1.0, [](double x, double y) { return 40.0 - 0.3 * x + 0.004 * (y - 22) * (y - 22); });
    scene.bed_law = bed::Voellmy{0.1, 300.0};
    scene.inflows = {flood()};
    if (slab) fill(scene, [](double x, double y) { return std::hypot(x - 35, y - 22) < 8 ? 1.0 : 0.0; });
    return scene;
}

std::vector<double> values_of(const Frame& frame, const char* field) {
    const Field& found = *frame.node(field);
    return {found.data, found.data + found.count * found.components};
}

double residual(const Status& first, const Status& now) {
    const Budget b = budget(first, now);
    return std::hypot(b.momentum_residual[0], b.momentum_residual[1]);
}

}  // namespace

TEST_CASE("The volume of an inflow is its table's at each step, up to one row, and in full at last", "[inflow]") {
    for (const bool slab : {false, true}) {
        const Scene scene = slope(slab);
        DepthAveraged run(scene);
        const Status first = run.status();
        const std::vector<InflowRow> rows = rows_of(scene.inflows[0]);
        CHECK(run.more_comes());
        CHECK_FALSE(run.may_rest());
        double row = 0.0;
        constexpr double kMost = 60.0;  // discharge [m3/s]; rows wait for three ordinary steps at most
        for (const InflowRow& one : rows) row = std::max(row, one.volume);
        while (run.status().time < 6.5) {
            run.advance(6.5);
            const Status& now = run.status();
            CHECK(std::abs(budget(first, now).mass_error) < 1e-13);
            const InflowBudget budget = run.extras().inflow.value();
            CHECK(budget.volume == Approx(budget.expected).epsilon(1e-13));
            double by_now = 0.0;  // of the table
            for (std::size_t n = 0; n + 1 < 4; ++n) {
                const auto& of = scene.inflows[0];
                const double s = std::clamp(now.time, of.time[n], of.time[n + 1]) - of.time[n];
                const double dq = (of.discharge[n + 1] - of.discharge[n]) / (of.time[n + 1] - of.time[n]);
                by_now += s * (of.discharge[n] + 0.5 * dq * s);
            }
            CHECK(budget.volume <= by_now + 1e-9);
            const double wait = 3.0 * std::max(now.dt, 0.5 * 1.0 / 6.0);  // half a cell at the inflow's speed
            CHECK(budget.volume > by_now - row - kMost * wait);
        }
        CHECK_FALSE(run.more_comes());
        CHECK(run.status().mass_in / scene.density == Approx(kFlood).epsilon(1e-14));
    }
}

TEST_CASE("A closed basin fills with the volume of its tables, up to one level", "[inflow]") {
    // A bowl between walls. The table has gaps, kinks and a discharge of its own at the end.
    const auto bowl = [](double x, double y) { return 0.004 * ((x - 11) * (x - 11) + 1.3 * (y - 9) * (y - 9)); };
    Scene scene = scene_on(25, 21, 1.0, bowl);
    scene.sides = Sides::wall;
    scene.bed_law = bed::Bingham{100.0, 0.0};
    Inflow inflow;
    inflow.name = "filling", inflow.line = {{6, 5}, {6, 15}}, inflow.spacing = 0.5, inflow.to_right = true;
    inflow.time = {0.0, 2.8, 12.4, 12.8, 32.0, 44.0}, inflow.discharge = {3.0, 20.0, 20.0, 0.0, 0.0, 31.0};
    inflow.speed = {1.0, 2.0, 2.0, 1.0, 1.0, 2.5};
    scene.inflows = {inflow};
    DepthAveraged run(scene);
    const auto volume_by = [&](double t) {
        CompensatedSum sum;
        for (std::size_t n = 0; n + 1 < inflow.time.size(); ++n) {
            const double s = std::clamp(t, inflow.time[n], inflow.time[n + 1]) - inflow.time[n];
            const double dq = (inflow.discharge[n + 1] - inflow.discharge[n]) / (inflow.time[n + 1] - inflow.time[n]);
            sum.add(s * (inflow.discharge[n] + 0.5 * dq * s));
        }
        return sum.value();
    };
    double row = 0.0;
    for (const InflowRow& one : rows_of(inflow)) row = std::max(row, one.volume);
    for (double t = 0.5; t <= 46.0; t += 0.5) {
        run_to(run, t);
        const Status& now = run.status();
        const InflowBudget in = run.extras().inflow.value();
        INFO("t = " << t);
        CHECK(now.mass_left == 0.0);
        CHECK(std::abs(now.mass - now.mass_in) <= 1e-13 * now.mass);
        CHECK(in.volume == Approx(in.expected).epsilon(1e-13));
        const double wait = 3.0 * std::max(now.dt, 0.5);  // rows come in every third ordinary step
        CHECK(in.volume <= volume_by(t) * (1.0 + 1e-14));
        CHECK(in.volume > volume_by(t) - row - (volume_by(t) - volume_by(t - wait)));
    }
    const double given = volume_by(44.0);
    CHECK(std::abs(run.status().mass_in / scene.density - given) <= 1e-15 * given);
    run_to(run, 400.0);
    // The level of a bed as nodes have it, averaged over their shape, which holds that volume.
    const Flow& flow = run.flow();
    const auto volume_up_to = [&](double level) {
        double sum = 0.0;
        for (Index j = 0; j < flow.grid.ny(); ++j)
            for (Index i = 0; i < flow.grid.nx(); ++i)
                sum += flow.share(i, j) * flow.area * std::max(0.0, level - flow.bed.z[flow.grid.at(i, j)]);
        return sum;
    };
    double low = 0.0, high = 10.0;
    for (int n = 0; n < 60; ++n) (volume_up_to(0.5 * (low + high)) < given ? low : high) = 0.5 * (low + high);
    // Waves of two cells are filtered out of the surface before it drives anything, so they stay: of points that stand
    // irregularly, some percent of the depth. What is left when they are filtered out is level.
    const auto surface = [&](Index i, Index j) {
        const Index k = flow.grid.at(i, j);
        return flow.bed.z[k] + flow.nodes.depth[k];
    };
    double most = 0.0, filtered = 0.0, volume = 0.0;
    for (Index j = 0; j < flow.grid.ny(); ++j)
        for (Index i = 0; i < flow.grid.nx(); ++i) {
            REQUIRE(flow.is_in_reach(i, j));
            volume += flow.share(i, j) * flow.area * flow.nodes.depth[flow.grid.at(i, j)];
            most = std::max(most, std::abs(surface(i, j) - low));
            if (i < 1 || j < 1 || i + 1 >= flow.grid.nx() || j + 1 >= flow.grid.ny()) continue;
            double sum = 0.0;
            for (Index b = -1; b <= 1; ++b)
                for (Index a = -1; a <= 1; ++a)
                    sum += double((2 - std::abs(a)) * (2 - std::abs(b))) * surface(i + a, j + b) / 16;
            filtered = std::max(filtered, std::abs(sum - low));
        }
    INFO("level " << low << " m, off by " << most << " m, filtered " << filtered << " m, speed "
                  << run.status().max_speed_on_map << " m/s");
    CHECK(volume == Approx(given).epsilon(1e-13));
    CHECK(low > 1.15);  // above the bed of the corners
    CHECK(most < 0.05);
    CHECK(filtered < 1e-3);
}

TEST_CASE("A jet brings the momentum of its discharge and speed", "[inflow]") {
    Scene scene = scene_on(
        140, 160, 1.0, [](double, double) { return 3.0; }, -40.0, -80.0);  // nothing comes to its edge
    scene.inflows = {flood()};
    double east = 0.0, north = 0.0;  // density times the integral of discharge, speed and direction
    for (const InflowRow& row : rows_of(scene.inflows[0])) {
        const double along = scene.density * row.volume * row.speed, first = std::hypot(8.0, 8.0), all = first + 8.0;
        east += along * (first / all / std::sqrt(2.0) + 8.0 / all), north -= along * first / all / std::sqrt(2.0);
    }
    SECTION("without weight nothing changes it") {
        scene.gravity = 1e-14;  // 1e-9 would push by 1e-9 of the momentum
        scene.scheme.viscosity_linear = scene.scheme.viscosity_quadratic =
            0.0;  // it pushes too, where rows of the bend meet
        DepthAveraged run(scene);
        run_to(run, 6.5);
        const Status now = run.frame().status;
        CHECK(now.momentum[0] == Approx(east).epsilon(1e-12));
        CHECK(now.momentum[1] == Approx(north).epsilon(1e-12));
        REQUIRE(now.mass_left == 0.0);
    }
    SECTION("with weight the balance closes") {
        DepthAveraged run(scene);
        const Status first = run.status();
        run_to(run, 6.5);
        REQUIRE(run.status().mass_left == 0.0);
        CHECK(residual(first, run.status()) < 1e-12 * std::hypot(east, north));
        CHECK(run.status().momentum_left[0] == Approx(-east).epsilon(1e-12));
        CHECK(run.status().momentum_left[1] == Approx(-north).epsilon(1e-12));
    }
}

TEST_CASE("Rows do not hang on the steps", "[inflow]") {
    Scene scene = slope(true);
    const auto volumes = [&](double cfl) {
        scene.scheme.cfl = cfl;
        Feed feed(scene.inflows);
        std::vector<double> all;
        for (double t = 0.0; t < 6.0 + cfl; t += 0.3 * cfl) {
            const Seeds& seeds = feed.take(t).seeds;
            all.insert(all.end(), seeds.volume.begin(), seeds.volume.end());
        }
        DepthAveraged run(scene);
        run_to(run, 6.5);
        CHECK(run.status().mass_in / scene.density == Approx(kFlood).epsilon(1e-14));
        return all;
    };
    const std::vector<double> whole = volumes(0.5), half = volumes(0.25);
    CHECK(whole.size() > 500);
    CHECK(whole == half);
}

TEST_CASE("What will come in is known before, with the time that it will be there", "[inflow]") {
    const std::vector<Inflow> inflows{flood()};
    const double end = GENERATE(0.2, 4.0, 9.0);
    const Feed::Outlook outlook = Feed(inflows).outlook(end);
    Feed feed(inflows);
    double particles = 0.0, seconds = 0.0, speed = 0.0;
    for (double next = feed.next(); next <= end; next = feed.next()) {
        const Seeds& seeds = feed.take(next).seeds;
        particles += static_cast<double>(seeds.count());
        seconds += static_cast<double>(seeds.count()) * (end - next);
        for (std::size_t n = 0; n < seeds.vx.size(); ++n) speed = std::max(speed, std::hypot(seeds.vx[n], seeds.vy[n]));
    }
    CHECK(outlook.particles == particles);
    CHECK((particles > 0.0) == (end > 0.5));                            // the table begins
    CHECK(outlook.particle_seconds == Approx(seconds).epsilon(1e-12));  // sums in another order
    CHECK(outlook.speed == Approx(speed).epsilon(1e-12));
}

TEST_CASE("An inflow goes on in the middle of its table with the same bits, on any number of threads",
          "[inflow][resume]") {
    const Threads restored;
    for (const bool slab : {false, true}) {
        const Scene scene = slope(slab);
        omp_set_num_threads(1);
        DepthAveraged straight(scene);
        std::vector<MemoryArchive> kept;
        while (straight.status().time < 7.0) {
            if (straight.status().step % 9 == 0) straight.serialize(kept.emplace_back());
            straight.advance(7.0);
        }
        REQUIRE(kept.size() > 4);
        const auto expected = state_bits(straight);
        for (std::size_t n = 0; n < kept.size(); ++n) {
            omp_set_num_threads(n % 2 == 0 ? 4 : 2);
            DepthAveraged resumed(scene, Start::resumed);
            resumed.serialize(kept[n].rewind());
            INFO("kept at " << resumed.status().time << " s");
            run_to(resumed, 7.0);
            CHECK((state_bits(resumed) == expected));
        }
    }
}

TEST_CASE("Whether material sleeps changes no bit of an inflow next to it", "[inflow]") {
    Scene scene = slope(false);
    fill(scene, [](double x, double y) { return x > 60 && x < 80 && y > 10 && y < 30 ? 0.5 : 0.0; });
    scene.bed_law = bed::Voellmy{0.4, 300.0};  // the slab stays
    scene.inflows[0].time = {3.0, 5.0, 8.0, 20.0}, scene.inflows[0].discharge = {0.0, 90.0, 60.0, 0.0};
    scene.inflows[0].speed = {2.0, 9.0, 9.0, 3.0};
    DepthAveraged sleeper(scene);
    scene.scheme.sleep = false;
    DepthAveraged awake(scene);
    bool slept = false;
    for (const double t : {2.5, 6.0, 10.0, 32.0}) {
        run_to(sleeper, t), run_to(awake, t);
        slept = slept || some_asleep(sleeper.flow());
        CHECK(sleeper.flow().particles.x == awake.flow().particles.x);
        CHECK(sleeper.status().kinetic == awake.status().kinetic);
    }
    CHECK(slept);
}

TEST_CASE("A run waits for what is still to come in", "[inflow]") {
    Scene scene = scene_on(60, 45, 1.0, [](double x, double) { return 40.0 - 0.1 * x; });
    scene.bed_law = bed::Coulomb{0.6};
    Inflow inflow = flood();
    inflow.time = {2.0, 3.0, 20.0, 21.0}, inflow.discharge = {10.0, 0.0, 0.0, 10.0},
    inflow.speed = {2.0, 2.0, 2.0, 2.0};
    scene.inflows = {inflow};
    DepthAveraged simulation(scene);
    Observers observers;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    RunPlan plan{200.0, 1.0, true};
    plan.cell = 1.0;
    const RunSummary summary = run(simulation, plan, observers, Interrupt(), progress);
    CHECK(summary.reason == "rest");
    CHECK(summary.last.time > 21.0);
    CHECK(summary.last.time < 200.0);
    CHECK(summary.first.mass == 0.0);
    CHECK(summary.last.mass / scene.density == Approx(10.0).epsilon(1e-13));
    CHECK(std::abs(budget(summary.first, summary.last).mass_error) < 1e-13);
}

TEST_CASE("What a row passes on its way from the line counts", "[inflow][sections]") {
    Scene scene = slope(false);
    const Polyline line = scene.inflows[0].line;  // a tenth of a cell down of it
    scene.sections = {{"mouth", {{11.9, 13.8}, {20.1, 21.9}, {20.1, 30.2}}, true}};
    DepthAveraged run(scene);
    run_to(run, 6.5);
    // What spreads upstream of the line and stays there has not passed.
    double behind = 0.0;
    const Particles& c = run.flow().particles;
    for (Index p = 0; p < c.count(); ++p)
        if (c.y[p] > 13.0 && c.x[p] < (c.y[p] < 21.9 ? 11.9 + (c.y[p] - 13.8) * 8.2 / 8.1 : 20.1)) behind += c.mass[p];
    CHECK(run.passed()[0] == Approx(kFlood - behind / scene.density).epsilon(1e-9));
}

TEST_CASE("An inflow goes on where the terrain grows in the middle of its table, with sections", "[inflow][terrain]") {
    Scene scene = growing_slope(NodeBox{240, 40, 120, 120});
    Inflow inflow = flood();
    inflow.line = {{1240, 390}, {1240, 420}}, inflow.to_right = false, inflow.spacing = 2.0;
    inflow.time = {0.0, 60.0}, inflow.discharge = {120.0, 0.0}, inflow.speed = {10.0, 5.0};
    scene.inflows = {inflow};
    scene.sections = {{"below", {{1200, 100}, {1200, 700}}, false}};
    GrowingParticles part(scene);
    const Status first = part.status();
    bool grew_meanwhile = false;
    while (part.status().time < 62.0) {
        const Index before = part.held().i0;
        part.advance(62.0);
        grew_meanwhile =
            grew_meanwhile || (part.held().i0 < before && part.more_comes() && part.status().mass_in > 0.0);
        CHECK(std::abs(budget(first, part.status()).mass_error) < 1e-13);
    }
    CHECK(grew_meanwhile);
    CHECK(part.extras().inflow->volume == Approx(3600.0).epsilon(1e-13));
    const Frame frame = part.frame();
    const Field &position = *frame.particle("position"), &volume = *frame.particle("volume");
    double below = 0.0;
    for (Index p = 0; p < volume.count; ++p)
        if (position.data[3 * p] < 1200.0) below += volume.data[p];
    CHECK(below > 3000.0);
    CHECK(part.passed()[0] == Approx(below).epsilon(1e-12));
}

TEST_CASE("What holds an inflow up behind its line is no flow to peaks", "[inflow]") {
    DepthAveraged run(slope(false));
    while (run.status().time < 2.5) run.advance(2.5);
    const Frame frame = run.frame();
    const auto at = [&](const char* field, Index i, Index j) {
        const auto found =
            std::find_if(frame.nodes.begin(), frame.nodes.end(), [&](const Field& f) { return f.name == field; });
        return found->data[j * 90 + i];
    };
    // The line lies at x = 20, and the flow goes to larger x.
    REQUIRE(run.flow().nodes.depth[run.flow().grid.at(18, 26)] > 0.1);
    for (const Index behind : {16, 17, 18}) {
        CHECK(at("depth", behind, 26) == 0.0);
        CHECK(at("surface", behind, 26) == at("elevation", behind, 26));
        CHECK(at("peak_depth", behind, 26) == 0.0);
        CHECK(at("peak_speed", behind, 26) == 0.0);
    }
    CHECK(at("peak_depth", 22, 26) > 0.1);
    CHECK(at("peak_speed", 22, 26) > 1.0);
}

TEST_CASE("Frames show the depth of what has come in, and none of what holds it up", "[inflow][resume]") {
    const bool walled = GENERATE(false, true), slab = GENERATE(false, true);
    CAPTURE(walled, slab);
    Scene scene = slope(slab);
    if (walled) {  // the line goes from wall to wall
        scene.sides = Sides::wall;
        scene.inflows[0].line = {{20, 0}, {20, 44}};
    }
    DepthAveraged run(scene);
    bool held_up = false;
    while (run.status().time < 4.0) {
        const double before = run.status().time;
        run.advance(4.0);
        if (std::floor(5.0 * run.status().time) == std::floor(5.0 * before)) continue;
        const Frame frame = run.frame();
        const std::vector<double> depth = values_of(frame, "depth"), peak = values_of(frame, "peak_depth"),
                                  speed = values_of(frame, "speed"), arrival = values_of(frame, "arrival_time"),
                                  surface = values_of(frame, "surface"), bed = values_of(frame, "elevation");
        double mass = 0.0, area = 0.0, deepest = 0.0, all = 0.0;
        for (Index j = 0; j < 45; ++j)
            for (Index i = 0; i < 90; ++i) {
                const auto n = static_cast<std::size_t>(j * 90 + i);
                const double share = run.flow().share(i, j);
                mass += scene.density * share * depth[n];
                all += scene.density * share * run.flow().nodes.depth[run.flow().grid.at(i, j)];
                if (depth[n] > scene.output.footprint_depth) area += share;
                deepest = std::max(deepest, depth[n]);
                CHECK(depth[n] <= peak[n]);
                CHECK(surface[n] == bed[n] + depth[n]);
                if (depth[n] > scene.output.footprint_depth) CHECK(arrival[n] >= 0.0);
                if (depth[n] == 0.0) CHECK(speed[n] == 0.0);
            }
        CHECK(mass == Approx(frame.status.mass).epsilon(1e-12));
        CHECK(frame.status.covered_area == Approx(area).epsilon(1e-12));
        CHECK(frame.status.max_depth == deepest);
        held_up = held_up || all > 1.05 * frame.status.mass;
        MemoryArchive kept;
        run.serialize(kept);
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(kept.rewind());
        CHECK(values_of(resumed.frame(), "depth") == depth);
    }
    CHECK(held_up);
}

TEST_CASE("The energy of an inflow from wall to wall has none of what holds it up", "[inflow]") {
    Scene scene = slope(false);
    scene.sides = Sides::wall;
    scene.inflows[0].line = {{20, 0}, {20, 44}};
    DepthAveraged run(scene);
    run_to(run, 2.5);
    const Frame frame = run.frame();
    const std::vector<double> depth = values_of(frame, "depth"), bed = values_of(frame, "elevation");
    double potential = 0.0;
    for (Index j = 0; j < 45; ++j)
        for (Index i = 0; i < 90; ++i) {
            const auto n = static_cast<std::size_t>(j * 90 + i);
            potential += run.flow().share(i, j) * scene.density * scene.gravity * depth[n] * (bed[n] + 0.5 * depth[n]);
        }
    CHECK(frame.status.potential == Approx(potential).epsilon(1e-12));
}

TEST_CASE("An inflow next to a barrier", "[inflow]") {
    Scene scene = slope(false);
    Barrier wall;
    wall.name = "wall";
    wall.line = {{50, 10}, {50, 35}};
    wall.height = 2.0;
    scene.barriers = {wall};
    WalledParticles run(scene);
    CHECK_FALSE(run.may_rest());
    run_to(run, 9.0);
    CHECK(run.may_rest());
    CHECK(run.extras().inflow->volume == Approx(kFlood).epsilon(1e-13));
    CHECK(run.loads()->barriers[0].run_up > 0.0);
}
