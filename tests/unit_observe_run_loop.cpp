#include <csignal>
#include <sstream>

#include "catch.h"
#include "fake_simulation.h"
#include "run/run_loop.h"

using namespace frana;

namespace {

/// Notes down every call.
struct Notes {
    std::vector<double> step_times, frame_times, end_times;
    std::vector<Index> frame_numbers;
};

class NoteTaker : public Observer {
public:
    explicit NoteTaker(Notes& notes, bool looks = true) : notes_(notes), looks_(looks) {}
    std::string name() const override { return "notes"; }
    bool looks_at_fields() const override { return looks_; }
    void step(const Status& now, const Probe&) override { notes_.step_times.push_back(now.time); }
    void observe(const Frame& frame) override {
        notes_.frame_times.push_back(frame.status.time);
        notes_.frame_numbers.push_back(frame.number);
    }
    void end(const Frame& frame) override {
        notes_.end_times.push_back(frame.status.time);
        CHECK(frame.number == notes_.frame_numbers.back());
    }

private:
    Notes& notes_;
    bool looks_;
};

struct Outcome {
    Notes notes;
    RunSummary summary;
    std::string shown;
};

Outcome run_fake(const FakeScript& script, const RunPlan& plan, const Interrupt& interrupt,
                 Progress::Style style = Progress::Style::silent) {
    Outcome outcome;
    FakeSimulation simulation(script);
    Observers observers;
    observers.push_back(std::make_unique<NoteTaker>(outcome.notes));
    std::ostringstream stream;
    Progress progress(stream, style, FakeSimulation::density);
    outcome.summary = run(simulation, plan, observers, interrupt, progress);
    outcome.shown = stream.str();
    return outcome;
}

Outcome run_fake(const FakeScript& script, const RunPlan& plan) { return run_fake(script, plan, Interrupt()); }

}  // namespace

TEST_CASE("frames fall on exact multiples of the output interval, and on the end") {
    const Outcome outcome = run_fake({}, {1.0, 0.1, false});
    REQUIRE(outcome.notes.frame_times.size() == 11);
    for (std::size_t k = 0; k < 10; ++k) {
        CHECK(outcome.notes.frame_times[k] == static_cast<double>(k) * 0.1);  // the same bits, not a running sum
        CHECK(outcome.notes.frame_numbers[k] == static_cast<Index>(k));
    }
    CHECK(outcome.notes.frame_times.back() == 1.0);
    CHECK(outcome.notes.end_times == std::vector<double>{1.0});
    CHECK(outcome.summary.reason == "end");
    CHECK(outcome.summary.frames == 11);
}

TEST_CASE("an end that is no multiple of the interval gets its own frame, a multiple no second one") {
    CHECK(run_fake({}, {0.25, 0.1, false}).notes.frame_times == std::vector<double>{0.0, 0.1, 0.2, 0.25});
    // k * 0.1 may fall a rounding error beside k / 10.0: never two frames there
    for (int k = 1; k <= 60; ++k) {
        const Notes notes = run_fake({10.0, 1e9, 1e9, 1e9, false, {}}, {k / 10.0, 0.1, false}).notes;
        REQUIRE(notes.frame_times.size() == static_cast<std::size_t>(k) + 1);
        REQUIRE(notes.frame_times.back() == k / 10.0);
    }
}

TEST_CASE("observers see the start and every step once, in order") {
    const Outcome outcome = run_fake({0.03, 1e9, 1e9, 1e9, false, {}}, {0.1, 0.05, false});
    const std::vector<double> expected = {0.0, 0.03, 0.05, 0.08, 0.1};
    REQUIRE(outcome.notes.step_times.size() == expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) CHECK(outcome.notes.step_times[k] == Approx(expected[k]));
    CHECK(outcome.summary.steps == 4);
    CHECK(outcome.summary.particle_steps == 4.0 * 25.0);
}

TEST_CASE("a run stops at rest only when the plan says so, and shows the state at rest") {
    const FakeScript script{0.03, 0.5, 1e9, 1e9, false, {}};
    const Outcome stopped = run_fake(script, {2.0, 0.4, true});
    CHECK(stopped.summary.reason == "rest");
    CHECK(stopped.notes.frame_times.back() == stopped.summary.last.time);
    CHECK(stopped.summary.last.time >= 0.5);
    CHECK(stopped.summary.last.time < 0.5 + 0.03);
    CHECK(stopped.notes.end_times.size() == 1);
    CHECK(run_fake(script, {2.0, 0.4, false}).summary.reason == "end");
}

