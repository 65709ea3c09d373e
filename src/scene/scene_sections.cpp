// [[section]] of the case file, and lines as keys give them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/scene_parts.h"
#include "terrain/places.h"

namespace frana {

Polyline read_line(const CaseFile& file, const std::string& key, const GisReader& reader, const std::string& crs_wkt,
                   std::vector<std::string>& log) {
    Polyline line = file.is_text(key) ? reader.read_line(file.path(key), crs_wkt, log) : file.points(key);
    line.erase(std::unique(line.begin(), line.end()), line.end());
    if (line.size() < 2)
        throw UserError("found a line of one point; expected two that are apart; draw it from one bank to the other");
    return line;
}

double rise_across(const Polyline& line, const Raster& bed) {
    const GridGeometry& g = bed.geometry;
    double sum = 0.0, length = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const Vec2 piece = line[k + 1] - line[k], right(piece.y(), -piece.x());
        const auto parts = static_cast<Index>(std::ceil(2.0 * piece.norm() / g.cell));
        for (Index part = 0; part < parts; ++part) {
            const double share = (static_cast<double>(part) + 0.5) / static_cast<double>(parts);
            const Vec2 at = line[k] + share * piece;
            const NodeAt node = nearest_node(g, at);
            if (!has_node(g, node) || std::isnan(bed.at(node.i, node.j))) continue;
            sum += node_gradient(bed, node.i, node.j).dot(right) / static_cast<double>(parts);
            length += piece.norm() / static_cast<double>(parts);
        }
    }
    return length > 0.0 ? sum / length : 0.0;
}

/// The piece of each segment that lies between two bounds, axis by axis (Liang & Barsky 1984).
bool comes_onto(const Polyline& line, const std::array<double, 4>& extent) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        double from = 0.0, to = 1.0;
        for (int axis = 0; axis < 2; ++axis) {
            const double start = line[k][axis], way = line[k + 1][axis] - start;
            const double low = extent[static_cast<std::size_t>(axis)] - start,
                         high = extent[static_cast<std::size_t>(axis) + 2] - start;
            if (way == 0.0) {
                if (low > 0.0 || high < 0.0) to = -1.0;
                continue;
            }
            from = std::max(from, std::min(low / way, high / way));
            to = std::min(to, std::max(low / way, high / way));
        }
        if (from <= to) return true;
    }
    return false;
}

std::vector<Section> read_sections(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    std::vector<Section> sections;
    const auto e = (scene.wider ? scene.wider->grid : scene.bed.geometry).pixel_extent();
    for (Index i = 0; i < file.count("section"); ++i) {
        const std::string prefix = fmt::format("section.{}.", i);
        Polyline line;
        const bool read = problems.attempt(file.place(prefix + "line"), [&] {
            line = read_line(file, prefix + "line", reader, scene.bed.crs_wkt, scene.log);
        });
        if (!read) continue;
        const auto inside = [&](const Vec2& point) {
            return point.x() >= e[0] && point.x() <= e[2] && point.y() >= e[1] && point.y() <= e[3];
        };
        const bool there = comes_onto(line, e);
        if (!there)
            problems.add(
                file.place(prefix + "line"), "found no point of it on the terrain",
                fmt::format("expected it within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}", e[0], e[2], e[1], e[3]),
                "correct the coordinates, or widen terrain.window");
        if (there && !std::all_of(line.begin(), line.end(), inside))
            scene.log.push_back(fmt::format(
                "section {}: found corners of its line beyond the terrain; expected all of it there; nothing "
                "is counted beyond",
                file.word(prefix + "name")));
        sections.push_back({file.word(prefix + "name"), line, rise_across(line, scene.bed) <= 0.0});
    }
    return sections;
}

}  // namespace frana
