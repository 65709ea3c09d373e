#include "observe/gauges.h"

#include <utility>

namespace frana {

Gauges::Gauges(const std::filesystem::path& run_dir, std::vector<GaugePoint> gauges) : gauges_(std::move(gauges)) {
    const std::vector<std::string> columns = {"t [s]",       "bed [m]",          "depth [m]",       "surface [m]",
                                              "speed [m/s]", "velocity_x [m/s]", "velocity_y [m/s]"};
    for (const GaugePoint& gauge : gauges_) tables_.emplace_back(run_dir / "gauges" / (gauge.name + ".csv"), columns);
}

void Gauges::step(const Status& now, const Probe& probe) {
    for (std::size_t i = 0; i < gauges_.size(); ++i) {
        const Sample flow = probe.at(gauges_[i].point);
        tables_[i].add({now.time, flow.elevation, flow.depth, flow.elevation + flow.depth, flow.speed,
                        flow.velocity.x(), flow.velocity.y()});
    }
}

void Gauges::observe(const Frame&) {
    for (TableWriter& table : tables_) table.flush();
}

}  // namespace frana