TEST_CASE("a release that stands still at the start is given one step before it counts as at rest") {
    const Outcome outcome = run_fake({0.03, 0.0, 1e9, 1e9, false, {}}, {2.0, 0.4, true});
    CHECK(outcome.summary.reason == "rest");
    CHECK(outcome.summary.steps == 1);
}

TEST_CASE("a run ends when no material is left") {
    const Outcome outcome = run_fake({0.03, 1e9, 0.2, 1e9, false, {}}, {2.0, 0.4, false});
    CHECK(outcome.summary.reason == "left");
    CHECK(outcome.summary.last.particles == 0);
    CHECK(outcome.notes.frame_times.back() == outcome.summary.last.time);
}

TEST_CASE("an interruption finishes the step, shows a last frame and ends the observers") {
    Interrupt interrupt;
    FakeScript script;
    script.on_step = [&](Index step) {
        if (step == 5) interrupt.request();
    };
    const Outcome outcome = run_fake(script, {2.0, 0.4, false}, interrupt);
    CHECK(outcome.summary.reason == "interrupted");
    CHECK(outcome.summary.steps == 5);
    CHECK(outcome.notes.frame_times.size() == 2);
    CHECK(outcome.notes.frame_times.back() == outcome.summary.last.time);
    CHECK(outcome.notes.end_times.size() == 1);
}

TEST_CASE("an interruption at an output time does not show the same state twice") {
    Interrupt interrupt;
    FakeScript script;
    script.dt = 0.4;
    script.on_step = [&](Index) { interrupt.request(); };
    const Outcome outcome = run_fake(script, {2.0, 0.4, false}, interrupt);
    CHECK(outcome.notes.frame_times == std::vector<double>{0.0, 0.4});
}

TEST_CASE("SIGINT, SIGTERM, SIGHUP and SIGPIPE are requests while an interrupt listens") {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
        const Interrupt interrupt(Interrupt::Listen::signals);
        CHECK_FALSE(interrupt.requested());
        std::raise(signal);
        CHECK(interrupt.requested());
    }
    CHECK_FALSE(Interrupt(Interrupt::Listen::signals).requested());
}

TEST_CASE("a numerics error leaves a last frame and stays in the summary") {
    const Outcome outcome = run_fake({0.03, 1e9, 1e9, 0.5, false, {}}, {2.0, 0.4, false});
    CHECK(outcome.summary.reason == "numerics");
    REQUIRE(outcome.summary.failure);
    CHECK_THROWS_AS(std::rethrow_exception(outcome.summary.failure), NumericsError);
    CHECK(outcome.summary.failure_text == "step 7: the depth of particle 3 is not finite");
    REQUIRE(outcome.notes.frame_times.size() == 3);
    CHECK(outcome.notes.frame_times.back() >= 0.5);
    CHECK(outcome.notes.end_times.size() == 1);
}

TEST_CASE("a case that is refused on the way leaves a last frame too, and stays the user's error") {
    FakeScript script;
    script.dt = 0.03;
    script.on_step = [](Index step) {
        if (step == 20) throw UserError("stage.spacing = 0.1: makes too many points");
    };
    const Outcome outcome = run_fake(script, {2.0, 0.4, false});
    CHECK(outcome.summary.reason == "refused");
    REQUIRE(outcome.summary.failure);
    CHECK_THROWS_AS(std::rethrow_exception(outcome.summary.failure), UserError);
    CHECK(outcome.summary.failure_text == "stage.spacing = 0.1: makes too many points");
    CHECK(outcome.summary.last.step == 20);
    CHECK(outcome.summary.steps == 20);
    CHECK(outcome.notes.frame_times.back() == outcome.summary.last.time);
    CHECK(outcome.notes.end_times.size() == 1);
}

