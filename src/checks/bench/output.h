#pragma once
// What a frame costs, in steps.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"

namespace frana::bench {

/// Something that writes frames into a folder.
struct FrameWriter {
    std::string name;
    bool particles = true, nodes = true;  ///< what of a frame it is shown
    std::function<std::unique_ptr<Observer>(const std::filesystem::path& folder)> make;
};

/// The writer that a gate is held against.
constexpr const char* kGatedWriter = "HDF5, particles";

/// The least wall time that one frame took.
struct FrameCost {
    std::string name;  ///< "fields" for making the frame in memory
    Index fields = 0;
    double seconds = 0.0;
    double steps = 0.0;  ///< the same in steps of the same run, one thread
};

/// Makes and writes frames of the reference blob after some steps, with one thread. They go to a new folder in `folder`
/// that is removed again. Particles have twelve fields (position, velocity, depth, stresses, ...), nodes those of a
/// run.
std::vector<FrameCost> time_frames(Index particles, const std::vector<FrameWriter>& writers,
                                   const std::filesystem::path& folder);

/// Steps that the fields and that writer take together; NaN when it is not among them.
double steps_of(const std::vector<FrameCost>& costs, const std::string& writer);

}  // namespace frana::bench
