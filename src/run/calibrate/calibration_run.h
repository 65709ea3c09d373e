#pragma once
// A calibration from its plan to its files: all of `frana calibrate` but its command line.
#include <filesystem>
#include <functional>
#include <vector>

#include "ensemble/calibration.h"
#include "run/calibrate/event_runs.h"

namespace frana {

/// What of a calibration is not there yet.
struct CalibrationWork {
    bool runs = false;
    bool maps = false;  ///< of another event

    bool any() const { return runs || maps; }
};

/// What is left to do in a folder. Throws UserError where files of others lie there. So too where an earlier
/// calibration does that is neither gone on with nor replaced, or where the other event's case cannot run.
CalibrationWork left_to_calibrate(const std::filesystem::path& dir, const CalibrationPlan& plan, bool resume,
                                  bool overwrite);

class CalibrationRun {
public:
    /// Builds the case of each event once. Throws UserError. All of these must outlive this.
    CalibrationRun(const CalibrationPlan& plan, std::filesystem::path dir, int threads, const Interrupt& interrupt);

    /// Of all rounds and events; the search has more.
    std::size_t runs() const;

    /// Runs what is left, and writes what is found. `overwrite`: begins anew. `done` hears of each run of the rounds,
    /// on any thread: whether it failed. Throws UserError, and Interrupted when an end was requested.
    Calibration carry_out(bool overwrite, const std::function<void(bool failed)>& done) const;

private:
    const CalibrationPlan& plan_;
    std::filesystem::path dir_;
    EventRuns runs_;
};

}  // namespace frana
