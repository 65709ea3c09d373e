// [erodible] of a case: loose material on the bed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "law/catalogue.h"
#include "scene/nodes_of_place.h"

namespace frana {
namespace {

/// Of a raster's own pixels: none below zero.
void refuse_negative(const Raster& pixels, const std::string& file) {
    std::size_t bad = 0, first = 0;
    for (std::size_t k = pixels.values.size(); k-- > 0;)
        if (pixels.values[k] < 0.0) ++bad, first = k;
    if (bad == 0) return;
    throw UserError(
        fmt::format("{}: found {} pixels below 0, such as {:.6g} at {}; expected depths of 0 or more; correct "
                    "them, or give rock 0 or nodata",
                    file, bad, pixels.values[first], place_text(pixels.geometry, first)));
}

/// On the nodes of the terrain; rock is 0.
Raster depth_of(const CaseFile& file, const GisReader& reader, Scene& scene) {
    const GridGeometry& grid = scene.bed.geometry;
    if (!file.is_text("erodible.depth")) return Raster::filled(grid, file.number("erodible.depth"));
    const std::filesystem::path path = file.path("erodible.depth");
    std::vector<std::string> before = scene.log;  // what the first reading says the second says again
    refuse_negative(pixels_on(path, reader, scene), path.string());
    scene.log = std::move(before);
    Raster depth = field_on(path, reader, scene);
    Index missing = 0;
    for (double& value : depth.values) {
        if (std::isnan(value)) ++missing;
        value = value > 0.0 ? value : 0.0;  // cubic interpolation may undershoot
    }
    if (missing > 0)
        scene.log.push_back(fmt::format("{}: {:.3g} % of {} have no depth of loose material there and count as rock",
                                        file.place("erodible.depth"), 100.0 * double(missing) / double(grid.size()),
                                        nodes_text(scene)));
    return depth;
}

double area_of(const Polygons& polygons) {
    double area = 0.0;
    for (const Polygon& polygon : polygons.parts)
        for (std::size_t n = 0; n < polygon.rings.size(); ++n) {
            const std::vector<Vec2>& ring = polygon.rings[n];
            double twice = 0.0;
            for (std::size_t k = 0; k < ring.size(); ++k) {
                const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
                twice += a.x() * b.y() - b.x() * a.y();
            }
            area += (n == 0 ? 0.5 : -0.5) * std::abs(twice);
        }
    return area;
}

/// Each node keeps what part of its pixel the outline covers.
void keep_inside(const CaseFile& file, const GisReader& reader, Scene& scene, Raster& depth) {
    Release unit;
    unit.outline = reader.read_polygons(file.path("erodible.outline"), scene.bed.crs_wkt, scene.log);
    unit.depth = 1.0, unit.name = file.place("erodible.outline");
    Raster covered = Raster::filled(scene.bed.geometry, 0.0);
    covered.crs_wkt = scene.bed.crs_wkt;
    const double inside = cut_release(unit, covered), all = area_of(*unit.outline);
    if (inside < 0.999 * all && !(scene.wider && touches(*unit.outline, scene.wider->grid)))
        scene.log.push_back(fmt::format("{}: {:.3g} % of its area lie outside of the terrain",
                                        file.place("erodible.outline"), 100.0 * (1.0 - inside / all)));
    const GridGeometry& g = depth.geometry;
    const auto within = [](Index n, Index count) {
        return n == 0 || n == count - 1 ? 0.5 : 1.0;
    };  // outer nodes bound it
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i)
            depth.at(i, j) *= std::min(1.0, -covered.at(i, j) / (within(i, g.nx) * within(j, g.ny)));
}

/// What looks like a mistake.
void remark_on_depth(const CaseFile& file, const Raster& depth, Scene& scene) {
    constexpr double kDeep = 50.0;  // [m]
    const double deepest = *std::max_element(depth.values.begin(), depth.values.end());
    double volume = 0.0;
    for (const double value : depth.values) volume += value * depth.geometry.cell * depth.geometry.cell;
    if (deepest > kDeep)
        scene.log.push_back(
            fmt::format("{}: the loose material is up to {:.3g} m deep; is that a depth, and in metres?",
                        file.place("erodible.depth"), deepest));
    scene.log.push_back(fmt::format("erodible: up to {:.6g} m3 of loose material can be taken up{}", volume,
                                    scene.wider ? " around the releases, and more where the flow comes beyond" : ""));
}

/// What ploughs takes all that lies in its way: that has to end somewhere.
void require_extent(const CaseFile& file) {
    if (file.word("erodible.law") != "front" || file.given("erodible.outline") || file.is_text("erodible.depth"))
        return;
    throw UserError(
        "found \"front\" with loose material on all of the terrain; expected to know where the layer lies "
        "that the flow ploughs; give erodible.outline, or a raster as erodible.depth");
}

}  // namespace

std::optional<ErodibleBed> read_erodible(const CaseFile& file, const GisReader& reader, Scene& scene,
                                         Problems& problems) {
    const std::string& law = file.word("erodible.law");
    if (law == "none" || !problems.attempt(file.place("erodible.law"), [&] { require_extent(file); })) return {};
    ErodibleBed bed;
    bed.law = laws::Catalogue<ErosionLaw>::make(law, [&](const std::string& name) {
        const std::string key = "erodible." + name;
        return file.has(key) ? std::optional<double>(file.number(key)) : std::nullopt;
    });
    bed.density = file.given("erodible.density") ? file.number("erodible.density") : scene.density;
    bed.momentum = file.number("erodible.momentum");
    bed.min_depth = file.number("erodible.min_depth");
    bed.evolves = file.flag("erodible.bed_evolves");
    if (!problems.attempt(file.place("erodible.depth"), [&] { bed.depth = depth_of(file, reader, scene); })) return {};
    if (file.given("erodible.outline") &&
        !problems.attempt(file.place("erodible.outline"), [&] { keep_inside(file, reader, scene, bed.depth); }))
        return {};
    remark_on_depth(file, bed.depth, scene);
    return bed;
}

}  // namespace frana
