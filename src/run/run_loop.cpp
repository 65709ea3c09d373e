#include "run/run_loop.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>
#include <stdexcept>

#include "base/error.h"
#include "run/memory_state.h"
#include "run/round_off_speed.h"
#include "run/simulation.h"

namespace frana {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Calls `work` and adds its wall time to `total`.
template <class Work>
void timed(PhaseTime& total, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    total.seconds += seconds_since(start);
}

bool all_finite(const Field& field) {
    const double* const end = field.data + field.count * field.components;
    return std::all_of(field.data, end, [](double value) { return std::isfinite(value); });
}

/// The first reason why a frame may not reach a file. Node fields hold NaN for nodata, particles never do.
std::optional<std::string> unfit(const Frame& frame) {
    const Status& s = frame.status;
    for (const double value : {s.time, s.mass, s.kinetic, s.potential, s.max_depth, s.max_speed, s.max_speed_on_map})
        if (!std::isfinite(value)) return "a sum over the particles is not finite";
    for (const Field& field : frame.particles)
        if (!all_finite(field)) return fmt::format("the particles' {} is not finite", field.name);
    return std::nullopt;
}

/// A step that its simulation refuses as the user's error. Errors of observers are none: they pass through.
struct Refusal : std::runtime_error {
    explicit Refusal(const UserError& of) : std::runtime_error(of.what()), error(std::current_exception()) {}
    std::exception_ptr error;
};

class Loop {
public:
    Loop(Simulation& simulation, const RunPlan& plan, Observers& observers, const Interrupt& interrupt,
         Progress& progress, StateKeeper* keeper)
        : simulation_(simulation),
          plan_(plan),
          observers_(observers),
          interrupt_(interrupt),
          progress_(progress),
          keeper_(keeper),
          rest_(plan.cell, plan.rest_fraction) {
        summary_.first = summary_.last = simulation.status();
        summary_.started = utc_now();
        for (const auto& observer : observers) summary_.output.push_back({observer->name(), 0.0});
        frame_phase_ = summary_.output.size();
        summary_.output.push_back({"frame", 0.0});
        if (keeper_) summary_.output.push_back({"checkpoint", 0.0});
    }

    RunSummary run();

private:
    void step(double until);
    void advance(double until);
    bool own_steps() const { return simulation_.longest_step() > 0.0; }
    void step_past_outputs();
    double show_outputs_aside();
    std::string reason_to_stop() const;
    double output_time(Index number) const;
    double next_output_time() const { return output_time(outputs_ + 1); }
    void show_step();
    void show_between();
    void show_frame();
    void show_end();
    void give_up(const char* reason, const std::exception_ptr& error, const std::string& text);
    bool resume();
    void require_later_end() const;
    void save_state();
    bool heads_for_the_cut() const;
    double time() const { return simulation_.status().time; }
    bool last_before_the_cut() const;
    void serialize(Archive& archive);
    double wall_seconds() const { return wall_before_ + seconds_since(start_); }
    Frame frame();
    Frame frame_to_observe();

