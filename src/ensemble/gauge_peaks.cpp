#include "ensemble/gauge_peaks.h"

#include <algorithm>

namespace frana {

void GaugePeaks::step(const Status& now, const Probe& probe) {
    for (std::size_t k = 0; k < gauges_.size(); ++k) {
        const Sample flow = probe.at(gauges_[k].point);
        if (!(flow.depth > footprint_depth_)) continue;
        GaugePeak& peak = peaks_[k];
        peak.depth = std::max(peak.depth.value_or(0.0), flow.depth);
        peak.speed = std::max(peak.speed.value_or(0.0), flow.speed);
        if (!peak.arrival) peak.arrival = now.time;
    }
}

}  // namespace frana
