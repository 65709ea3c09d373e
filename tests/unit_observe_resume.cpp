// The time loop with a keeper of states: runs that are stopped and taken up again show what one run would.
#include <optional>
#include <sstream>

#include "catch.h"
#include "fake_simulation.h"
#include "fresh_folder.h"
#include "observe/history.h"
#include "observe/insitu.h"
#include "observe/insitu_tables.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"

using namespace frana;
using Catch::Contains;

namespace {

/// Keeps every state that the loop offers, and gives one back.
class MemoryKeeper final : public StateKeeper {
public:
    explicit MemoryKeeper(bool always = true) : always_(always) {}
    bool due() const override { return always_; }
    void save(double time, const State& state) override {
        times.push_back(time);
        state(states.emplace_back());
    }
    bool load(const State& state) override {
        if (from) state(from->rewind());
        return from.has_value();
    }
    std::vector<MemoryArchive> states;
    std::vector<double> times;
    std::optional<MemoryArchive> from;

private:
    bool always_;
};

/// What a run in a folder leaves: history.csv of every step, and a table of looks at odd times.
struct Run {
    RunSummary summary;
    std::string history, looks;
    InsituTally tally{"most", "reduce", 0, 0, ""};
};

Run run_in(const FreshFolder& folder, const RunPlan& plan, MemoryKeeper& keeper, const FakeScript& script = {},
           const Interrupt& interrupt = Interrupt()) {
    Run result;
    FakeSimulation simulation(script);
    Observers observers;
    observers.push_back(std::make_unique<History>(folder.path(), History::Lines::per_step));
    observers.push_back(std::make_unique<InsituObserver>(
        InsituTimes{0.17, {}}, make_reduction(folder.path() / "most.csv", {"depth"}, 0.1), result.tally));
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, FakeSimulation::density);
    result.summary = run(simulation, plan, observers, interrupt, progress, &keeper);
    result.history = text_of(folder.path() / "history.csv");
    result.looks = text_of(folder.path() / "most.csv");
    return result;
}

void check_same(const Run& found, const Run& expected) {
    CHECK(found.history == expected.history);
    CHECK(found.looks == expected.looks);
    CHECK(found.tally.made == expected.tally.made);
    const RunSummary &a = found.summary, &b = expected.summary;
    CHECK(a.reason == b.reason);
    CHECK(a.steps == b.steps);
    CHECK(a.frames == b.frames);
    CHECK(a.particle_steps == b.particle_steps);
    CHECK(a.first.mass == b.first.mass);
    CHECK(a.last.time == b.last.time);
    CHECK(a.last.mass == b.last.mass);
    CHECK(a.extremes.max_speed == b.extremes.max_speed);
    CHECK(a.extremes.max_speed_time == b.extremes.max_speed_time);
    CHECK(a.extremes.max_front == b.extremes.max_front);
    CHECK(a.extremes.max_covered_area == b.extremes.max_covered_area);
}

}  // namespace

TEST_CASE("a run that goes on from any of its states leaves what the whole run leaves", "[resume]") {
    const RunPlan plan{1.05, 0.25, false};
    const FreshFolder folder;
    MemoryKeeper keeper;
    const Run whole = run_in(folder, plan, keeper);
    REQUIRE(keeper.states.size() > 30);  // one a step and one at the end
    CHECK(keeper.times.front() == 0.0);
    CHECK(keeper.times.back() == 1.05);
    for (const MemoryArchive& state : keeper.states) {
        MemoryKeeper later(false);
        later.from = state;
        const Run resumed = run_in(folder, plan, later);  // its tables are ahead of the state: they are cut back
        check_same(resumed, whole);
        CHECK(resumed.summary.started == whole.summary.started);
        CHECK(resumed.summary.wall_seconds > 0.0);
        CHECK(later.states.size() == 1);  // the last one
    }
}

TEST_CASE("a resumed run has the farthest front so far", "[resume]") {
    const RunPlan plan{1.05, 0.25, false};
    const FreshFolder whole_folder, folder;
    FakeScript script;
    script.front_turns = 0.25;
    MemoryKeeper unused, keeper(false), later(false);
    const Run whole = run_in(whole_folder, plan, unused, script);
    CHECK(whole.summary.extremes.max_front == Approx(7.0 + FakeSimulation::u * 0.25));
    run_in(folder, {0.5, 0.25, false, true}, keeper, script);
    later.from = keeper.states.back();
    check_same(run_in(folder, plan, later, script), whole);
}

