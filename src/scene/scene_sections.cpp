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

namespace {

/// The share of a segment that lies between two bounds, axis by axis (Liang & Barsky 1984); below 0: none.
double share_within(const Vec2& begin, const Vec2& end, const std::array<double, 4>& extent) {
    double from = 0.0, to = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double start = begin[axis], way = end[axis] - start;
        const double low = extent[static_cast<std::size_t>(axis)] - start,
                     high = extent[static_cast<std::size_t>(axis) + 2] - start;
        if (way == 0.0) {
            if (low > 0.0 || high < 0.0) return -1.0;
            continue;
        }
        from = std::max(from, std::min(low / way, high / way));
        to = std::min(to, std::max(low / way, high / way));
    }
    return from <= to ? to - from : -1.0;
}

double length_within(const Polyline& line, const std::array<double, 4>& extent) {
    double length = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
        length += std::max(0.0, share_within(line[k], line[k + 1], extent)) * (line[k + 1] - line[k]).norm();
    return length;
}

/// How far a line goes along one edge of the terrain within so many cells of the outermost nodes [m]. One that ends at
/// the edge goes across it.
double length_along_edge(const Polyline& line, const GridGeometry& grid, double cells) {
    const std::array<double, 4> all = grid.pixel_extent();
    double most = 0.0;
    for (std::size_t side = 0; side < 4; ++side) {
        double length = 0.0;
        std::array<double, 4> strip = all;
        strip[(side + 2) % 4] = all[side] + (side < 2 ? 1.0 : -1.0) * (cells + 0.5) * grid.cell;
        for (std::size_t k = 0; k + 1 < line.size(); ++k) {
            const double along = std::abs((line[k + 1] - line[k])[side % 2 == 0 ? 1 : 0]);
            length += std::max(0.0, share_within(line[k], line[k + 1], strip)) * along;
        }
        most = std::max(most, length);
    }
    return most;
}

/// What leaves is taken away beyond the outermost nodes, wherever within the half cell that is. A line that ends at the
/// terrain's edge has some of it at either end. Within a cell or two of those nodes the flow has already what leaves it.
void remark_on_edge(const std::string& name, const Polyline& line, const GridGeometry& grid,
                    std::vector<std::string>& log) {
    const double at_edge =
        length_within(line, grid.pixel_extent()) - length_within(line, {grid.x0, grid.y0, grid.x_max(), grid.y_max()});
    if (at_edge <= 2.0 * grid.cell) {
        constexpr double kNear = 2.0;  // [cells]
        const double along = length_along_edge(line, grid, kNear), all = length_within(line, grid.pixel_extent());
        if (along > std::min(4.0 * (kNear + 0.5) * grid.cell, 0.5 * all))
            log.push_back(fmt::format(
                "section {}: found {:.4g} m of its line within two cells of the outermost nodes of an open "
                "terrain; expected it farther in; what leaves the terrain there counts in part; draw it {:g} "
                "m or more from its edge",
                name, along, (kNear + 0.5) * grid.cell));
        return;
    }
    log.push_back(
        fmt::format("section {}: found {:.4g} m of its line beyond the outermost nodes, within half a cell of the "
                    "terrain's edge; expected it among them; what leaves the terrain there counts in part; draw it a "
                    "cell or more farther in",
                    name, at_edge));
}

double distance(const Vec2& point, const Vec2& a, const Vec2& b) {
    const Vec2 side = b - a;
    const double share = std::clamp((point - a).dot(side) / std::max(side.squaredNorm(), 1e-300), 0.0, 1.0);
    return (point - a - share * side).norm();
}

/// 0 where they cross [m].
double distance(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
    const auto side = [](const Vec2& from, const Vec2& to, const Vec2& of) {
        return (to - from).x() * (of - from).y() - (to - from).y() * (of - from).x();
    };
    if (side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0) return 0.0;
    return std::min({distance(a, c, d), distance(b, c, d), distance(c, a, b), distance(d, a, b)});
}

/// From where an inflow comes in [m].
double distance(const Polyline& line, const Inflow& inflow) {
    double least = INFINITY;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        for (const Inflow::Patch& patch : inflow.patches)
            least = std::min(least, distance(patch.at, line[k], line[k + 1]));
        for (std::size_t n = 0; n + 1 < inflow.line.size(); ++n)
            least = std::min(least, distance(line[k], line[k + 1], inflow.line[n], inflow.line[n + 1]));
    }
    return least;
}

}  // namespace

void remark_on_sections_at_inflows(Scene& scene) {
    constexpr double kNear = 3.0;  // [cells]; rows of particles are born over the first of them
    for (const Section& section : scene.sections)
        for (const Inflow& inflow : scene.inflows) {
            const double far = distance(section.line, inflow), near = kNear * scene.bed.geometry.cell;
            if (far < near)
                scene.log.push_back(fmt::format(
                    "section {}: found it {:.3g} m from inflow {}; expected {:g} m or more, three cells; what comes in "
                    "beyond it does not pass it, so that its discharge may be too low; draw it farther away",
                    section.name, far, inflow.name, near));
        }
}

bool comes_onto(const Polyline& line, const std::array<double, 4>& extent) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
        if (share_within(line[k], line[k + 1], extent) >= 0.0) return true;
    return false;
}

std::vector<Section> read_sections(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    std::vector<Section> sections;
    const GridGeometry& whole = scene.wider ? scene.wider->grid : scene.bed.geometry;
    const auto e = whole.pixel_extent();
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
        if (file.word("boundary.sides") == "open") remark_on_edge(file.word(prefix + "name"), line, whole, scene.log);
        sections.push_back({file.word(prefix + "name"), line, rise_across(line, scene.bed) <= 0.0});
    }
    return sections;
}

}  // namespace frana
