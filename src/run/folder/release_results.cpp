#include "run/folder/release_results.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/layer_name.h"
#include "compare/outline.h"
#include "compare/union_area.h"
#include "io/gdal_reader.h"
#include "scene/case_file.h"
#include "scene/nodes_of_place.h"

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
        if (file.given(prefix + "layer")) source.outline = with_layer(source.outline, file.word(prefix + "layer"));
        const bool by_depth = file.given(prefix + "depth") && file.is_text(prefix + "depth");
        if (file.given(prefix + "mask"))
            source.mask = file.path(prefix + "mask").string();
        else if (source.outline.empty() && by_depth)
            source.mask = file.path(prefix + "depth").string();
        sources.push_back(std::move(source));
    }
    return sources;
}

namespace {

void mark_outline(const std::string& outline, const std::string& crs_wkt, Raster& marks) {
    const GridGeometry& grid = marks.geometry;
    std::vector<std::string> said_by_the_scene;
    for (const Polygon& part : GdalReader().read_polygons(outline, crs_wkt, said_by_the_scene).parts)
        for (Index j = 0; j < grid.ny; ++j)
            for (Index i = 0; i < grid.nx; ++i)
                if (holds(part, {grid.x(i), grid.y(j)})) marks.at(i, j) = 1.0;
}

/// Where the pixel of the mask that holds a middle is above 0.
void mark_mask(const std::string& file, const std::string& crs_wkt, Raster& marks) {
    const GridGeometry& grid = marks.geometry;
    const double half = 0.5 * grid.cell;
    std::vector<std::string> said_by_the_scene;
    const Raster mask = GdalReader().read_mask(
        file, {grid.x(0) - half, grid.y(0) - half, grid.x(grid.nx - 1) + half, grid.y(grid.ny - 1) + half}, crs_wkt,
        said_by_the_scene);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            if (pixel_at(mask, grid.x(i), grid.y(j)) > 0.0) marks.at(i, j) = 1.0;
}

template <class Counts>
std::optional<Raster> marks_of(const std::vector<ReleaseSource>& sources, const Raster& like, const Counts& counts) {
    std::optional<Raster> marks;
    for (const ReleaseSource& source : sources) {
        if (!source.has_shape() || !counts(source)) continue;
        if (!marks) marks = Raster::filled(like.geometry, 0.0);
        if (source.mask.empty())
            mark_outline(source.outline, like.crs_wkt, *marks);
        else
            mark_mask(source.mask, like.crs_wkt, *marks);
    }
    return marks;
}

}  // namespace

std::optional<Raster> released_later_on(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late,
                                        const Raster& like) {
    return marks_of(sources, like, [&](const ReleaseSource& source) {
        const LateEntry* const entry = source.late ? entry_of(source, late) : nullptr;
        return entry && entry->entered;
    });
}

std::optional<Raster> may_be_released_later_on(const std::vector<ReleaseSource>& sources, const Raster& like) {
    return marks_of(sources, like, [](const ReleaseSource& source) { return source.late; });
}

std::optional<Raster> released_at_start(const std::vector<ReleaseSource>& sources, const Raster& like) {
    return marks_of(sources, like, [](const ReleaseSource& source) { return !source.late; });
}

namespace {

struct ReleasePlan {
    Polygons parts;
    double area = 0.0;  ///< overlaps counted once [m2]
};

ReleasePlan plan_of_outline(const std::string& outline, const std::string& crs_wkt) {
    std::vector<std::string> said_by_the_scene;
    ReleasePlan plan{GdalReader().read_polygons(outline, crs_wkt, said_by_the_scene), 0.0};
    plan.area = union_area(rings_of(plan.parts));
    return plan;
}

/// The pixels above 0.
ReleasePlan plan_of_mask(const std::string& file, const std::array<double, 4>& extent, const std::string& crs_wkt) {
    std::vector<std::string> said_by_the_scene;
    const Raster mask = GdalReader().read_mask(file, extent, crs_wkt, said_by_the_scene);
    std::vector<std::uint8_t> marks(mask.values.size());
    for (std::size_t k = 0; k < marks.size(); ++k) marks[k] = mask.values[k] > 0.0 ? 1 : 0;
    const auto count = std::count(marks.begin(), marks.end(), 1);
    ReleasePlan plan{{}, static_cast<double>(count) * mask.geometry.cell * mask.geometry.cell};
    const auto outlines = pixel_outlines(mask.geometry, std::move(marks));
    for (const AttributedShape& outline : outlines) plan.parts.parts.push_back(std::get<Polygon>(outline.shape));
    return plan;
}

}  // namespace

ShapeLayer release_layer(const std::vector<ReleaseSource>& sources, const std::vector<LateEntry>& late, double at_start,
                         const std::array<double, 4>& extent, const std::string& crs_wkt) {
    ShapeLayer layer{"release", {}};
    const auto first = std::count_if(sources.begin(), sources.end(), [](const auto& source) { return !source.late; });
    for (const ReleaseSource& source : sources) {
        if (!source.has_shape()) continue;
        double entered = 0.0, volume = first == 1 ? at_start : kUnknown;
        if (source.late) {
            const LateEntry* const entry = entry_of(source, late);
            entered = entry && entry->entered ? *entry->entered : kUnknown;
            volume = entry ? entry->volume : kUnknown;
        }
        ReleasePlan plan = source.outline.empty() ? plan_of_mask(source.mask, extent, crs_wkt)
                                                  : plan_of_outline(source.outline, crs_wkt);
        if (plan.parts.parts.empty()) continue;  // the file is another one by now
        AttributedShape shape{plan.parts.parts.front(),
                              {{"release", static_cast<long long>(source.table)},
                               {"area_m2", plan.area},
                               {"entered_s", entered},
                               {"volume_m3", volume}}};
        if (plan.parts.parts.size() > 1) shape.shape = std::move(plan.parts);  // one row: the volume is that of all
        layer.shapes.push_back(std::move(shape));
    }
    return layer;
}

}  // namespace frana
