#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "observe/observer.h"
#include "observe/table.h"

namespace frana {

/// A point to watch, and the name of its file.
struct GaugePoint {
    std::string name;
    Vec2 point{0, 0};  ///< map coordinates [m]
};

/// gauges/<name>.csv: the flow at named points after every step; appended at every output. Columns: t [s],
/// bed [m], depth [m], surface [m], speed [m/s], velocity_x [m/s], velocity_y [m/s].
class Gauges : public Observer {
public:
    Gauges(const std::filesystem::path& run_dir, std::vector<GaugePoint> gauges);
    std::string name() const override { return "gauges"; }
    void step(const Status& now, const Probe& probe) override;
    void observe(const Frame&) override;
    bool looks_at_fields() const override { return false; }
    void serialize(Archive& archive) override { serialize_all(archive, tables_); }

private:
    std::vector<GaugePoint> gauges_;
    std::vector<TableWriter> tables_;
};

}  // namespace frana
