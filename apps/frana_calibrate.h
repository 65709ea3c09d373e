#pragma once
// What `frana calibrate` found, and the files that it leaves.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ensemble/calibration_plan.h"
#include "ensemble/posterior.h"
#include "frana_calibrate_search.h"

namespace frana {

/// How near the runs of one event came to its survey, by point of the posterior.
struct EventFit {
    std::vector<EventScores> scores;
    std::vector<double> log_likelihood;  ///< without the event's weight
};

struct Calibration {
    CalibrationPlan plan;
    Posterior posterior;
    std::vector<EventFit> fits;           ///< by event
    Index failed = 0, not_at_rest = 0;    ///< runs
    double seconds = 0.0;                 ///< of all runs, on one thread each [s]
    std::string first_failure = {};       ///< of the first run that failed, in the order of points: why
    std::optional<Optimum> optimum = {};  ///< where one was searched
    std::vector<std::string> files = {};  ///< written
};

/// Writes calibrate.json, report.md, runs.csv, posterior.csv and the pictures. Returns their names. Throws UserError.
std::vector<std::string> write_calibration(const std::filesystem::path& dir, const Calibration& calibration);

/// For people: the best values, what is known of them, and how near the events are met.
std::string calibration_section(const Calibration& calibration);

}  // namespace frana
