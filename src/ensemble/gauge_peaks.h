#pragma once
// What an ensemble stores of a run at the gauges of its case.
#include <optional>
#include <vector>

#include "observe/observer.h"
#include "scene/scene.h"

namespace frana {

/// The largest of a gauge, where the flow came deeper than the footprint depth; nothing where it never did.
struct GaugePeak {
    std::optional<double> depth;    ///< [m]
    std::optional<double> speed;    ///< along the bed, where speed_counts(), as in the gauges' table of a run [m/s]
    std::optional<double> arrival;  ///< the first time of it [s]
};

/// Samples the gauges after every step.
class GaugePeaks : public Observer {
public:
    GaugePeaks(const std::vector<Gauge>& gauges, double footprint_depth)
        : gauges_(gauges), footprint_depth_(footprint_depth), peaks_(gauges.size()), fastest_(gauges.size(), 0.0) {}
    std::string name() const override { return "gauges"; }
    bool looks_at_fields() const override { return false; }
    void step(const Status& now, const Probe& probe) override;
    /// In the order of the case.
    const std::vector<GaugePeak>& peaks() const { return peaks_; }

private:
    const std::vector<Gauge>& gauges_;
    double footprint_depth_;
    std::vector<GaugePeak> peaks_;
    std::vector<double> fastest_;  ///< also before the flow is deep enough to have come [m/s]
};

}  // namespace frana
