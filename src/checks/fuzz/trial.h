#pragma once
// One case, run step by step under watch.
#include <functional>

#include "checks/fuzz/invariants.h"

namespace frana::fuzz {

/// What became of a case.
struct Verdict {
    std::optional<Violation> broken;  ///< the first invariant that broke, if any did
    bool refused = false;             ///< `text` says why the scene was no scene
    std::string text;
    Index steps = 0, particles = 0;       ///< particles: most at a time
    double time = 0.0;                    ///< simulated [s]
    bool parted = false;                  ///< its mirror images parted by round-off that the flow made grow (has_grown)
    std::map<std::string, double> worst;  ///< by invariant, in units of what is allowed
};

/// Stops a run whose points have multiplied beyond this: it says no more than a shorter one.
constexpr Index kMostPoints = 60000;

/// Falsifies a state before it is judged, so that tests can check the judging.
using Falsify = std::function<void(Snapshot&)>;

/// Whether a difference between mirror images is round-off that the flow itself made grow, as streams that meet do. Then it
/// is in proportion to what disturbed the images at first. In a twin all numbers of the points are off by `kDisturbed`
/// times the round-off of depths, each its own way. (That is the elevation's round-off over the depth.) The twin's difference
/// at that step is more than 1 / `kShare` times as large. The rest is for the round-off of all steps since. What the
/// code itself does to one of the images is as large in the twin. So is a choice that round-off tips.
bool has_grown(const Scene& scene, const Facts& facts, const Scale& scale, const Violation& difference);
constexpr double kDisturbed = 1e4, kShare = 0.1;

/// Runs `scene` for at most `steps` steps, or until nothing is left, and checks after each.
Verdict examine(const Scene& scene, const Claims& claims, Index steps, const Falsify& falsify = {});
Verdict examine(const Draft& draft, const Falsify& falsify = {});

}  // namespace frana::fuzz
