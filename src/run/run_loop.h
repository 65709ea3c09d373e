#pragma once
// The time loop: advance, observe, stop. It uses solvers and observers only by their abstract faces.
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "observe/budget.h"
#include "observe/observer.h"
#include "run/interrupt.h"
#include "run/progress.h"
#include "run/rest_rule.h"
#include "run/state_keeper.h"

namespace frana {

class Simulation;
struct PhaseTime;

/// When a run is observed, and when it is over.
struct RunPlan {
    double end = 0.0;    ///< [s]
    double every = 1.0;  ///< frames at k * every [s], and one at the end
    bool stop_at_rest = false;
    /// The case itself ends later. Steps that were shortened to hit this end are then not those of the whole run. So no
    /// state is saved on the way from the last multiple of `every` to an end that is none.
    bool cut_short = false;
    double cell = 1.0;            ///< of the terrain, for the rule of rest [m]
    double rest_fraction = 0.05;  ///< of the scene
};

/// By the reason of its end, a run has an answer: it came to an end of its own or to time.end.
inline bool has_answer(const std::string& reason) { return reason == "end" || reason == "rest" || reason == "left"; }

/// What happened, for run.json and the report.
struct RunSummary {
    /// "end", "until" (its plan was cut short), "rest", "interrupted", "left" (no material remains), "numerics"
    /// (numbers that are not finite) or "refused" (what a stage or a larger terrain needs on the way)
    std::string reason;
    std::exception_ptr failure;  ///< the NumericsError, or of a refusal the UserError
    std::string failure_text;    ///< its message; says also when no last frame could be written
    Status first, last;          ///< of the first and the last frame; without a last frame, of the last step
    Extremes extremes;
    MovingMass motion;  ///< at the end; moving is what the rule of rest takes for it
    double slow = 0.0;  ///< speed below which it does not [m/s]
    Index steps = 0;
    Index frames = 0;
    double particle_steps = 0.0;  ///< sum of the particles over the steps
    double wall_seconds = 0.0;
    std::vector<PhaseTime> solver;  ///< wall time by the solver's phases but "frame"
    std::vector<PhaseTime> output;  ///< wall time by observer, "frame": gathering what they read, "checkpoint"
    std::string started, ended;     ///< wall clock, UTC, ISO 8601

    /// The time that it was to run is over: all of it, or a part.
    bool time_is_over() const { return reason == "end" || reason == "until"; }
    /// That ended it, or rest did.
    bool ended_by_rule() const { return time_is_over() || reason == "rest"; }
    /// The time was over before the mass had come to rest.
    bool still_moves() const { return time_is_over() && motion.share() > 0.0; }

    double output_seconds() const;
    double output_share() const { return wall_seconds > 0.0 ? output_seconds() / wall_seconds : 0.0; }
};

using Observers = std::vector<std::unique_ptr<Observer>>;

/// Runs `simulation` from its present time to the plan's end. Observers' step() is called at the start and after
/// every step. observe() is called at the start, at every k * every exactly and at the end. observe_between() is called
/// in between for observers that request a frame, and end() once, after the last observe(). An interruption finishes
/// the step and ends the run as usual. A NumericsError ends it too, and so does a UserError in a step. If the state can
/// still be shown it is the last frame. The error is stored in the summary, and the caller throws it once the products
/// are written. Errors of observers (a full disk) pass through. With a `keeper` the state of simulation, observers and
/// summary is saved whenever that is due. It is also saved when the run is over, before last frame and end(): a resumed
/// run shows its own. If the keeper has a state, the run goes on from there and its summary tells of the whole run.
RunSummary run(Simulation& simulation, const RunPlan& plan, Observers& observers, const Interrupt& interrupt,
               Progress& progress, StateKeeper* keeper = nullptr);

/// The present wall clock as "2024-05-01T12:00:00Z".
std::string utc_now();

}  // namespace frana
