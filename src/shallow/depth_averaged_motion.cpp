// What of the particles moves, for the rule of rest. Sampled rarely, and by one thread: sums have one order.
#include "shallow/depth_averaged.h"

namespace frana {
namespace {

template <class Real>
double mass_faster_than(const Particles& particles, const Carried<Real>& held, double speed) {
    double mass = 0.0;
    for (std::size_t p = 0; p < particles.mass.size(); ++p)
        if (std::hypot(double{held.vx[p]}, double{held.vy[p]}) > speed) mass += particles.mass[p];
    return mass;
}

}  // namespace

MovingMass DepthAveraged::motion(const MotionQuery& query) const {
    const double became_bed = std::max(0.0, status_.bed.deposited - status_.bed.eroded);  // is at rest
    MovingMass motion{status_.mass + became_bed, 0.0, status_.max_speed_on_map, 0};
    motion.moving = flow_.particles.with_real([&](auto real) {
        return mass_faster_than(flow_.particles, flow_.particles.carried<decltype(real)>(), query.faster_than);
    });
    for (const Index tile : flow_.active.work)
        for_each_node_of(flow_.grid, tile, flow_.in_reach[tile], [&](Index k, Index, Index) {
            if (!(peaks_.depth[k] > footprint_depth_) || peaks_.arrival[k] < query.since) return;
            motion.fronts += std::hypot(flow_.nodes.before[k].x, flow_.nodes.before[k].y) > query.faster_than;
        });
    return motion;
}

}  // namespace frana
