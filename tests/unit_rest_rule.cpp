// When a run is at rest, on a flow whose every number is given; and on a synthetic track, what running on would change.
#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "fake_simulation.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"
#include "run_on.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kStep = 0.25, kCell = 5.0;

/// Moves as the test says.
class Scripted final : public FakeSimulation {
public:
    std::function<double(double)> mean = [](double) { return 0.0; }, fastest = [](double) { return 1.0; };
    std::function<double(double, double)> share = [](double, double) { return 0.0; };  ///< of time, speed
    std::function<Index(double)> fronts = [](double) { return Index{0}; };
    bool ready = true, water = false;
    mutable int looks = 0;

    void advance(double until) override {
        now_.time = std::min(until, now_.time + kStep), ++now_.step;
        now_.max_depth = 60.0;
        now_.mean_speed = mean(now_.time), now_.max_speed = now_.max_speed_on_map = fastest(now_.time);
    }
    const Status& status() const override { return now_; }
    Frame frame() override {
        Frame frame = FakeSimulation::frame();
        frame.status = now_;
        return frame;
    }
    Status frame_status() override { return now_; }
    void begin_with(double speed) { now_.max_speed = now_.max_speed_on_map = speed; }
    bool may_rest() const override { return ready; }
    Extras extras() const override {
        Extras extras;
        if (water) extras.water.emplace();
        return extras;
    }
    MovingMass motion(const MotionQuery& query) const override {
        ++looks;
        return {1.0, share(now_.time, query.faster_than), now_.max_speed, fronts(query.since)};
    }

private:
    Status now_ = [] {
        Status start;
        start.particles = 1, start.mass = start.max_speed = start.max_speed_on_map = 1.0;
        return start;
    }();
};

/// The flow of 20 m/s ends at 40 s.
Scripted stops_at_40() {
    Scripted flow;
    flow.mean = [](double t) { return t < 40.0 ? 20.0 : 0.1; };
    return flow;
}

/// When the rule sees rest; 0: not until 400 s.
double rest_of(Scripted& flow) {
    RestRule rule(kCell, 0.05);
    while (flow.status().time < 400.0) {
        flow.advance(400.0);
        rule.note(flow);
        if (rule.at_rest()) return flow.status().time;
    }
    return 0.0;
}

/// A twentieth of the time when it is seen; before and after that a step and the distance of looks, half a hundredth.
constexpr double earliest_after(double time) { return time / 0.95 / 1.005 - kStep; }
constexpr double latest_after(double time) { return time / 0.95 * 1.005 * 1.005 + 2 * kStep; }

}  // namespace

TEST_CASE("Rest is seen a twentieth of the time after it came", "[rest]") {
    Scripted flow = stops_at_40();
    const double seen = rest_of(flow);
    CHECK(seen >= earliest_after(40.0));
    CHECK(seen <= latest_after(40.0));
    CHECK(flow.looks <= 15);  // only while the mean speed is low
}

TEST_CASE("Nothing rests while more than a hundredth of the mass would go a cell in as much time again", "[rest]") {
    for (const double share : {0.009, 0.011}) {
        Scripted flow = stops_at_40();
        flow.share = [&](double t, double speed) {
            CHECK(speed == Approx(2.0 * kCell / t));  // what is braked evenly goes half of v t
            return t < 100.0 ? share : 0.0;
        };
        const double seen = rest_of(flow);
        if (share < 0.01)
            CHECK(seen <= latest_after(40.0));
        else
            CHECK((seen >= earliest_after(100.0) && seen <= latest_after(100.0)));
    }
}

TEST_CASE("Nothing rests while a front runs on, however little of the mass it is", "[rest]") {
    Scripted flow = stops_at_40();
    flow.fronts = [](double since) { return since < 60.0 ? Index{1} : Index{0}; };  // the last node was reached at 60 s
    const double seen = rest_of(flow);
    CHECK(seen >= earliest_after(60.0 / 0.95));
    CHECK(seen <= latest_after(60.0 / 0.95));
}

TEST_CASE("A flow that friction holds for a moment, or that has hardly begun, is not at rest", "[rest]") {
    Scripted held = stops_at_40();
    held.mean = [](double t) { return t < 40.0 || (t > 41.0 && t < 80.0) ? 20.0 : 0.1; };
    CHECK(rest_of(held) >= earliest_after(80.0));
    Scripted creeps;
    creeps.mean = [](double t) { return 1e-6 * t; };
    CHECK(rest_of(creeps) == 0.0);
    Scripted waits = stops_at_40();
    waits.ready = false;
    CHECK(rest_of(waits) == 0.0);
}

