// Releases that lie on the same ground.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scene/nodes_of_place.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

/// All that a [[release]] brings at one time: one, or one for each depth of its features.
struct OfTable {
    const ReleaseSummary* summary = nullptr;
    std::vector<const Release*> parts;
    Vec2 low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
};

void take(const Release& release, const GridGeometry& terrain, OfTable& table) {
    table.parts.push_back(&release);
    if (release.outline) {
        for (const Polygon& polygon : release.outline->parts)
            for (const auto& ring : polygon.rings)
                for (const Vec2& corner : ring)
                    table.low = table.low.cwiseMin(corner), table.high = table.high.cwiseMax(corner);
        return;
    }
    const auto extent = (release.depth_field ? release.depth_field->geometry : terrain).pixel_extent();
    table.low = table.low.cwiseMin(Vec2(extent[0], extent[1]));
    table.high = table.high.cwiseMax(Vec2(extent[2], extent[3]));
}

/// Depths of a [[release]] at points; 0: none there.
std::vector<double> depths_at(const OfTable& table, const GridGeometry& points) {
    std::vector<double> depths(static_cast<std::size_t>(points.size()), 0.0);
    for (const Release* part : table.parts) {
        NodeMarks inside(depths.size(), part->outline ? 0 : 1);
        if (part->outline)
            for (const Polygon& polygon : part->outline->parts) mark_inside(polygon, points, inside);
        for (std::size_t k = 0; k < depths.size(); ++k) {
            if (!inside[k]) continue;
            const auto node = static_cast<Index>(k);
            const double depth =
                part->depth_field ? pixel_at(*part->depth_field, points.x(node % points.nx), points.y(node / points.nx))
                                  : part->depth;
            if (depth > 0.0) depths[k] += depth;
        }
    }
    return depths;
}

/// Points over what two boxes have in common, some to a cell; without any where that is nothing.
GridGeometry points_over(const OfTable& a, const OfTable& b, double cell) {
    constexpr double kPerCell = 4.0, kMost = 500.0;  // along a side
    const Vec2 low = a.low.cwiseMax(b.low), size = a.high.cwiseMin(b.high) - low;
    if (!(size.minCoeff() > 0.0)) return {};
    const double step = std::max(cell / kPerCell, size.maxCoeff() / kMost);
    const auto count = [&](double length) { return static_cast<Index>(std::ceil(length / step)); };
    return {count(size.x()), count(size.y()), low.x() + 0.5 * step, low.y() + 0.5 * step, step};
}

}  // namespace

void remark_on_overlaps(const CaseFile& file, const std::vector<Release>& all,
                        const std::vector<ReleaseSummary>& summaries, Scene& scene) {
    const GridGeometry& terrain = scene.bed.geometry;
    std::map<Index, OfTable> tables;
    for (std::size_t i = 0; i < all.size(); ++i) {
        OfTable& table = tables[summaries[i].table];
        table.summary = &summaries[i];
        take(all[i], terrain, table);
    }
    constexpr int kMostPairs = 200;  // with boxes in common: more would take minutes
    int pairs = 0;
    for (auto b = tables.begin(); b != tables.end(); ++b)
        for (auto a = tables.begin(); a != b; ++a) {
            const ReleaseSummary &one = *a->second.summary, &other = *b->second.summary;
            if (one.at != other.at || one.when_hit != other.when_hit) continue;  // one flows onto where the other was
            const GridGeometry points = points_over(a->second, b->second, terrain.cell);
            if (points.size() == 0) continue;
            if (++pairs > kMostPairs) return;
            const std::vector<double> ones = depths_at(a->second, points), others = depths_at(b->second, points);
            const double pixel = points.cell * points.cell;
            double area = 0.0, volume = 0.0;
            for (std::size_t k = 0; k < ones.size(); ++k)
                if (ones[k] > 0.0 && others[k] > 0.0) area += pixel, volume += pixel * std::min(ones[k], others[k]);
            if (area < terrain.cell * terrain.cell) continue;  // edges that were meant to touch
            scene.log.push_back(fmt::format(
                "{}: found about {:.3g} m2 of it on release.{}; expected releases side by side, since their depths add "
                "up there, to about {:.3g} m3 more than by the deeper one; if that is not meant, cut one of them",
                file.table_place(fmt::format("release.{}", b->first)), area, a->first, volume));
        }
}

}  // namespace frana
