// [erodible] of a case: loose material on the bed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "law/catalogue.h"
#include "scene/nodes_of_place.h"
#include "scene/stage_reach.h"
#include "terrain/outline_area.h"
#include "terrain/part_of.h"

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

/// Of a raster of depths.
Raster on_nodes(const std::filesystem::path& path, const GisReader& reader, Scene& scene) {
    std::vector<std::string> before = scene.log;  // what the first reading says the second says again
    const Raster pixels = pixels_on(path, reader, scene);
    refuse_negative(pixels, path.string());
    scene.log = std::move(before);
    return field_within_pixels(path, pixels, reader, scene);
}

/// On the nodes of the terrain; rock is 0.
Raster depth_of(const CaseFile& file, const GisReader& reader, Scene& scene) {
    const GridGeometry& grid = scene.bed.geometry;
    if (!file.is_text("erodible.depth")) return Raster::filled(grid, file.number("erodible.depth"));
    const std::filesystem::path path = file.path("erodible.depth");
    reader.require_metres(path);
    Raster depth = on_nodes(path, reader, scene);
    Index missing = 0;
    for (double& value : depth.values) {
        if (std::isnan(value)) ++missing;
        value = value > 0.0 ? value : 0.0;
    }
    if (missing > 0)
        scene.log.push_back(fmt::format("{}: {:.3g} % of {} have no depth of loose material there and count as rock",
                                        file.place("erodible.depth"), 100.0 * double(missing) / double(grid.size()),
                                        nodes_text(scene)));
    return depth;
}

/// Where the pixels of a row of nodes meet, from its first node to its last, which bound it [m].
std::vector<double> pixel_edges(Index count, double cell) {
    std::vector<double> edges{0.0};
    for (Index n = 0; n + 1 < count; ++n) edges.push_back((static_cast<double>(n) + 0.5) * cell);
    edges.push_back(static_cast<double>(count - 1) * cell);
    return edges;
}

/// Of an outline, on whole pixels: the outer ones reach half a cell beyond their nodes [m2].
double area_on_pixels(const Rings& rings, const GridGeometry& g) {
    const auto sides = [&](Index count) {
        return std::vector<double>{-0.5 * g.cell, (static_cast<double>(count) - 0.5) * g.cell};
    };
    std::vector<double> area(1);
    const auto [first, past] = OutlineArea(rings, sides(g.nx), sides(g.ny)).row(0, area);
    return first < past ? area.front() : 0.0;
}

/// An outline that leaves the terrain, of which the scene may hold a part.
void remark_on_outline(const CaseFile& file, const Polygons& outline, double share_inside, Scene& scene) {
    if (share_inside >= 0.999 || may_begin_beyond(outline, scene)) return;
    scene.log.push_back(fmt::format("{}: {:.3g} % of its area lie outside of the terrain",
                                    file.place("erodible.outline"), 100.0 * (1.0 - share_inside)));
}

[[noreturn]] void refuse_outline(const Rings& rings, const GridGeometry& g) {
    Vec2 low(INFINITY, INFINITY), high(-INFINITY, -INFINITY);
    for (const auto& ring : rings)
        for (const Vec2& corner : ring) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    throw UserError(fmt::format(
        "found an outline of x {:.10g} to {:.10g}, y {:.10g} to {:.10g} without any of the terrain; expected some "
        "of its x {:.10g} to {:.10g}, y {:.10g} to {:.10g}; correct the outline or its CRS",
        g.x0 + low.x(), g.x0 + high.x(), g.y0 + low.y(), g.y0 + high.y(), g.x0, g.x_max(), g.y0, g.y_max()));
}