TEST_CASE("a state that is not finite is never shown, and the summary says so") {
    const Outcome outcome = run_fake({0.03, 1e9, 1e9, 0.5, true, {}}, {2.0, 0.4, false});
    CHECK(outcome.summary.reason == "numerics");
    CHECK(outcome.notes.frame_times.size() == 2);
    CHECK(outcome.notes.end_times.empty());
    CHECK(outcome.summary.failure_text.find("no last frame, because") != std::string::npos);
    CHECK(std::isfinite(outcome.summary.last.kinetic));
}

TEST_CASE("a clock that stands still is a numerics error, not an endless loop") {
    const Outcome outcome = run_fake({0.0, 1e9, 1e9, 1e9, false, {}}, {2.0, 0.4, false});
    CHECK(outcome.summary.reason == "numerics");
    CHECK(outcome.summary.failure_text.find("too small to move the clock") != std::string::npos);
}

TEST_CASE("budgets are what no force and no open side accounts for") {
    const Outcome outcome = run_fake({}, {2.0, 0.4, false});
    const Budget result = budget(outcome.summary.first, outcome.summary.last);
    // from FakeSimulation::update() at t = 2; tolerances: a few roundings of the sums' largest terms
    CHECK(result.mass_error == Approx(1.0e-3 / 25.0e3).margin(1e-15).epsilon(1e-6));
    CHECK(result.momentum_residual[0] == Approx(2.0 * (3.0 - 2.0)).epsilon(1e-9));
    CHECK(result.momentum_residual[1] == Approx(2.0 * 1.0).epsilon(1e-9));
    CHECK(result.energy_residual == Approx(2.0 * (-40.0 + 30.0 + 6.0)).epsilon(1e-6));
    CHECK(outcome.summary.extremes.max_speed == outcome.summary.last.max_speed);
    CHECK(outcome.summary.extremes.max_speed_time == 2.0);
}

TEST_CASE("the summary times every observer by name and has the share of output") {
    const Outcome outcome = run_fake({}, {2.0, 0.4, false});
    REQUIRE(outcome.summary.output.size() == 2);
    CHECK(outcome.summary.output[0].name == "notes");
    CHECK(outcome.summary.output[1].name == "frame");
    CHECK(outcome.summary.output_seconds() > 0.0);
    CHECK(outcome.summary.output_share() <= 1.0);
    CHECK(outcome.summary.solver.size() == 2);
    CHECK(outcome.summary.started.size() == std::string("2024-05-01T12:00:00Z").size());
    CHECK(outcome.summary.ended >= outcome.summary.started);
}

TEST_CASE("progress writes a line per frame into a log, redraws one line on a terminal, and can be silent") {
    const RunPlan plan{1.0, 0.25, false};
    const std::string lines = run_fake({}, plan, Interrupt(), Progress::Style::lines).shown;
    CHECK(std::count(lines.begin(), lines.end(), '\n') == 5);
    CHECK(lines.find("frame    4  t 1 of 1 s") != std::string::npos);
    CHECK(lines.find("25 particles") != std::string::npos);
    const std::string bar = run_fake({}, plan, Interrupt(), Progress::Style::bar).shown;
    CHECK(std::count(bar.begin(), bar.end(), '\n') == 1);
    CHECK(bar.find("[####################] 100 %") != std::string::npos);
    // a run of a few milliseconds: the first drawing and the last, nothing between (five a second at most)
    CHECK(std::count(bar.begin(), bar.end(), '\r') <= 3);
    CHECK(run_fake({}, plan, Interrupt(), Progress::Style::silent).shown.empty());
}

TEST_CASE("wall time reads as a clock") {
    CHECK(clock_text(6.6) == "0:07");
    CHECK(clock_text(760.0) == "12:40");
    CHECK(clock_text(3 * 3600 + 5 * 60) == "3:05:00");
    CHECK(clock_text(std::numeric_limits<double>::infinity()) == "-:--");
}

TEST_CASE("where no observer reads fields they are computed once, for the end") {
    for (const bool looks : {true, false}) {
        CAPTURE(looks);
        FakeSimulation simulation;
        Notes notes;
        Observers observers;
        observers.push_back(std::make_unique<NoteTaker>(notes, looks));
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, FakeSimulation::density);
        run(simulation, {1.0, 0.25, false}, observers, Interrupt(), progress);
        CHECK(notes.frame_times == std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0});
        CHECK(notes.end_times == std::vector<double>{1.0});
        CHECK(simulation.frames_made() == (looks ? 6 : 1));
    }
}
