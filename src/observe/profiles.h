#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "observe/observer.h"
#include "observe/table.h"

namespace frana {

/// A line to watch, and the name of its file.
struct ProfileLine {
    std::string name;
    Polyline line;  ///< map coordinates [m], two points or more
};

/// A point of a profile.
struct Station {
    double distance = 0.0;  ///< along the line [m]
    Vec2 point{0, 0};       ///< map coordinates [m]
    Vec2 along{1, 0};       ///< unit direction of the line; "across" is to its left
};

/// Stations on a polyline: both ends of every straight piece, and between them at equal distances of at most
/// `spacing` [m]. A corner belongs to the piece that begins there. Pieces without length are passed over.
std::vector<Station> stations(const Polyline& line, double spacing);

/// A node near a point, and its bilinear weight.
struct Corner {
    Index node = 0;
    double weight = 0.0;
};

/// The nodes around a point that have weight; empty when the point lies outside the rectangle of nodes.
std::vector<Corner> corners(const GridGeometry& grid, const Vec2& point);

/// Bilinear between the nodes of a frame. Velocity is weighted by depth, so that a dry node at the flow's margin does
/// not slow it down. Outside the grid, or next to a node without bed: elevation NaN, depth zero.
Sample sample(const Frame& frame, const Vec2& point);

/// profiles/<name>.csv: at every output the flow along named lines, stations half a cell apart. Columns: t
/// [s], distance [m], x [m], y [m], bed [m], depth [m], surface [m], velocity_along [m/s], velocity_across
/// [m/s].
class Profiles : public Observer {
public:
    Profiles(const std::filesystem::path& run_dir, std::vector<ProfileLine> lines);
    std::string name() const override { return "profiles"; }
    void observe(const Frame& frame) override;
    void serialize(Archive& archive) override { serialize_all(archive, tables_); }

private:
    std::vector<ProfileLine> lines_;
    std::vector<TableWriter> tables_;
};

}  // namespace frana
