#pragma once
// What a calibration found, and what its weighted points tell of its keys, one by one and in pairs.
#include <optional>
#include <string>
#include <vector>

#include "ensemble/calibration_plan.h"
#include "ensemble/posterior.h"
#include "run/end_remarks.h"

namespace frana {

/// How near the runs of one event came to its survey, by point of the posterior.
struct EventFit {
    std::vector<EventScores> scores;
    std::vector<double> log_likelihood;  ///< without the event's weight
    std::vector<double> left_share;      ///< of all that flowed, that left the terrain [1]
    RemarkTally remarks = {};            ///< on the runs of the rounds
};

/// The point of the least misfit, where a search from the best of the rounds ended.
struct Optimum {
    std::vector<double> point;    ///< in the unit cube
    double misfit = 0.0;          ///< minus the logarithm of the likelihood there
    std::optional<double> noise;  ///< standard deviation of that between adjacent points; unknown where too few of them
                                  ///< have an answer
    Index evaluations = 0;        ///< points beyond those of the rounds
    std::string ended;            ///< why
    std::vector<EventScores> scores;  ///< by event
};

struct Calibration {
    CalibrationPlan plan;
    Posterior posterior;
    std::vector<EventFit> fits;             ///< by event
    Index failed = 0, not_at_rest = 0;      ///< runs
    double seconds = 0.0;                   ///< of all runs, on one thread each [s]
    std::string first_failure = {};         ///< of the first run that failed, in the order of points: why
    std::optional<Optimum> optimum = {};    ///< where one was searched
    std::vector<std::string> files = {};    ///< written
    std::vector<std::string> remarks = {};  ///< on keys that vary and do not hold everywhere, by event
    Index left_terrain = 0;                 ///< runs of which a noticeable share left it
};

/// Values of a key at all points.
std::vector<double> values_of(const Calibration& c, std::size_t key);

/// Two keys, and how far they go together in the posterior.
struct KeyPair {
    std::string first, second;
    std::optional<double> correlation;
};

std::vector<KeyPair> pairs_of(const Calibration& c);

/// How much more likely a value is than before the survey [1]. It is given by bins of its place in the prior, each with
/// as much of that.
std::vector<double> density_of(const Calibration& c, std::size_t key);

/// Is compared by blocks, some of which may have no survey.
inline bool is_raster(Evidence evidence) { return evidence == Evidence::deposit || evidence == Evidence::bed_change; }

}  // namespace frana
