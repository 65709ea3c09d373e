#pragma once
// The point of the least misfit, by a local search from the best of the rounds.
#include <functional>
#include <optional>
#include <vector>

#include "ensemble/calibration.h"
#include "run/calibrate/kept_runs.h"

namespace frana {

/// Runs all events at all points, each a place in the unit cube: results by event, then point. Nothing when an end was
/// requested.
using RunsAt =
    std::function<std::optional<std::vector<std::vector<EventRun>>>(const std::vector<std::vector<double>>& points)>;

/// Goes down from the best point of all rounds by BOBYQA (Powell 2009). Steps are at least 3 % of a key's distribution:
/// below that runs differ by trifles. What the misfit changes by within 0.3 % is its noise; the search ends when it
/// gains no more. Nothing when an end was requested. Throws what `runs` throws.
std::optional<Optimum> search_optimum(const Calibration& calibration, const RunsAt& runs);

}  // namespace frana
