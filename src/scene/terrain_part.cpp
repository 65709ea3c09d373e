#include "scene/terrain_part.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/layer_name.h"
#include "scene/bed_smoothing.h"
#include "scene/combinations.h"
#include "scene/ground_fields.h"
#include "scene/scene_parts.h"
#include "terrain/part_of.h"

namespace frana {
namespace {

void take_corners(const Polygons& polygons, std::vector<Vec2>& points) {
    for (const Polygon& polygon : polygons.parts)
        for (const auto& ring : polygon.rings) points.insert(points.end(), ring.begin(), ring.end());
}

bool in_3d(const CaseFile& file, Index stage) { return file.word(fmt::format("stage.{}.model", stage)) == "mpm3d"; }

/// Particles alone can go on on a larger part.
bool may_begin_with_part(const CaseFile& file, const Scene& scene) {
    if (scene.output.whole_terrain || are_closed(scene.sides)) return false;
    if (file.count("insitu") > 0) return false;
    for (Index i = 0; i < file.count("stage"); ++i)
        if (in_3d(file, i) && !file.given(fmt::format("stage.{}.window", i))) return false;  // it is all of the terrain
    for (Index i = 0; i < file.count("barrier"); ++i)
        if (file.given(fmt::format("barrier.{}.mesh", i))) return false;  // its place is known once it is read
    if (friction_by_table(file)) return false;  // its classes follow from terrain around a node
    if (friction_differs(file) && file.word("deposition.law") != "none") return false;  // if any node holds, all may
    if (file.word("material.structure.law") != "none" || file.word("water.model") != "none") return false;
    return true;
}

/// Where a release may have material: its outline, or the pixels above 0 of its mask or depth. False where neither tells.
bool take_release(const CaseFile& file, Index i, const GisReader& reader, const Raster& whole,
                  std::vector<Vec2>& points) {
    const std::string table = fmt::format("release.{}.", i);
    if (file.given(table + "outline")) {
        std::vector<std::string> said_later;
        std::string name = file.path(table + "outline").string();
        if (file.given(table + "layer")) name = with_layer(name, file.word(table + "layer"));
        take_corners(reader.read_polygons(name, whole.crs_wkt, said_later), points);
        return true;
    }
    const std::string field = table + (file.given(table + "mask") ? "mask" : "depth");
    if (!file.given(field) || !file.is_text(field)) return false;
    const auto box = reader.extent_above_zero(file.path(field), whole.geometry.pixel_extent(), whole.crs_wkt);
    if (!box) return false;
    points.emplace_back((*box)[0], (*box)[1]);
    points.emplace_back((*box)[2], (*box)[3]);
    return true;
}

/// Rasters that vary spatially besides the elevations can be read again later, with the same values at a node.
bool fields_may_follow(const CaseFile& file, const GisReader& reader, const Raster& whole) {
    if (!has_fields(file)) return true;
    if (!reader.lasting()) return false;
    const auto hangs_on_part = [&](const std::string& key) {
        return file.given(key) && file.is_text(key) &&
               reader.place_of(file.path(key), whole.geometry.pixel_extent(), whole.crs_wkt).needs_warp;
    };
    std::vector<std::string> keys{"erodible.depth", "forest.detrainment"};
    for (const std::string& key : rasters_of_laws(file)) keys.push_back(key);
    return std::none_of(keys.begin(), keys.end(), hangs_on_part);
}

/// Of all tables of a name.
void take_lines(const CaseFile& file, const std::string& table, const GisReader& reader, const Raster& whole,
                std::vector<Vec2>& points) {
    std::vector<std::string> said_later;
    for (Index i = 0; i < file.count(table); ++i) {
        const Polyline line = read_line(file, fmt::format("{}.{}.line", table, i), reader, whole.crs_wkt, said_later);
        points.insert(points.end(), line.begin(), line.end());
    }
}

/// Of lines and areas.
void take_inflows(const CaseFile& file, const GisReader& reader, const Raster& whole, std::vector<Vec2>& points) {
    std::vector<std::string> said_later;
    for (Index i = 0; i < file.count("inflow"); ++i) {
        const std::string area = fmt::format("inflow.{}.area", i);
        if (file.given(area) && file.is_text(area)) {
            take_corners(reader.read_polygons(file.path(area), whole.crs_wkt, said_later), points);
            continue;
        }
        const Polyline line =
            file.given(area) ? file.points(area)
                             : read_line(file, fmt::format("inflow.{}.line", i), reader, whole.crs_wkt, said_later);
        points.insert(points.end(), line.begin(), line.end());
    }
}

/// None where some of it may be anywhere.
std::vector<Vec2> corners_of_material(const CaseFile& file, const GisReader& reader, const Raster& whole) {
    std::vector<Vec2> points;
    for (Index i = 0; i < file.count("release"); ++i)
        if (!take_release(file, i, reader, whole, points)) return {};
    take_inflows(file, reader, whole, points);
    for (Index i = 0; i < file.count("stage"); ++i) {
        if (!in_3d(file, i)) continue;
        const auto& window = file.numbers(fmt::format("stage.{}.window", i));  // its points leave it as particles
        points.emplace_back(window[0], window[1]), points.emplace_back(window[2], window[3]);
    }
    return points;
}

/// Around barriers that stand on the terrain, a cell beyond their sides. Files of a whole valley have more beyond it.
void take_corners_of_barriers(const CaseFile& file, const GisReader& reader, const Raster& whole,
                              std::vector<Vec2>& points) {
    std::vector<std::string> said_later;
    for (Index i = 0; i < file.count("barrier"); ++i) {
        const std::string table = fmt::format("barrier.{}.", i);
        const double cell = whole.geometry.cell, least = 1.5 * cell,  // of a wall askew to the cells: sqrt(2) of them
            given = file.given(table + "thickness") ? file.number(table + "thickness") : 0.0;
        const auto take = [&](const std::vector<Vec2>& corners) {
            // The outer corner of a wall that turns as sharply as it may, by 120 degrees, is two thicknesses away.
            const double beyond = 2.0 * std::max(given, least) + cell;
            const NodeBox met = common(cells_of(corners, whole.geometry), NodeBox::all(whole.geometry));
            if (met.nx == 0 || met.ny == 0) return;
            for (const Vec2& corner : corners)
                for (const double side : {-beyond, beyond}) points.push_back(corner + Vec2(side, side));
        };
        if (file.given(table + "line")) {
            take(file.points(table + "line"));
            continue;
        }
        const auto outline = reader.read_polygons(file.path(table + "outline"), whole.crs_wkt, said_later);
        for (const Polygon& polygon : outline.parts)
            for (const auto& ring : polygon.rings) take(ring);
    }
}

std::vector<Vec2> shown_places(const CaseFile& file, const GisReader& reader, const Raster& whole) {
    std::vector<Vec2> points;
    for (Index i = 0; i < file.count("profile"); ++i) {
        const Polyline& line = file.points(fmt::format("profile.{}.line", i));
        points.insert(points.end(), line.begin(), line.end());
    }
    std::vector<std::string> said_later;
    if (file.given("survey.footprint"))
        take_corners(
            reader.read_survey(file.path("survey.footprint"), whole.geometry.pixel_extent(), whole.crs_wkt, said_later),
            points);
    take_corners_of_barriers(file, reader, whole, points);
    return points;
}

}  // namespace

std::optional<TerrainPart> part_to_begin_with(const CaseFile& file, const Scene& scene, const GisReader& reader,
                                              const Raster& whole) {
    if (!may_begin_with_part(file, scene)) return {};
    constexpr Index kListed = 48;  // what is near material is listed by tiles of 16 nodes
    constexpr Index kToGo = 512;   // nodes: most flows of a hillslope end within
    const NodeBox all = NodeBox::all(whole.geometry);
    TerrainPart part;
    std::vector<Vec2> others;
    try {
        if (!fields_may_follow(file, reader, whole)) return {};
        const std::vector<Vec2> material = corners_of_material(file, reader, whole);
        if (material.empty()) return {};
        part.box = common(cells_of(material, whole.geometry), all);
        part.shown = shown_places(file, reader, whole);
        take_lines(file, "section", reader, whole, others);
    } catch (const UserError&) {
        return {};  // told when it is read for good
    }
    if (part.box.nx == 0 || part.box.ny == 0) return {};
    part.box = widened(part.box, clear_of_edge(scene, whole.geometry.cell) + kListed + kToGo);
    others.insert(others.end(), part.shown.begin(), part.shown.end());
    for (Index i = 0; i < file.count("gauge"); ++i) {
        const auto& xy = file.numbers(fmt::format("gauge.{}.point", i));
        others.emplace_back(xy[0], xy[1]);
    }
    part.box = common(united(part.box, common(widened(cells_of(others, whole.geometry), 2), all)), all);
    if (part.box == all) return {};
    return part;
}

}  // namespace frana
