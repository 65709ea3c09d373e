#pragma once
// What is to be learnt from surveyed events: which keys vary, how near to a survey runs should come.
#include "ensemble/evidence.h"
#include "ensemble/plan.h"

namespace frana {

/// The largest depth and speed that were seen at a gauge of the case.
struct SeenAtGauge {
    std::string name;
    std::optional<double> depth, speed;  ///< one of them at least [m], along the map [m/s]
};

/// A surveyed event. Its case has a [survey] with a footprint.
struct SurveyedEvent {
    std::string name;
    double weight = 1.0;              ///< of its likelihood [1]
    std::vector<Evidence> objective;  ///< what counts
    SurveyErrors errors;
    std::vector<SeenAtGauge> gauges;
    EnsemblePlan runs;  ///< its case, and the keys that vary
};

struct CalibrationPlan {
    std::filesystem::path file;
    Index samples = 128;  ///< of a round
    Index rounds = 3;
    std::uint64_t seed = 1;
    Index draws = 256;                                      ///< points of the posterior for the maps of another event
    bool search = true;                                     ///< for the point of the least misfit, after the rounds
    std::vector<Evidence> objective = {Evidence::outline};  ///< where an event says nothing else
    SurveyErrors errors;                                    ///< likewise
    std::vector<Vary> vary;
    std::vector<SurveyedEvent> events;
    std::optional<EnsemblePlan> predict;  ///< another event to map: its case and which maps
};

/// Reads and checks `file`. Throws one UserError with every problem found.
CalibrationPlan read_calibration(const std::filesystem::path& file);

}  // namespace frana