TEST_CASE("Where nothing at all moves it is at rest at once", "[rest]") {
    Scripted flow = stops_at_40();
    flow.fastest = [](double t) { return t < 40.0 ? 1.0 : 0.0; };
    CHECK(rest_of(flow) == 40.0);
}

TEST_CASE("A lake that moves by round-off alone is at rest; material that creeps as slowly is not", "[rest][water]") {
    // A lake of 60 m on cells of 1 m had 2e-14 m/s. The energy of a fall through the round-off of 60 m gives 5e-7 m/s.
    for (const double speed : {2e-14, 4e-7, 6e-7}) {
        CAPTURE(speed);
        Scripted lake;
        lake.begin_with(speed);
        lake.mean = lake.fastest = [&](double) { return speed; };
        lake.share = [&](double, double faster_than) { return speed > faster_than ? 1.0 : 0.0; };
        const auto run_of = [&](Scripted flow, bool stop) {
            Observers none;
            std::ostringstream stream;
            Progress progress(stream, Progress::Style::silent, 1.0);
            return run(flow, {1.0, 1.0, stop, false, kCell, 0.05}, none, Interrupt(), progress);
        };
        CHECK(run_of(lake, true).reason == "end");
        CHECK(run_of(lake, false).still_moves());
        lake.water = true;
        const bool rests = speed < 5e-7;
        CHECK(run_of(lake, true).reason == (rests ? "rest" : "end"));
        CHECK(run_of(lake, false).still_moves() == !rests);
        CHECK((run_of(lake, false).motion.fastest == 0.0) == rests);
    }
}

TEST_CASE("A rule that is taken up again sees rest at the same step", "[rest][resume]") {
    Scripted flow = stops_at_40();
    const double seen = rest_of(flow);
    Scripted again = stops_at_40();
    RestRule before(kCell, 0.05);
    while (again.status().time < 41.0) again.advance(400.0), before.note(again);
    MemoryArchive archive;
    before.serialize(archive);
    RestRule after(kCell, 0.05);
    after.serialize(archive.rewind());
    while (!after.at_rest() && again.status().time < 400.0) again.advance(400.0), after.note(again);
    CHECK(again.status().time == seen);
}

TEST_CASE("A run ends when rest comes, whatever the time between its frames", "[rest]") {
    for (const double every : {1.0, 7.0, 200.0}) {
        Scripted flow = stops_at_40();
        Observers none;
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, 1.0);
        const RunSummary summary = run(flow, {200.0, every, true, false, kCell, 0.05}, none, Interrupt(), progress);
        CAPTURE(every);
        CHECK(summary.reason == "rest");
        CHECK(summary.last.time >= earliest_after(40.0));
        CHECK(summary.last.time <= latest_after(40.0));
        CHECK(summary.motion.fastest == 1.0);
        CHECK(summary.slow == Approx(2.0 * kCell / summary.last.time));
    }
}

TEST_CASE("A run that is cut short at once still moves, though nothing went two cells in that time", "[rest]") {
    Scripted flow;
    flow.mean = flow.fastest = [](double) { return 5.0; };
    flow.share = [](double, double speed) { return speed < 5.0 ? 1.0 : 0.0; };
    Observers none;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, 1.0);
    const RunSummary summary = run(flow, {1.0, 1.0, false, false, kCell, 0.05}, none, Interrupt(), progress);
    CHECK(summary.reason == "end");
    CHECK(summary.slow == Approx(0.05 * 5.0));  // of the largest speed; two cells in 1 s are 10 m/s
    CHECK(summary.still_moves());
}

// An avalanche down a parabola with a rough bed, out of a wide slab: its tail comes to rest long after its front.
TEST_CASE("Running on after rest leaves the deposit and its toe where they are", "[rest]") {
    Scene scene = scene_on(121, 41, 10.0, [](double x, double y) {
        const double rest = std::max(0.0, 900.0 - x);
        return 0.38e-3 * rest * rest + 0.3 * std::sin(0.13 * x) * std::sin(0.17 * y);
    });
    scene.bed_law = bed::Voellmy{0.25, 1500.0};
    fill(scene, [](double x, double y) { return x > 40 && x < 160 && y > 140 && y < 260 ? 2.0 : 0.0; });
    const RunOn on = run_on(scene, 1000.0);
    CAPTURE(on.rested, on.known);
    REQUIRE(on.rested > 0.0);
    CHECK(on.known > 0.9);   // what was split or merged is a small part
    CHECK(on.moved < 0.01);  // of the volume by a cell or more
    CHECK(on.toe < 1.5);     // a node and its neighbours, the diagonal ones too: less than a cell beyond the rim
}
