#include "observe/profiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "terrain/places.h"

namespace frana {
namespace {

const Field& needed(const Frame& frame, const char* name) {
    const Field* field = frame.node(name);
    expect(field != nullptr, "a frame has the node fields elevation, depth and velocity");
    return *field;
}

}  // namespace

std::vector<Corner> corners(const GridGeometry& grid, const Vec2& point) {
    if (!between_nodes(grid, point)) return {};
    const NodeSquare around(grid, point);
    std::vector<Corner> result;
    for (Index k = 0; k < 4; ++k)
        if (const double weight = around.weight(k); weight > 0.0)
            result.push_back({around.node(k).j * grid.nx + around.node(k).i, weight});
    return result;
}

std::vector<Station> stations(const Polyline& line, double spacing) {
    std::vector<Station> result;
    double travelled = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const Vec2 piece = line[k + 1] - line[k];
        const double length = piece.norm();
        if (!(length > 0.0)) continue;
        const auto parts = static_cast<Index>(std::ceil(length / spacing - 1e-9));
        for (Index part = 0; part < parts; ++part) {
            const double share = static_cast<double>(part) / static_cast<double>(parts);
            result.push_back({travelled + share * length, line[k] + share * piece, piece / length});
        }
        travelled += length;
    }
    if (!result.empty()) result.push_back({travelled, line.back(), result.back().along});
    return result;
}

Sample sample(const Frame& frame, const Vec2& point) {
    const Field& elevation = needed(frame, "elevation");
    const Field& depth = needed(frame, "depth");
    const Field& velocity = needed(frame, "velocity");
    Sample result;
    const std::vector<Corner> around = corners(frame.grid, point);
    if (around.empty()) result.elevation = TableWriter::empty;
    Vec2 discharge(0, 0);
    for (const Corner& corner : around) {
        result.elevation += corner.weight * elevation.data[corner.node];
        const double share = corner.weight * depth.data[corner.node];
        if (!(share > 0.0)) continue;
        const double* v = velocity.data + corner.node * velocity.components;
        result.depth += share;
        discharge += share * Vec2(v[0], v[1]);
    }
    if (std::isnan(result.elevation)) return {result.elevation, 0.0, Vec2(0, 0)};
    if (result.depth > 0.0) result.velocity = discharge / result.depth;
    return result;
}

Profiles::Profiles(const std::filesystem::path& run_dir, std::vector<ProfileLine> lines) : lines_(std::move(lines)) {
    const std::vector<std::string> columns = {"t [s]",
                                              "distance [m]",
                                              "x [m]",
                                              "y [m]",
                                              "bed [m]",
                                              "depth [m]",
                                              "surface [m]",
                                              "velocity_along [m/s]",
                                              "velocity_across [m/s]"};
    for (const ProfileLine& line : lines_) tables_.emplace_back(run_dir / "profiles" / (line.name + ".csv"), columns);
}

void Profiles::observe(const Frame& frame) {
    for (std::size_t k = 0; k < lines_.size(); ++k) {
        for (const Station& station : stations(lines_[k].line, 0.5 * frame.grid.cell)) {
            const Sample flow = sample(frame, station.point);
            const Vec2 across(-station.along.y(), station.along.x());
            tables_[k].add({frame.status.time, station.distance, station.point.x(), station.point.y(), flow.elevation,
                            flow.depth, flow.elevation + flow.depth, flow.velocity.dot(station.along),
                            flow.velocity.dot(across)});
        }
        tables_[k].flush();
    }
}

}  // namespace frana
