#pragma once
// A depth-averaged state read back from the frames of a run, finished or still going on.
#include <filesystem>
#include <string>
#include <vector>

#include "convert/flow_columns.h"

namespace frana {

struct RunState {
    double time = 0.0;        ///< of the frame that was taken [s]
    FlowColumns columns;      ///< the run's particles, with the slopes of `bed`
    Raster bed;               ///< with the run's coordinate system as far as it is known
    std::string frames;       ///< the file that lists the frames
    double free_water = 0.0;  ///< beside the columns, in VTK frames; nothing of it is in these [m3]
};

/// Position of the frame nearest to `time` [s]. Throws UserError, which names --time and the file that lists the frames,
/// where there are none, and before the first or past the last of them.
Index choose_frame(const std::vector<double>& times, double time, const std::filesystem::path& frames);

/// The frame nearest to `time` [s], of particles.pvd or, in runs without VTK files, of run.h5. The bed under a particle
/// is the run's own (free surface minus depth); slopes are those of the terrain that the run wrote, along
/// the way of a particle those by which the run says that it climbs. Throws UserError
/// when the folder holds no frames, when `time` lies before the first or past the last of them, or when a file is
/// missing, damaged or has not the fields that a state needs.
RunState read_run_state(const std::filesystem::path& run_dir, double time);

/// The terrain of a run on its grid: of terrain.vti, or of run.h5. Throws UserError when there is neither.
Raster bed_of_run(const std::filesystem::path& run_dir);

}  // namespace frana
