#pragma once
#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "observe/observer.h"
#include "observe/table.h"

namespace frana {

/// A line that material passes, and the name of its file.
struct SectionLine {
    std::string name;
    Polyline line;         ///< map coordinates [m], two points or more
    bool to_right = true;  ///< what goes from its left to its right counts as positive; otherwise the other way
    /// The terrain: least x and y, largest x and y [m]. Beyond it the line has no flow.
    std::array<double, 4> terrain{-kFar, -kFar, kFar, kFar};
    bool covers(const Vec2& place) const {
        return place.x() >= terrain[0] && place.y() >= terrain[1] && place.x() <= terrain[2] && place.y() <= terrain[3];
    }
    double solid_share = 1.0;  ///< of the volume that passes: grains in a material whose law has their share [1]
    static constexpr double kFar = std::numeric_limits<double>::infinity();
};

/// What passed a section in a run.
struct SectionSummary {
    std::string name;
    Vec2 towards{1, 0};                  ///< unit vector: the positive sense
    double volume = 0.0;                 ///< net, counted by particles that passed [m3]
    double sediment = 0.0;               ///< of it, solid [m3]
    double integral = 0.0;               ///< of the discharge over time [m3]
    double peak = 0.0, peak_time = 0.0;  ///< largest discharge, in the positive sense [m3/s]; [s]
};

/// Depth times the velocity across, integrated along a line by the middles of pieces of `spacing` [m] at most [m3/s].
double discharge_through(const SectionLine& section, double spacing, const Probe& probe);

/// sections/<name>.csv: what passes named lines, after every step; appended at every output. Columns: t [s], discharge
/// [m3/s] (of the nodes at that time), volume [m3] (net since the start), sediment [m3] (the solid part of that volume).
/// The volume counts particles with the mass that each has as it passes, exactly. So flow that takes up its bed on the
/// way passes with it, and what becomes bed before a line does not. Flow and bed beyond a line together gain the volume,
/// but for bed on the line itself. Nodes on one side of it exchange mass with particles on the other, a cell or two away.
class Sections final : public Observer {
public:
    Sections(const std::filesystem::path& run_dir, std::vector<SectionLine> lines, double spacing,
             std::vector<SectionSummary>& summaries);
    std::string name() const override { return "sections"; }
    void step(const Status& now, const Probe& probe) override;
    void observe(const Frame&) override;
    bool looks_at_fields() const override { return false; }
    void serialize(Archive& archive) override;

private:
    std::vector<SectionLine> lines_;
    double spacing_;  ///< [m]
    std::vector<SectionSummary>& summaries_;
    std::vector<TableWriter> tables_;
    double time_ = 0.0;
    std::vector<double> discharge_;  ///< at `time_` [m3/s]
};

}  // namespace frana
