#pragma once
// One case, run step by step under watch.
#include <functional>

#include "stress/invariants.h"

namespace frana::stress {

/// What became of a case.
struct Verdict {
    std::optional<Violation> broken;  ///< the first invariant that broke, if any did
    bool refused = false;             ///< `text` says why the scene was no scene
    std::string text;
    Index steps = 0, particles = 0;   ///< particles: most at a time
    double time = 0.0;                ///< simulated [s]
    std::map<std::string, double> worst;  ///< by invariant, in units of what is allowed
};

/// Stops a run whose points have multiplied beyond this: it says no more than a shorter one.
constexpr Index kMostPoints = 60000;

/// Falsifies a state before it is judged, so that tests see that it is.
using Falsify = std::function<void(Snapshot&)>;

/// Runs `scene` for at most `steps` steps, or until nothing is left, and checks after each.
Verdict examine(const Scene& scene, const Claims& claims, Index steps, const Falsify& falsify = {});
Verdict examine(const Draft& draft, const Falsify& falsify = {});

}  // namespace frana::stress
