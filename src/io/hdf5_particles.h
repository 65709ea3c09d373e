#pragma once
// Frames read back from the run.h5 of a run directory (layout: xdmf_writer.h), for what is made after the run.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Particle arrays of one frame.
struct StoredParticles {
    double time = 0.0;  ///< [s]
    Index count = 0;
    std::map<std::string, std::vector<double>> arrays;  ///< count * components numbers, interleaved
    std::map<std::string, int> components;
    Raster bed;  ///< grid/elevation; NaN where there is no terrain
};

/// Times [s] of the frames that the file holds, in order. Throws UserError when it cannot be read.
std::vector<double> hdf5_frame_times(const std::filesystem::path& file);

/// Frame `number` of it. Throws UserError when there is none or it is not as a run writes it.
StoredParticles read_hdf5_particles(const std::filesystem::path& file, Index number);

}  // namespace frana
