#pragma once
// What `frana bench` runs, and what came out.
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "checks/bench/calibrate.h"
#include "checks/bench/measure.h"
#include "checks/bench/output.h"

namespace frana::bench {

struct Options {
    std::vector<Index> particles{70000, 500000, 4000000};  ///< of the full step
    std::vector<int> threads{1, 2};
    bool quick = false;                ///< fewer rounds and windows, no more than 500 000 particles, no wide grid
    Index array_bytes = 0;             ///< of the triad, 0: by the machine's caches
    std::vector<FrameWriter> writers;  ///< timed with the reference blob
};

/// A scene that was timed. `model` begins the contract's MODEL/PHASE/PRECISION: "depth_averaged" is the whole physics,
/// with Voellmy, Bingham and topography; others have a suffix. "solid_flow": 3D points, a fluid on a plane.
struct Timed {
    std::string model;
    std::string precision = "double";  ///< or "float": of what points carry
    Cost cost;
};

struct Report {
    Options options;
    Calibration calibration;
    std::vector<Timed> timed;
    std::map<int, std::uint64_t> hashes;  ///< of one short run, by threads
    std::vector<FrameCost> frames;        ///< empty without writers
};

/// Runs everything; `say` is called with a line of progress before each part. Throws UserError for particles or threads
/// that cannot be.
Report run(const Options& options, const std::function<void(const std::string&)>& say);

/// The timed scene with that model, particles (0: any), threads and precision, or nullptr.
const Timed* find(const Report& report, const std::string& model, Index particles, int threads,
                  const std::string& precision = "double");

/// Number of particles that variants and gates refer to: the one of the options that is nearest to 500 000.
Index reference_particles(const Options& options);

}  // namespace frana::bench
