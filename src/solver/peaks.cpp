#include "solver/peaks.h"

#include <algorithm>

namespace frana {

BedContact bed_contact(const Flow& flow, bool steep, bool curved, Index k, double vx, double vy) {
    double gravity = flow.gravity, rise = 0.0, cosine2 = 1.0;
    if (steep) {
        const double bx = flow.bed.slope_x[k], by = flow.bed.slope_y[k];
        rise = vx * bx + vy * by;
        cosine2 = 1.0 / (1.0 + bx * bx + by * by);
        if (curved)
            gravity = std::max(0.0, gravity + vx * vx * flow.bed.hxx[k] + 2.0 * vx * vy * flow.bed.hxy[k] +
                                        vy * vy * flow.bed.hyy[k]);
    }
    return {std::sqrt(vx * vx + vy * vy + rise * rise), flow.density * gravity * cosine2 * flow.nodes.depth[k]};
}

void update_peaks(const Flow& flow, bool steep, bool curved, double time, double footprint_depth, Peaks& peaks) {
    for_each_work_tile(flow.active, [&](Index, Index tile) {
        for_each_node_of(flow.grid, tile, [&](Index k, Index, Index) {
            const double h = flow.nodes.depth[k];
            if (h <= 0.0) return;
            if (h > footprint_depth && !(peaks.depth[k] > footprint_depth)) peaks.arrival[k] = time;
            peaks.depth[k] = std::max(peaks.depth[k], h);
            const Pair v = flow.nodes.before[k];
            const BedContact contact = bed_contact(flow, steep, curved, k, v.x, v.y);
            peaks.pressure[k] = std::max(peaks.pressure[k], contact.pressure);
            if (h < 0.1 * footprint_depth) return;
            peaks.speed[k] = std::max(peaks.speed[k], contact.speed);
            peaks.dynamic_pressure[k] =
                std::max(peaks.dynamic_pressure[k], flow.density * contact.speed * contact.speed);
        });
    });
}

}  // namespace frana
