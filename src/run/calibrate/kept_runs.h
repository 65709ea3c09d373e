#pragma once
// The runs of a calibration as they come, for one that goes on where another was killed.
#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "ensemble/calibration_plan.h"
#include "run/end_remarks.h"
#include "run/run_loop.h"

namespace frana {

/// A run of an event: why it ended, and how near it came.
struct EventRun {
    std::string reason, message;  ///< as of SampleResult
    double seconds = 0.0;         ///< wall time [s]
    EventScores scores;           ///< nothing known where the run has no answer
    bool still_moves = false;     ///< as of SampleResult
    double left_share = 0.0;      ///< as of SampleResult [1]
    std::vector<EndRemark> remarks = {};

    bool ended() const { return has_answer(reason); }
};

/// DIR/kept/runs.csv: a row of each run. A run's results depend on the values of the keys alone, so a row serves any
/// request for these values. More rounds, other samples and other priors go on with what is there.
class KeptRuns {
public:
    /// Takes up what the folder has, but for what was refused. Throws UserError where it is of other events or another version.
    KeptRuns(const std::filesystem::path& dir, const CalibrationPlan& plan);

    /// The run of an event with these values; null where there is none yet. Not while runs are added.
    const EventRun* find(std::size_t event, const std::vector<std::string>& values) const;
    /// From any thread; written soon.
    void add(std::size_t event, const std::vector<std::string>& values, const EventRun& run);
    /// Writes what is not written yet.
    void flush();

    /// Whether the folder has runs of a calibration.
    static bool are_in(const std::filesystem::path& dir);
    static void remove(const std::filesystem::path& dir);

private:
    void write();

    std::filesystem::path file_;
    std::string rows_;
    bool broken_ = false, waiting_ = false;
    std::map<std::string, EventRun> runs_;  ///< by event and values
    std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
    std::mutex mutex_;
};

/// A checksum of all that decides what a calibration finds, to recognise the same one.
std::string mark_of(const CalibrationPlan& plan);

}  // namespace frana
