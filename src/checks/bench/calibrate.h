#pragma once
// What the machine can do, measured in the process that is then compared with it.
#include <map>

#include "base/types.h"

namespace frana::bench {

struct Calibration {
    std::map<int, double> triad_GBps;       ///< by threads, from CPU time (checks/bench/team_clock.h)
    std::map<int, double> triad_wall_GBps;  ///< the same from wall time
    Index array_bytes = 0;                  ///< of each of the three arrays
    double node_touch_ns = 0.0;             ///< CPU time per particle, one thread
    double node_touch_wall_ns = 0.0;
};

/// What is calibrated, and how long.
struct CalibrationPlan {
    std::vector<int> threads{1};
    Index array_bytes = 0;     ///< 0: four times the last-level cache, at most 512 MB or a twelfth of the free memory
    Index particles = 500000;  ///< of the node-touch measurement
    int rounds = 20;           ///< the least time of these counts
};

/// STREAM triad a = b + s c (McCalpin 1995; 24 bytes an element), and node-touch. In node-touch particles are sorted by
/// tile, four a cell. Each adds to nine nodes of four doubles and reads nine of another array; no shape functions, no
/// physics.
Calibration calibrate(const CalibrationPlan& plan);

}  // namespace frana::bench
