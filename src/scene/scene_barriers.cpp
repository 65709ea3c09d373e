// [[barrier]] of the case file.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

/// Whether the box around it meets the terrain.
bool meets(const std::vector<Vec2>& points, const std::array<double, 4>& extent) {
    Vec2 low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
    for (const Vec2& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return low.x() <= extent[2] && high.x() >= extent[0] && low.y() <= extent[3] && high.y() >= extent[1];
}

/// A line that a wall can stand along: no turn by more than 120 degrees.
void require_wall(const Polyline& line) {
    constexpr double kSharpest = -0.5;  // cosine
    for (std::size_t k = 1; k + 1 < line.size(); ++k) {
        const Vec2 way = line[k] - line[k - 1], next = line[k + 1] - line[k];
        if (way.dot(next) < kSharpest * way.norm() * next.norm())
            throw UserError(
                fmt::format("found a turn by more than 120 degrees at ({:.10g}, {:.10g}); expected a wall without one; draw "
                            "two walls",
                            line[k].x(), line[k].y()));
    }
}

}  // namespace

std::vector<Barrier> read_barriers(const CaseFile& file, const Raster& bed, const GisReader& reader,
                                   std::vector<std::string>& log, Problems& problems) {
    std::vector<Barrier> barriers;
    const auto extent = bed.geometry.pixel_extent();
    constexpr Index kMost =
        24;  // with the ground and the sides, within the surfaces that points can tell apart
    if (file.count("barrier") > kMost)
        problems.add(file.table_place(fmt::format("barrier.{}", kMost)),
                     fmt::format("found {} barriers", file.count("barrier")),
                     fmt::format("expected {} at most", kMost), "put several polygons into one outline");
    for (Index i = 0; i < file.count("barrier"); ++i) {
        const std::string prefix = fmt::format("barrier.{}.", i);
        const auto given = [&](const char* name) { return file.given(prefix + name); };
        Barrier barrier;
        barrier.name = given("name") ? file.word(prefix + "name") : fmt::format("barrier_{}", i + 1);
        const std::string where = file.place(prefix + (given("line") ? "line" : "outline"));
        std::vector<Vec2> vertices;
        if (given("line")) {
            vertices = barrier.line = file.points(prefix + "line");
            if (!problems.attempt(where, [&] { require_wall(barrier.line); })) continue;
        } else {
            const bool read = problems.attempt(where, [&] {
                barrier.outline = reader.read_polygons(file.path(prefix + "outline"), bed.crs_wkt, log);
            });
            if (!read) continue;
            for (const Polygon& polygon : barrier.outline.parts)
                for (const auto& ring : polygon.rings)
                    vertices.insert(vertices.end(), ring.begin(), ring.end());
        }
        if (!meets(vertices, extent))
            problems.add(where, "found no point of it on the terrain",
                         fmt::format("expected the barrier within x {:.10g} to {:.10g}, y {:.10g} to {:.10g}",
                                     extent[0], extent[2], extent[1], extent[3]),
                         "correct the coordinates or the CRS, or widen terrain.window");
        barrier.wet_left = file.word(prefix + "wet") == "left";
        if (given("thickness")) barrier.thickness = file.number(prefix + "thickness");
        if (given("top")) barrier.top = file.number(prefix + "top");
        if (given("height")) barrier.height = file.number(prefix + "height");
        barrier.friction = file.number(prefix + "friction");
        barrier.stuck = file.flag(prefix + "stuck");
        barriers.push_back(std::move(barrier));
    }
    return barriers;
}

}  // namespace frana
