#pragma once
// What surveys tell of one another.
#include <string>
#include <vector>

#include "frana_calibrate.h"

namespace frana {

/// How near the runs come to an event, as the mean distance of the outlines [m], over all runs in which something flowed. Not a
/// number where it did in none.
struct Prediction {
    double prior = 0.0, prior_median = 0.0;  ///< by what is known before any survey: mean, median
    double own = 0.0, others = 0.0;          ///< by the event's own survey alone; by those of all other events
    double all = 0.0;                        ///< by all
    std::vector<double> by_one;              ///< by that of each event alone
};

/// By event.
std::vector<Prediction> predictions(const Calibration& calibration);

/// The same for people, and which surveys mislead.
std::string predictions_section(const Calibration& calibration);

}  // namespace frana
