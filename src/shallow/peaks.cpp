#include "shallow/peaks.h"

#include <algorithm>

#include "base/simd.h"
#include "base/speed_counts.h"

namespace frana {

namespace {

template <class Real>
struct Contact {
    Real speed, pressure;
};

/// bed_contact of one node or four.
template <class Real>
Contact<Real> contact(const Flow& flow, bool steep, bool curved, Index k, Real vx, Real vy) {
    Real gravity = Real{} + flow.gravity, rise{}, cosine2 = Real{} + 1.0;
    if (steep) {
        Real bx, by;
        unzip(&flow.bed.smooth[k], bx, by);
        rise = vx * bx + vy * by;
        cosine2 = 1.0 / (1.0 + bx * bx + by * by);
        if (curved)
            gravity =
                max(Real{}, flow.gravity + vx * vx * read<Real>(&flow.bed.hxx[k]) +
                                2.0 * vx * vy * read<Real>(&flow.bed.hxy[k]) + vy * vy * read<Real>(&flow.bed.hyy[k]));
    }
    return {sqrt(vx * vx + vy * vy + rise * rise), flow.density * gravity * cosine2 * read<Real>(&flow.nodes.depth[k])};
}

void raise(double* peaks, Double4 values) { store(peaks, max(load(peaks), values)); }

}  // namespace

BedContact bed_contact(const Flow& flow, bool steep, bool curved, Index k, double vx, double vy) {
    const Contact<double> c = contact<double>(flow, steep, curved, k, vx, vy);
    return {c.speed, c.pressure};
}

namespace {

/// Speeds of all nodes near material. Calls of_four(k, depth, contact, speed) for four nodes in a row that have some.
template <class OfFour>
FlowSpeeds speeds_of(Flow& flow, bool steep, bool curved, double footprint_depth, OfFour&& of_four) {
    FlowSpeeds all;
    for_each_work_run(flow.active, [&](const TileRun& run) {
        Double4 most = {};
        Double4 mass[kRunTiles] = {}, motion[kRunTiles] = {};
        for_each_four_of_run(flow.grid, run, flow.active_nodes(), [&](Index n, Index k, Index i, Index j) {
            const Double4 h = load(&flow.nodes.depth[k]), none = {};
            if (!any(h > 0.0)) return;
            Double4 vx, vy;
            unzip(&flow.nodes.before[k], vx, vy);
            const Contact<Double4> c = contact(flow, steep, curved, k, vx, vy);
            const Double4 speed = select(h < kSpeedCounts * footprint_depth, none, c.speed);
            most = max(most, speed);
            const Double4 of_node = flow.share_of_four(i, j) * load(&flow.nodes.mass[k]);
            mass[n] += of_node, motion[n] += of_node * c.speed;
            of_four(k, h, c, speed);
        });
        for (Index n = 0; n < run.count; ++n)
            if (flow.rest.active[run.tile[n]]) flow.speed_sums[run.tile[n]] = {sum(mass[n]), sum(motion[n])};
        const double of_run = largest(most);
#pragma omp critical(frana_fastest_node)
        all.fastest = std::max(all.fastest, of_run);
    });
    double mass = 0.0, motion = 0.0;
    for (const Index tile : flow.active.work) mass += flow.speed_sums[tile].x, motion += flow.speed_sums[tile].y;
    if (mass > 0.0) all.mean = motion / mass;
    return all;
}

}  // namespace

FlowSpeeds update_peaks(Flow& flow, bool steep, bool curved, double time, double footprint_depth, Peaks& peaks) {
    return speeds_of(flow, steep, curved, footprint_depth,
                     [&](Index k, Double4 h, const Contact<Double4>& c, Double4 speed) {
                         if (any((h > footprint_depth) & (load(&peaks.depth[k]) <= footprint_depth)))
                             for (Index m = k; m < k + 4; ++m)
                                 if (flow.nodes.depth[m] > footprint_depth && !(peaks.depth[m] > footprint_depth) &&
                                     !(peaks.arrival[m] > 0.0))  // not buried before by what thinner flows left
                                     peaks.arrival[m] = time;
                         raise(&peaks.depth[k], h);
                         raise(&peaks.pressure[k], c.pressure);
                         raise(&peaks.speed[k], speed);
                         raise(&peaks.dynamic_pressure[k], flow.density * speed * speed);
                     });
}

FlowSpeeds speeds_of_nodes(Flow& flow, bool steep, bool curved, double footprint_depth) {
    return speeds_of(flow, steep, curved, footprint_depth, [](Index, Double4, const Contact<Double4>&, Double4) {});
}

}  // namespace frana