TEST_CASE("an interrupted run saves its state before its last frame, and goes on without that frame", "[resume]") {
    const RunPlan plan{1.05, 0.25, false};
    const FreshFolder whole_folder, folder;
    MemoryKeeper unused, keeper(false), later(false);
    const Run whole = run_in(whole_folder, plan, unused);
    Interrupt interrupt;
    FakeScript script;
    script.on_step = [&](Index step) {
        if (step == 11) interrupt.request();
    };
    const Run stopped = run_in(folder, plan, keeper, script, interrupt);
    CHECK(stopped.summary.reason == "interrupted");
    REQUIRE(keeper.states.size() == 1);
    CHECK(stopped.looks != whole.looks);  // a look at its end
    later.from = keeper.states.front();
    check_same(run_in(folder, plan, later), whole);
}

TEST_CASE("an interrupt is heard between outputs that one step passes, and the resumed run shows the others",
          "[resume]") {
    const RunPlan plan{1.05, 0.01, false};
    const FreshFolder whole_folder, folder;
    MemoryKeeper unused, keeper(false), later(false);
    FakeScript script;
    script.dt = 0.3, script.tells_step = true;
    const Run whole = run_in(whole_folder, plan, unused, script);
    CHECK(whole.summary.frames == 106);
    CHECK(whole.summary.steps == 4);
    Interrupt interrupt;
    Index calls = 0;
    FakeScript interrupted = script;
    interrupted.on_step = [&](Index) {
        if (++calls == 40) interrupt.request();  // 29 outputs, a step, and within the next
    };
    const Run stopped = run_in(folder, plan, keeper, interrupted, interrupt);
    CHECK(stopped.summary.reason == "interrupted");
    CHECK(calls == 40);
    CHECK(stopped.summary.last.time < 0.45);
    REQUIRE(keeper.states.size() == 1);
    later.from = keeper.states.front();
    check_same(run_in(folder, plan, later, script), whole);
}

TEST_CASE("a run that was cut short goes on as if it had not been", "[resume]") {
    const double end = GENERATE(0.5, 0.6, 0.25 * 3, 0.1, 1.0499999999);
    CAPTURE(end);
    const FreshFolder whole_folder, folder;
    MemoryKeeper unused, keeper(GENERATE(false, true)), later(false);
    const Run whole = run_in(whole_folder, {1.05, 0.25, false}, unused);
    const Run cut = run_in(folder, {end, 0.25, false, true}, keeper);
    CHECK(cut.summary.last.time == end);
    REQUIRE_FALSE(keeper.states.empty());
    later.from = keeper.states.back();
    check_same(run_in(folder, {1.05, 0.25, false}, later), whole);
}

TEST_CASE("a state past the requested end is refused", "[resume]") {
    const FreshFolder folder;
    MemoryKeeper keeper(false), later;
    run_in(folder, {1.0, 0.25, false}, keeper);
    later.from = keeper.states.back();
    CHECK_THROWS_WITH(run_in(folder, {0.5, 0.25, false}, later),
                      "--until: found 0.5 s; expected at least the 1 s of the state to go on from; give a later time");
}

TEST_CASE("tables that are gone or shorter than the state are refused", "[resume]") {
    const FreshFolder folder;
    MemoryKeeper keeper(false), later;
    run_in(folder, {1.0, 0.25, false}, keeper);
    later.from = keeper.states.back();
    std::filesystem::resize_file(folder.path() / "history.csv", 100);
    CHECK_THROWS_WITH(run_in(folder, {1.0, 0.25, false}, later),
                      Contains("history.csv: found 100 bytes; expected at least the"));
    std::filesystem::remove(folder.path() / "history.csv");
    CHECK_THROWS_WITH(run_in(folder, {1.0, 0.25, false}, later),
                      Contains("history.csv: cannot be continued: No such file or directory"));
}

TEST_CASE("a run that ended at rest or empty ends so again", "[resume]") {
    FakeScript script;
    SECTION("at rest") { script.rest_time = 0.3; }
    SECTION("empty") { script.leave_time = 0.3; }
    const FreshFolder folder;
    MemoryKeeper keeper(false), later(false);
    const Run first = run_in(folder, {1.0, 0.25, true}, keeper, script);
    later.from = keeper.states.back();
    check_same(run_in(folder, {1.0, 0.25, true}, later, script), first);
}
