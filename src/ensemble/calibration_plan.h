#pragma once
// What is to be learnt from surveyed events: which keys vary, and how near to a survey a run should come.
#include "ensemble/plan.h"

namespace frana {

/// A surveyed event. Its case has a [survey] with a footprint.
struct SurveyedEvent {
    std::string name;
    double weight = 1.0;  ///< of its likelihood [1]
    EnsemblePlan runs;    ///< its case, and the points so far
};

struct CalibrationPlan {
    std::filesystem::path file;
    Index samples = 128;  ///< of a round
    Index rounds = 3;
    std::uint64_t seed = 1;
    double sigma = 20.0;        ///< of the distance of the outlines, by survey and model [m]
    double correlation = 50.0;  ///< along an outline, over which its errors go together [m]
    std::vector<Vary> vary;
    std::vector<SurveyedEvent> events;
};

/// Reads and checks `file`. Throws one UserError with every problem found.
CalibrationPlan read_calibration(const std::filesystem::path& file);

/// Logarithm of the likelihood that a survey has, when outlines are `rms` apart [m] and the surveyed one is `perimeter` long [m]:
/// one independent normal error of `sigma` for each length of correlation.
double log_likelihood(double rms, double perimeter, const CalibrationPlan& plan);

}  // namespace frana
