#pragma once
// The point of the least misfit, by a local search from the best of the rounds.
#include <optional>
#include <string>
#include <vector>

#include "ensemble/evidence.h"

namespace frana {

class EventRuns;
class KeptRuns;
struct Calibration;

struct Optimum {
    std::vector<double> point;    ///< in the unit cube
    double misfit = 0.0;          ///< minus the logarithm of the likelihood there
    std::optional<double> noise;  ///< standard deviation of that between adjacent points; unknown where too few of them
                                  ///< have an answer
    Index evaluations = 0;        ///< points beyond those of the rounds
    std::string ended;            ///< why
    std::vector<EventScores> scores;  ///< by event
};

/// Goes down from the best point of all rounds by BOBYQA (Powell 2009). Steps are at least 3 % of a key's distribution:
/// below that runs differ by trifles. What the misfit changes by within 0.3 % is its noise; the search ends when it
/// gains no more. Nothing when an end was requested.
std::optional<Optimum> search_optimum(const EventRuns& runs, KeptRuns& kept, const Calibration& calibration);

}  // namespace frana
