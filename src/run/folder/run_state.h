#pragma once
// A depth-averaged state read back from the frames of a run, finished or still going on.
#include <filesystem>
#include <string>
#include <vector>

#include "convert/flow_particles.h"

namespace frana {

struct RunState {
    double time = 0.0;        ///< of the frame that was taken [s]
    FlowParticles particles;  ///< the run's particles, with the slopes of `bed`
    Raster bed;               ///< with the run's coordinate system as far as it is known
    std::string frames;       ///< the file that lists the frames
    double free_water = 0.0;  ///< besides the particles, in VTK frames; nothing of it is in `particles` [m3]
};

/// Position of the frame nearest to `time` [s]. Throws UserError where there are none, and before the first or past the
/// last of them. The message names --time and the file that lists the frames.
Index choose_frame(const std::vector<double>& times, double time, const std::filesystem::path& frames);

/// The frame nearest to `time` [s], of particles.pvd or, in runs without VTK files, of run.h5. The bed under a particle
/// is the run's own (free surface minus depth). Slopes are those of the terrain that the run wrote. Along the way of a
/// particle they are those by which the run says that it climbs. Throws UserError when the folder holds no frames, or
/// `time` lies before the first or past the last. So too when a file is missing, damaged or has not the fields that a
/// state needs.
RunState read_run_state(const std::filesystem::path& run_dir, double time);

/// The terrain of a run on its grid: of terrain.vti, or of run.h5. Throws UserError when there is neither.
Raster bed_of_run(const std::filesystem::path& run_dir);

}  // namespace frana
