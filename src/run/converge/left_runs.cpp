#include "run/converge/left_runs.h"

#include <fmt/core.h>

#include <algorithm>

#include "run/folder/left_terrain.h"

namespace frana {

void doubt_left(ConvergenceStudy& study) {
    if (std::all_of(study.left.begin(), study.left.end(), [](double share) { return share == 0.0; })) return;
    std::string shares;
    for (std::size_t k = 0; k < study.runs.size(); ++k)
        shares +=
            fmt::format("{}{:.3g} % on {:g} m", shares.empty() ? "" : ", ", 100.0 * study.left[k], study.runs[k].cell);
    study.remarks.insert(
        study.remarks.begin(),
        fmt::format("of all that flowed {} left the terrain: runout, reach, footprint and deposit are lower bounds; {}",
                    shares, kWayOut));
    if (!study.verdict.converged) return;  // so it stays, whatever lies beyond
    study.verdict.converged = false, study.verdict.enough.reset();
    study.verdict.sentence = fmt::format(
        "It is not known whether the answer has converged: the flow left the terrain, and runouts that end at its edge "
        "agree on any cell; {}. On this terrain alone: {}",
        kWayOut, study.verdict.sentence);
}

}  // namespace frana
