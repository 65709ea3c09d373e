#include "run/folder/release_results.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/layer_name.h"
#include "compare/outline.h"
#include "io/gdal_reader.h"
#include "scene/case_file.h"

namespace frana {
namespace {

constexpr double kUnknown = Raster::nodata;

/// Of the table of that number; its name begins with "release.1", which no other one's does ("release.10").
const LateEntry* entry_of(const ReleaseSource& source, const std::vector<LateEntry>& late) {
    const std::string name = fmt::format("release.{}", source.table);
    const auto found = std::find_if(late.begin(), late.end(), [&](const LateEntry& entry) {
        return entry.name == name || entry.name.rfind(name + " ", 0) == 0;
    });
    return found == late.end() ? nullptr : &*found;
}

/// Without its holes [m2].
double area_of_part(const Polygon& polygon) {
    Polygons one;
    one.parts = {polygon};
    return area_of(rings_of(one));
}

/// Whether a ray to the east crosses the rings an odd number of times.
bool holds(const Polygon& polygon, const Vec2& point) {
    bool inside = false;
    for (const auto& ring : polygon.rings)
        for (std::size_t k = 0, last = ring.size() - 1; k < ring.size(); last = k++) {
            const Vec2 &a = ring[last], &b = ring[k];
            if ((a.y() > point.y()) == (b.y() > point.y())) continue;
            inside ^= point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        }
    return inside;
}

}  // namespace

std::vector<ReleaseSource> release_sources(const CaseFile& file) {
    std::vector<ReleaseSource> sources;
    for (Index i = 0; i < file.count("release"); ++i) {
        const std::string prefix = fmt::format("release.{}.", i);
        ReleaseSource source;
        source.table = i;
        source.late = file.number(prefix + "at") > 0.0 || file.flag(prefix + "when_hit");
        if (file.given(prefix + "outline")) source.outline = file.path(prefix + "outline").string();
        if (file.given(prefix + "layer")) source.outline += kLayerMark + file.word(prefix + "layer");
        sources.push_back(std::move(source));
    }
    return sources;
}

std::optional<Raster> released_later_on(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late,
                                        const Raster& like) {
    std::optional<Raster> marks;
    const GridGeometry& grid = like.geometry;
    for (const ReleaseSource& source : sources) {
        const LateEntry* const entry = source.late && !source.outline.empty() ? entry_of(source, late) : nullptr;
        if (!entry || !entry->entered) continue;
        if (!marks) marks = Raster::filled(grid, 0.0);
        std::vector<std::string> said_by_the_scene;
        for (const Polygon& part : GdalReader().read_polygons(source.outline, like.crs_wkt, said_by_the_scene).parts)
            for (Index j = 0; j < grid.ny; ++j)
                for (Index i = 0; i < grid.nx; ++i)
                    if (holds(part, {grid.x(i), grid.y(j)})) marks->at(i, j) = 1.0;
    }
    return marks;
}

ShapeLayer release_layer(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late, double at_start,
                         const std::string& crs_wkt) {
    ShapeLayer layer{"release", {}};
    const auto first = std::count_if(sources.begin(), sources.end(), [](const auto& source) { return !source.late; });
    for (const ReleaseSource& source : sources) {
        if (source.outline.empty()) continue;
        double entered = 0.0, volume = first == 1 ? at_start : kUnknown;
        if (source.late) {
            const LateEntry* const entry = entry_of(source, late);
            entered = entry && entry->entered ? *entry->entered : kUnknown;
            volume = entry ? entry->volume : kUnknown;
        }
        std::vector<std::string> said_by_the_scene;
        for (const Polygon& part : GdalReader().read_polygons(source.outline, crs_wkt, said_by_the_scene).parts)
            layer.shapes.push_back({part,
                                    {{"release", static_cast<long long>(source.table)},
                                     {"area_m2", area_of_part(part)},
                                     {"entered_s", entered},
                                     {"volume_m3", volume}}});
    }
    return layer;
}

}  // namespace frana
