#pragma once
// What is remarked on a run once it is over, and how many of many runs have the same remark.
#include <map>
#include <string>
#include <vector>

#include "base/types.h"
#include "observe/frame.h"
#include "run/run_loop.h"

namespace frana {

class Simulation;

/// A remark on one run, with the numbers of that run.
struct EndRemark {
    std::string text;
    double worse = 0.0;  ///< the larger, the more it matters, among runs with the same remark
};

/// What the simulation says of how it went, and energy that nothing gave.
std::vector<EndRemark> remarks_at_end(const Simulation& simulation, const RunSummary& summary);

/// Whether free water is all that there was, which has no particles.
inline bool of_water_alone(const Extras& extras) { return extras.water && !extras.breakage; }

/// The same remark on several runs, as the run has it for which it matters most: the first of those that are alike.
struct SharedRemark {
    std::string text;
    Index runs = 0;
    Index worst = 0;       ///< number of that run
    bool differs = false;  ///< in how much it matters

    /// "in 12 of 50 runs, worst in sample 7: the flow is ..."
    std::string sentence(Index of) const;
};

/// Counts remarks over runs. Two are the same if they differ in numbers only, behind what they are about ("name: ").
class RemarkTally {
public:
    void add(Index run, const std::vector<EndRemark>& remarks);
    /// From the one that concerns most runs; else as they came.
    std::vector<SharedRemark> all() const;
    /// The first of all() as sentences, and how many more there are.
    std::vector<std::string> sentences(Index of) const;

private:
    std::vector<SharedRemark> kinds_;
    std::vector<double> worst_;  ///< of each
    std::map<std::string, std::size_t> number_;
};

}  // namespace frana
