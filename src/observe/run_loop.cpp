#include "observe/run_loop.h"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>

#include "base/error.h"
#include "solver/simulation.h"

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
    for (const double value : {s.time, s.mass, s.kinetic, s.potential, s.max_depth, s.max_speed})
        if (!std::isfinite(value)) return "a sum over the particles is not finite";
    for (const Field& field : frame.particles)
        if (!all_finite(field)) return fmt::format("the particles' {} is not finite", field.name);
    return std::nullopt;
}

class Loop {
public:
    Loop(Simulation& simulation, const RunPlan& plan, Observers& observers, const Interrupt& interrupt,
         Progress& progress)
        : simulation_(simulation),
          plan_(plan),
          observers_(observers),
          interrupt_(interrupt),
          progress_(progress) {
        summary_.first = summary_.last = simulation.status();
        summary_.started = utc_now();
        for (const auto& observer : observers) summary_.output.push_back({observer->name(), 0.0});
        summary_.output.push_back({"frame", 0.0});
    }

    RunSummary run();

private:
    void advance(double until);
    std::string reason_to_stop() const;
    double next_output_time() const;
    void show_step();
    void show_glance();
    void show_frame();
    void show_end();
    void give_up(const NumericsError& error);
    Frame frame();

    Simulation& simulation_;
    const RunPlan& plan_;
    Observers& observers_;
    const Interrupt& interrupt_;
    Progress& progress_;
    RunSummary summary_;
    Index outputs_ = 0;      ///< multiples of plan_.every passed
    Index shown_step_ = -1;  ///< step of the last frame that was shown
};

RunSummary Loop::run() {
    const auto start = std::chrono::steady_clock::now();
    progress_.begin(summary_.first, plan_.end);
    try {
        show_step();
        show_frame();
        while ((summary_.reason = reason_to_stop()).empty()) {
            const double output_time = next_output_time();
            advance(output_time);
            show_step();
            if (simulation_.status().time < output_time) {
                show_glance();
                continue;
            }
            ++outputs_;
            show_frame();
        }
        show_end();
    } catch (const NumericsError& error) {
        give_up(error);
    }
    summary_.ended = utc_now();
    summary_.wall_seconds = seconds_since(start);
    for (const PhaseTime& phase : simulation_.timings())
        if (phase.name != "frame") summary_.solver.push_back(phase);  // counted as output above
    progress_.end(summary_.last, summary_.reason);
    return summary_;
}

void Loop::advance(double until) {
    const double before = simulation_.status().time;
    simulation_.advance(until);
    const Status& now = simulation_.status();
    if (!(now.time > before))
        throw NumericsError(
            fmt::format("step {}: the time step at t = {} s is too small to move the clock (dt = {} s); "
                        "look at the last frame for a lone fast particle",
                        now.step, before, now.dt));
    summary_.steps = now.step - summary_.first.step;
    summary_.particle_steps += static_cast<double>(now.particles);
}

std::string Loop::reason_to_stop() const {
    const Status& now = simulation_.status();
    const bool moved = now.step > summary_.first.step;  // a release that has not yet started is not at rest
    if (now.time >= plan_.end) return "end";
    if (now.particles == 0) return "left";
    if (plan_.stop_at_rest && moved && simulation_.at_rest()) return "rest";
    if (interrupt_.requested()) return "interrupted";
    return "";
}

double Loop::next_output_time() const {
    const double time = static_cast<double>(outputs_ + 1) * plan_.every;
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
    timed(summary_.output.back(), [&] { result = simulation_.frame(); });
    return result;
}

/// A frame between two outputs, for those who ask for one.
void Loop::show_glance() {
    std::vector<std::size_t> asking;
    for (std::size_t i = 0; i < observers_.size(); ++i)
        if (observers_[i]->wants_frame(summary_.last)) asking.push_back(i);
    if (asking.empty()) return;
    Frame now = frame();
    now.number = summary_.frames;
    for (const std::size_t i : asking) timed(summary_.output[i], [&] { observers_[i]->glance(now); });
}

void Loop::show_frame() {
    Frame now = frame();
    now.number = summary_.frames;
    // A frame's sums belong to one moment; between frames a solver's velocities may lag behind its positions.
    summary_.last = now.status;
    if (summary_.frames == 0) summary_.first = now.status;
    for (std::size_t i = 0; i < observers_.size(); ++i)
        timed(summary_.output[i], [&] { observers_[i]->see(now); });
    shown_step_ = now.status.step;
    progress_.output(now.number, now.status);
    ++summary_.frames;
}

void Loop::show_end() {
    if (simulation_.status().step != shown_step_) show_frame();
    Frame last = frame();
    last.number = summary_.frames - 1;
    for (std::size_t i = 0; i < observers_.size(); ++i)
        timed(summary_.output[i], [&] { observers_[i]->end(last); });
}

void Loop::give_up(const NumericsError& error) {
    summary_.reason = "numerics";
    summary_.failure = std::current_exception();
    summary_.failure_text = error.what();
    try {
        if (const auto why = unfit(frame()))
            summary_.failure_text += fmt::format("; no last frame, because {}", *why);
        else
            show_end();
    } catch (const NumericsError& second) {
        summary_.failure_text += fmt::format("; no last frame: {}", second.what());
    }
}

}  // namespace

double RunSummary::output_seconds() const {
    double sum = 0.0;
    for (const PhaseTime& part : output) sum += part.seconds;
    return sum;
}

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

RunSummary run(Simulation& simulation, const RunPlan& plan, Observers& observers, const Interrupt& interrupt,
               Progress& progress) {
    expect(plan.every > 0.0 && plan.end >= 0.0, "a run plan has a positive output interval and end");
    return Loop(simulation, plan, observers, interrupt, progress).run();
}

}  // namespace frana
