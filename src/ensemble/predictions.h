#pragma once
// What surveys tell of one another.
#include <string>
#include <vector>

#include "ensemble/calibration.h"

namespace frana {

/// How near runs come to an event by some knowledge: the distance of the outlines [m], by weight. Only runs in which
/// something flowed count. Not numbers where it did in none that has weight.
struct Nearness {
    double mean = 0.0, median = 0.0;
    double effective = 0.0;  ///< points of equal weight that tell as much
};

struct Prediction {
    Nearness prior;                ///< by what is known before any survey
    Nearness own, others;          ///< by the event's own survey alone; by those of all other events
    Nearness all;                  ///< by all
    std::vector<Nearness> by_one;  ///< by that of each event alone
};

/// By event.
std::vector<Prediction> predictions(const Calibration& calibration);

/// The same for people, and which surveys mislead.
std::string predictions_section(const Calibration& calibration);

}  // namespace frana