    Simulation& simulation_;
    const RunPlan& plan_;
    Observers& observers_;
    const Interrupt& interrupt_;
    Progress& progress_;
    StateKeeper* keeper_;
    RestRule rest_;
    RunSummary summary_;
    std::size_t frame_phase_ = 0;  ///< of summary_.output
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    double wall_before_ = 0.0;  ///< of the runs that this one goes on from [s]
    Index outputs_ = 0;         ///< multiples of plan_.every passed
    Index shown_step_ = -1;     ///< step of the last frame that was shown
    MemoryState aside_;         ///< the simulation, while outputs are shown between two of its steps
    bool kept_before_the_cut_ = false;
};

RunSummary Loop::run() {
    try {
        const bool resumed = resume();
        progress_.begin(simulation_.status(), plan_.end);
        if (resumed) {
            progress_.resumed(simulation_.status());
        } else {
            if (plan_.stop_at_rest) rest_.note(simulation_);
            show_step();
            show_frame();
        }
        while ((summary_.reason = reason_to_stop()).empty()) {
            if (keeper_ && (keeper_->due() || last_before_the_cut())) save_state();
            step_past_outputs();
        }
        summary_.slow = rest_.slow_at(simulation_.status().time);
        // Early on that is faster than anything moves. What was cut short then still moves.
        if (summary_.time_is_over())
            summary_.slow = std::min(summary_.slow, plan_.rest_fraction * summary_.extremes.max_speed);
        const double still = round_off_speed(simulation_);  // the largest speed may be round-off as well
        summary_.slow = std::max(summary_.slow, still);
        summary_.motion = simulation_.motion({summary_.slow, simulation_.status().time});
        if (summary_.motion.fastest <= still) summary_.motion.fastest = 0.0;
        save_state();
        show_end();
    } catch (const Refusal& refusal) {
        give_up("refused", refusal.error, refusal.what());
    } catch (const NumericsError& error) {
        give_up("numerics", std::current_exception(), error.what());
    }
    summary_.ended = utc_now();
    summary_.wall_seconds = wall_seconds();
    for (const PhaseTime& phase : simulation_.timings())
        if (phase.name != "frame") summary_.solver.push_back(phase);  // counted as output above
    progress_.end(summary_.last, summary_.reason);
    return summary_;
}

/// One step, and the outputs on the way. Where the simulation has its own step it is shortened for the end only.
/// Otherwise observing would change what happens.
void Loop::step_past_outputs() {
    double shown = time(), output_time = 0.0;
    do {  // a step may turn out shorter than it was said to be, and the next one pass more outputs
        if (own_steps()) shown = std::max(shown, show_outputs_aside());
        if (own_steps() && interrupt_.requested()) return;  // a resumed run shows those outputs
        output_time = next_output_time();
        advance(own_steps() ? plan_.end : output_time);
        show_step();
        if (time() < output_time) show_between();
    } while (time() < shown);
    if (time() < output_time) return;
    ++outputs_;
    show_frame();
}

/// Goes to the outputs that the next step would pass, hits and shows them. Then it comes back to where it was. Returns
/// the time of the last frame shown, or the present time. There may be thousands: an interrupt is heard after each.
double Loop::show_outputs_aside() {
    const double past = std::min(time() + simulation_.longest_step(), plan_.end);
    if (!(next_output_time() < past)) return time();
    PhaseTime& cost = summary_.output[frame_phase_];
    timed(cost, [&] { aside_.save(simulation_); });
    Index number = outputs_;  // of the last output that is not ahead: an interrupted run may have shown some that are
    while (output_time(number) > time()) --number;
    for (double next = 0.0; (next = output_time(++number)) < past && !interrupt_.requested();) {
        timed(cost, [&] {
            while (time() < next) step(next);
        });
        if (number <= outputs_) continue;  // a step on the way to others, as it was then
        ++outputs_;
        show_frame();
    }
    const double shown = time();
    timed(cost, [&] { aside_.load(simulation_); });
    shown_step_ = -1;
    return shown;
}

bool Loop::resume() {
    if (!keeper_) return false;
    return keeper_->load([&](Archive& archive) { serialize(archive); });
}

void Loop::require_later_end() const {
    if (simulation_.status().time > plan_.end)
        throw UserError(
            fmt::format("--until: found {} s; expected at least the {} s of the state to go on from; "
                        "give a later time",
                        plan_.end, simulation_.status().time));
}

/// The next steps, or the last ones, are shortened for an end that the whole run does not have.
bool Loop::heads_for_the_cut() const {
    if (plan_.cut_short && own_steps()) return plan_.end - time() < 2.0 * simulation_.longest_step();
    return plan_.cut_short && next_output_time() != static_cast<double>(outputs_ + 1) * plan_.every;
}

bool Loop::last_before_the_cut() const {
    if (own_steps()) return heads_for_the_cut() && !kept_before_the_cut_;
    return heads_for_the_cut() && static_cast<double>(outputs_) * plan_.every == simulation_.status().time;
}

void Loop::save_state() {
    if (!keeper_ || (heads_for_the_cut() && !last_before_the_cut())) return;
    kept_before_the_cut_ = heads_for_the_cut();
    timed(summary_.output.back(),
          [&] { keeper_->save(simulation_.status().time, [&](Archive& archive) { serialize(archive); }); });
}

void Loop::serialize(Archive& archive) {
    {
        const Archive::Part part(archive, "run");
        frana::serialize(archive, "first", summary_.first);
        frana::serialize(archive, "last", summary_.last);
        frana::serialize(archive, "output", summary_.output);
        Extremes& most = summary_.extremes;
        archive.numbers("extremes",
                        {&most.max_depth, &most.max_depth_time, &most.max_speed, &most.max_speed_time,
                         &most.max_covered_area, &most.max_front, &most.p2g_mass_error, &most.p2g_momentum_error});
        double wall = wall_seconds();
        archive.numbers("numbers", {&summary_.particle_steps, &wall});
        archive.number("steps", summary_.steps);
        archive.number("frames", summary_.frames);
        archive.number("outputs", outputs_);
        archive.number("shown_step", shown_step_);
        archive.text("started", summary_.started);
        rest_.serialize(archive);
        if (archive.loading()) wall_before_ = wall;
        if (summary_.output.size() != observers_.size() + 2)
            throw UserError("the saved state is of other observers; run without --resume");
    }
    {
        const Archive::Part part(archive, "simulation");
        simulation_.serialize(archive);
    }
    if (archive.loading()) require_later_end();  // before observers take back what is newer than the state
    for (std::size_t i = 0; i < observers_.size(); ++i) {
        const Archive::Part part(archive, fmt::format("observers/{:03d}", i));
        observers_[i]->serialize(archive);
    }
}

/// Throws when the clock does not move.
void Loop::step(double until) {
    const double before = time();
    try {
        simulation_.advance(until);
    } catch (const UserError& error) {  // of what a stage needs on the way
        throw Refusal(error);
    }
    const Status& now = simulation_.status();
    if (!(now.time > before))
        throw NumericsError(
            fmt::format("step {}: the time step at t = {} s is too small to move the clock (dt = {} s); "
                        "look at the last frame for a lone fast particle",
                        now.step, before, now.dt));
}

void Loop::advance(double until) {
    step(until);
    const Status& now = simulation_.status();
    if (plan_.stop_at_rest) rest_.note(simulation_);
    summary_.steps = now.step - summary_.first.step;
    summary_.particle_steps += static_cast<double>(now.particles);
}

std::string Loop::reason_to_stop() const {
    const Status& now = simulation_.status();
    const bool moved = now.step > summary_.first.step;  // a release that has not yet started is not at rest
    if (now.time >= plan_.end) return plan_.cut_short ? "until" : "end";
    if (now.particles == 0 && !(now.mass > 0.0) && !simulation_.more_comes())
        return "left";  // free water may flow on alone
    if (plan_.stop_at_rest && moved && rest_.at_rest()) return "rest";
    if (interrupt_.requested()) return "interrupted";
    return "";
}

double Loop::output_time(Index number) const {
    const double time = static_cast<double>(number) * plan_.every;
    // k * every may fall a rounding error short of the end; two frames there would be one too many.
    return time > plan_.end - 1e-9 * plan_.every ? plan_.end : time;
}

void Loop::show_step() {
    summary_.last = simulation_.status();
    summary_.extremes.note(summary_.last);
    for (std::size_t i = 0; i < observers_.size(); ++i)
        timed(summary_.output[i], [&] { observers_[i]->step(summary_.last, simulation_); });
    progress_.step(summary_.last);
}

Frame Loop::frame() {
    Frame result;
    timed(summary_.output[frame_phase_], [&] { result = simulation_.frame(); });
    return result;
}

/// A frame between two outputs, for observers that request one.
void Loop::show_between() {
    std::vector<std::size_t> asking;
    for (std::size_t i = 0; i < observers_.size(); ++i)
        if (observers_[i]->wants_frame(summary_.last)) asking.push_back(i);
    if (asking.empty()) return;
    Frame now = frame();
    now.number = summary_.frames;
    for (const std::size_t i : asking) timed(summary_.output[i], [&] { observers_[i]->observe_between(now); });
}

Frame Loop::frame_to_observe() {
    const bool looked_at =
        std::any_of(observers_.begin(), observers_.end(), [](const auto& one) { return one->looks_at_fields(); });
    if (looked_at) return frame();
    Frame result;
    timed(summary_.output[frame_phase_], [&] { result.status = simulation_.frame_status(); });
    return result;
}

void Loop::show_frame() {
    Frame now = frame_to_observe();
    now.number = summary_.frames;
    // A frame's sums belong to one moment; between frames a solver's velocities may lag behind its positions.
    summary_.last = now.status;
    if (summary_.frames == 0) summary_.first = now.status;
    for (std::size_t i = 0; i < observers_.size(); ++i) timed(summary_.output[i], [&] { observers_[i]->observe(now); });
    shown_step_ = now.status.step;
    progress_.output(now.number, now.status);
    ++summary_.frames;
}

void Loop::show_end() {
    const bool shown_later = summary_.last.time > time();  // aside: time must not go back in the frames
    if (simulation_.status().step != shown_step_ && !shown_later) show_frame();
    Frame last = frame();
    last.number = summary_.frames - 1;
    for (std::size_t i = 0; i < observers_.size(); ++i) timed(summary_.output[i], [&] { observers_[i]->end(last); });
}

/// What was reached is shown all the same.
void Loop::give_up(const char* reason, const std::exception_ptr& error, const std::string& text) {
    summary_.reason = reason;
    summary_.failure = error;
    summary_.failure_text = text;
    try {
        if (const auto why = unfit(frame()))
            summary_.failure_text += fmt::format("; no last frame, because {}", *why);
        else
            show_end();
    } catch (const NumericsError& second) {
        summary_.failure_text += fmt::format("; no last frame: {}", second.what());
    }
    summary_.steps = summary_.last.step - summary_.first.step;  // the step that failed is in the last frame
}

}  // namespace

double RunSummary::output_seconds() const {
    double sum = 0.0;
    for (const PhaseTime& part : output) sum += part.seconds;
    return sum;
}

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

RunSummary run(Simulation& simulation, const RunPlan& plan, Observers& observers, const Interrupt& interrupt,
               Progress& progress, StateKeeper* keeper) {
    expect(plan.every > 0.0 && plan.end >= 0.0, "a run plan has a positive output interval and end");
    return Loop(simulation, plan, observers, interrupt, progress, keeper).run();
}

}  // namespace frana