/// Each node gets the part of its pixel's depth that the outline covers.
void keep_inside(const CaseFile& file, const GisReader& reader, Scene& scene, Raster& depth) {
    const Polygons outline = reader.read_polygons(file.path("erodible.outline"), scene.bed.crs_wkt, scene.log);
    const GridGeometry& g = depth.geometry;
    const Rings rings = rings_of(outline, {g.x0, g.y0});
    const std::vector<double> x = pixel_edges(g.nx, g.cell), y = pixel_edges(g.ny, g.cell);
    OutlineArea covered(rings, x, y);
    std::vector<double> area(static_cast<std::size_t>(g.nx));
    double inside = 0.0, all = 0.0;
    for (const auto& ring : rings) all += ring_area(ring);
    for (Index j = 0; j < g.ny; ++j) {
        const auto [first, past] = covered.row(j, area);
        for (Index i = 0; i < g.nx; ++i) {
            const double part = i >= first && i < past ? area[static_cast<std::size_t>(i)] : 0.0;
            const auto k = static_cast<std::size_t>(i), n = static_cast<std::size_t>(j);
            depth.at(i, j) *= part / ((x[k + 1] - x[k]) * (y[n + 1] - y[n]));
            inside += part;
        }
    }
    if (covered.faults().negative > 1e-9 * all)
        throw UserError(
            "found an outline that crosses itself, or a hole outside of its polygon; expected simple polygons; "
            "repair it (ogr2ogr -makevalid)");
    if (!(inside > 0.0) && !may_begin_beyond(outline, scene)) refuse_outline(rings, g);
    remark_on_outline(file, outline, area_on_pixels(rings, g) / all, scene);
}

/// 3D points take up no bed: it is firm in their window, and around it as far as they and particles act on each other.
void leave_window_out(const SolidStage& stage, Raster& depth, Scene& scene) {
    const GridGeometry& g = depth.geometry;
    const Index reach = 2 + reach_around(stage, g.cell);  // whose ground points may stand on
    const std::array<Index, 4>& w = stage.window;
    const NodeBox firm = common(widened({w[0], w[1], w[2] - w[0] + 1, w[3] - w[1] + 1}, reach), NodeBox::all(g));
    double volume = 0.0;
    for (Index j = firm.j0; j < firm.j0 + firm.ny; ++j)
        for (Index i = firm.i0; i < firm.i0 + firm.nx; ++i)
            volume += g.cell * g.cell * std::exchange(depth.at(i, j), 0.0);
    if (volume > 0.0)
        scene.log.push_back(fmt::format(
            "erodible: {:.6g} m3 of loose material in the window of the 3D stage, and around it, are taken for firm: "
            "3D points take up no bed",
            volume));
}

/// What seems to be a mistake.
void remark_on_depth(const CaseFile& file, const Raster& depth, Scene& scene) {
    constexpr double kDeep = 50.0;  // [m]
    const double deepest = *std::max_element(depth.values.begin(), depth.values.end());
    double volume = 0.0;
    for (const double value : depth.values) volume += value * depth.geometry.cell * depth.geometry.cell;
    if (deepest > kDeep)
        scene.log.push_back(
            fmt::format("{}: the loose material is up to {:.3g} m deep; is that a depth, and in metres?",
                        file.place("erodible.depth"), deepest));
    scene.log.push_back(fmt::format("erodible: up to {:.6g} m3 of loose material can be taken up{}{}", volume,
                                    scene.wider ? " around the releases; what lies farther on is not counted" : "",
                                    scene.barriers.empty() ? "" : "; what barriers stand on is counted, but stays"));
}

/// Some laws depend only on the flow's speed or depth. They let short waves of bed and flow grow near a Froude number of 1
/// (checks/verify/README.md, "Waves on a flow that takes up its bed").
void remark_on_waves(const CaseFile& file, const ErodibleBed& bed, Scene& scene) {
    constexpr double kViscosity = 0.03;  // of density, depth and speed: measured there
    const std::string& law = file.word("erodible.law");
    const bool grows = law == "jump" || law == "energy" || law == "steady";
    if (!grows || !bed.evolves || !std::holds_alternative<rheology::None>(scene.rheology)) return;
    scene.log.push_back(fmt::format(
        "{}: found \"{}\" without a viscosity; expected one if the flow is near a Froude number of 1, where "
        "short waves on its bed grow, faster on finer grids; give material.rheology.law = \"newtonian\" "
        "with a viscosity of {} times density, depth and speed ({:.3g} Pa s for a depth of 1 m)",
        file.place("erodible.law"), law, kViscosity, kViscosity * scene.density * std::sqrt(scene.gravity)));
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
    if (scene.solid) leave_window_out(*scene.solid, bed.depth, scene);
    remark_on_depth(file, bed.depth, scene);
    remark_on_waves(file, bed, scene);
    return bed;
}

}  // namespace frana
