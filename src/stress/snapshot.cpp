#include "stress/snapshot.h"

#include <algorithm>
#include <cmath>

namespace frana::stress {

Snapshot snapshot_of(DepthAveraged& simulation, bool steep) {
    Snapshot shot;
    shot.between = simulation.status();
    const Frame frame = simulation.frame();
    shot.now = frame.status;
    const Flow& flow = simulation.flow();
    shot.points = flow.columns;
    const Field& speed = *frame.particle("speed");  // a number that is none stays the largest
    for (Index p = 0; p < speed.count; ++p)
        if (!(speed.data[p] <= shot.max_speed)) shot.max_speed = speed.data[p];
    for (const Index tile : flow.active.work)
        for_each_node_of(flow.grid, tile, [&](Index k, Index i, Index j) {
            if (i < 0 || j < 0 || i >= flow.grid.nx() || j >= flow.grid.ny()) return;
            if (!flow.touches(i, j)) return;  // holds what an earlier step left, which no pass reads
            const Motion& motion = flow.nodes.motions()[k];
            const double vz = steep ? motion.vx * flow.bed.slope_x[k] + motion.vy * flow.bed.slope_y[k] : 0.0;
            const double along = std::sqrt(motion.vx * motion.vx + motion.vy * motion.vy + vz * vz);
            const bool wet = flow.nodes.flags[k] & kWet;
            if (!wet && flow.nodes.depth[k] == 0.0 && along == 0.0) return;
            shot.nodes.push_back({i, j, wet, flow.nodes.depth[k], flow.bed.z[k], flow.bed.z[k] + flow.nodes.depth[k],
                                  motion.vx, motion.vy, along});
        });
    return shot;
}

}  // namespace frana::stress
