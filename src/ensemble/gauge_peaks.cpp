#include "ensemble/gauge_peaks.h"

#include <algorithm>

#include "base/speed_counts.h"

namespace frana {

void GaugePeaks::step(const Status& now, const Probe& probe) {
    for (std::size_t k = 0; k < gauges_.size(); ++k) {
        const Sample flow = probe.at(gauges_[k].point);
        if (speed_counts(flow.depth, footprint_depth_)) fastest_[k] = std::max(fastest_[k], flow.speed);
        GaugePeak& peak = peaks_[k];
        if (flow.depth > footprint_depth_) {
            peak.depth = std::max(peak.depth.value_or(0.0), flow.depth);
            if (!peak.arrival) peak.arrival = now.time;
        }
        if (peak.arrival) peak.speed = fastest_[k];
    }
}

}  // namespace frana
