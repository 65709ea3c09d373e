#pragma once
// All that the invariants look at, copied out of a simulation after a step: plain data, which a test can falsify.
#include <vector>

#include "solver/depth_averaged.h"

namespace frana::stress {

/// A node of the domain near material.
struct NodeState {
    Index i = 0, j = 0;
    bool wet = false;
    double depth = 0.0, bed = 0.0, surface = 0.0;  ///< [m]
    double vx = 0.0, vy = 0.0, speed = 0.0;        ///< along the map, and along the bed on steep terrain [m/s]
};

struct Snapshot {
    Status between;   ///< as it stands between frames: momentum and impulse half a step behind
    Status now;       ///< as in a frame: all at its time
    Columns points;
    double max_speed = 0.0;  ///< of points at `now`, along the bed on steep terrain [m/s]
    std::vector<NodeState> nodes;
};

/// The present state. Looking does not change the run (tests/conserve_runs.cpp).
Snapshot snapshot_of(DepthAveraged& simulation, bool steep);

}  // namespace frana::stress
