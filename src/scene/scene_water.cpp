// [water] of a case: free water, together with solids that hold together or alone.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "law/water_keys.h"
#include "scene/law_places.h"
#include "scene/nodes_of_place.h"
#include "scene/remarks.h"
#include "scene/scene_parts.h"

namespace frana {
namespace {

double number(const CaseFile& file, const char* name) { return file.number(std::string("water.") + name); }

std::string at(const GridGeometry& g, std::size_t k) {
    const auto n = static_cast<Index>(k);
    return fmt::format("x {:.10g}, y {:.10g}", g.x(n % g.nx), g.y(n / g.nx));
}

/// Throws UserError when a value fails; `what`: "pixels", or "nodes of the terrain".
template <class Good>
void require(const Raster& raster, const std::string& file, const char* what, Good&& good, const char* expected) {
    std::size_t bad = 0, first = 0;
    for (std::size_t k = raster.values.size(); k-- > 0;)
        if (!good(raster.values[k])) ++bad, first = k;
    if (bad == 0) return;
    const double value = raster.values[first];
    throw UserError(
        fmt::format("{}: found {} of {} {} {}, the first at {}; {}", file, bad, raster.values.size(), what,
                    std::isnan(value) ? std::string("without a number") : fmt::format("such as {:.6g}", value),
                    at(raster.geometry, first), expected));
}

/// A rate on the nodes of the terrain [m/s]: a number or a raster. The raster's own pixels have to be rates and to
/// cover the terrain. Nothing where it is 0 everywhere.
Raster rate_on_nodes(const CaseFile& file, const GisReader& reader, const std::string& key, Scene& scene) {
    const GridGeometry& grid = scene.bed.geometry;
    if (!file.is_text(key)) {
        const double rate = file.number(key);
        return rate > 0.0 ? Raster::filled(grid, rate) : Raster{};
    }
    const std::filesystem::path path = file.path(key);
    std::vector<std::string> said;  // of the first reading, which the second says again
    const Raster pixels = reader.read_raster(path, grid.pixel_extent(), scene.bed.crs_wkt, said);
    require(
        pixels, path.string(), "pixels", [](double rate) { return rate >= 0.0 && rate < INFINITY; },
        "expected rates in m/s, 0 or more, in all of them; fill what is missing (0 where there is none) or correct it");
    Raster nodes = field_within_pixels(path, pixels, reader, scene);
    require(
        nodes, path.string(), "nodes of the terrain", [](double rate) { return std::isfinite(rate); },
        "expected a raster that covers all of the terrain; extend it (0 where there is none), or give a terrain.window "
        "within it");
    for (double& rate : nodes.values) rate = std::max(rate, 0.0);  // cubic interpolation may undershoot
    if (std::none_of(nodes.values.begin(), nodes.values.end(), [](double rate) { return rate > 0.0; })) return {};
    return nodes;
}

/// Of the water with what is suspended in it [Pa s]: grains settle in that, and with water.viscous the flow feels it.
double viscosity_of(const CaseFile& file, Scene& scene) {
    const double clear = number(file, "viscosity");
    if (file.word("water.viscous") != "mud") return clear;
    const double alpha = number(file, "mud_alpha"), beta = number(file, "mud_beta"),
                 part = number(file, "mud_concentration");
    const double eta = mud_viscosity(alpha, beta, part, clear);
    scene.log.push_back(
        fmt::format("water: with mud_alpha = {:.6g} Pa s, mud_beta = {:.6g} and mud_concentration = {:.6g} "
                    "its viscosity is {:.6g} Pa s (where tables have poise: 1 poise is 0.1 Pa s)",
                    alpha, beta, part, eta));
    return eta;
}

WaterExchange exchange_of(const CaseFile& file, double viscosity, const Scene& scene) {
    WaterExchange exchange;
    TwoPhaseMaterial& m = exchange.material;
    read_numbers(file, "water.", laws::two_phase_keys(), m);
    m.viscosity = viscosity, m.gravity = scene.gravity;
    m.split = file.word("water.drag") == "split";
    m.power = static_cast<int>(number(file, "drag_power"));
    if (scene.structure) {
        const double confined = scene.structure->confined;
        m.solid_density = (scene.density - confined * m.fluid_density) / (1.0 - confined);
    }
    const std::string& inertia = file.word("water.virtual_mass");
    exchange.virtual_mass = inertia == "none"        ? VirtualMass::none
                            : inertia == "unbounded" ? VirtualMass::unbounded
                                                     : VirtualMass::bounded;
    read_numbers(file, "water.", laws::water_exchange_keys(), exchange);
    return exchange;
}

/// Viscosity that no run gets to the end with.
void refuse_endless_steps(const CaseFile& file, const WaterPhase& water, const Scene& scene, Problems& problems) {
    constexpr double kMost = 1e9;
    if (!(water.viscosity.kinematic > 0.0)) return;
    const double step = viscous_step(water.viscosity, scene.bed.geometry.cell), steps = scene.end / step;
    if (steps <= kMost) return;
    problems.add(file.place("water.viscous"),
                 fmt::format("found a viscosity of {:.3g} Pa s, which needs steps of {:.2g} s and {:.2g} of them",
                             water.viscosity.kinematic * water.exchange.material.fluid_density, step, steps),
                 fmt::format("expected {:.0e} steps at most", kMost),
                 "check mud_alpha, mud_beta and mud_concentration, or give a larger grid.cell");
}

/// Grains that cannot go together with free water; scene/combinations.cpp has the rest.
void refuse_light_grains(const CaseFile& file, const TwoPhaseMaterial& m, const Scene& scene, Problems& problems) {
    if (!file.given("material.density"))
        problems.add(file.place("material.density"), "not given with water.model = \"free\"",
                     "expected the density of grains with their confined water, which the water flows around",
                     "give it, of loose rock about 2650");
    else if (m.solid_density <= m.fluid_density)
        problems.add(file.place("material.density"),
                     fmt::format("found {:.6g} kg/m3, so that grains have {:.6g}", scene.density, m.solid_density),
                     fmt::format("expected grains denser than water.density = {:.6g}", m.fluid_density),
                     "give the particles' density, of grains and confined water together");
}

/// Water finds its level over all of the terrain.
void require_ground(const CaseFile& file, const Scene& scene, Problems& problems) {
    if (std::any_of(scene.bed.values.begin(), scene.bed.values.end(), [](double z) { return !std::isfinite(z); }))
        problems.add(file.place("terrain.dem"), "found nodes without elevation with water.model = \"free\"",
                     "expected ground everywhere", "give a terrain.window without nodata, or fill the elevation model");
}

/// A lake at rest, on the nodes of the terrain where it may be.
class Lake {
public:
    Lake(const Scene& scene, const WaterPhase& water) : bed_(scene.bed), water_(water) {
        const GridGeometry& g = bed_.geometry;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                if (may_be(i, j)) lowest = std::min(lowest, bed_.at(i, j));
                const double deep = depth(i, j);
                if (!(deep > 0.0)) continue;
                depths += deep, nodes += 1.0, deepest = std::max(deepest, deep);
                edges += at(Is::as_sides, i, j), frees += at(Is::free, i, j);
                for (const auto& [di, dj] : {std::pair<Index, Index>{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                    cut += flows_out(i + di, j + dj) ? 1.0 : 0.0;
            }
    }
    double lowest = INFINITY, deepest = 0.0;  ///< ground where it may be; its depth [m]
    double depths = 0.0, nodes = 0.0;         ///< sum over its nodes [m]; their number
    double edges = 0.0, frees = 0.0;          ///< their edges at sides without keys, at free ones
    double cut = 0.0;                         ///< those beyond which there is lower ground without it

private:
    using Is = WaterPhase::Side::Is;
    bool may_be(Index i, Index j) const {
        return water_.lake.empty() || water_.lake[static_cast<std::size_t>(j * bed_.geometry.nx + i)];
    }
    double depth(Index i, Index j) const { return may_be(i, j) ? *water_.level - bed_.at(i, j) : 0.0; }
    /// Edges of a node at sides of a kind.
    double at(Is is, Index i, Index j) const {
        const GridGeometry& g = bed_.geometry;
        const bool touches[] = {i == 0, i == g.nx - 1, j == 0, j == g.ny - 1};
        double count = 0.0;
        for (std::size_t side = 0; side < 4; ++side) count += touches[side] && water_.sides[side].is == is ? 1.0 : 0.0;
        return count;
    }
    bool flows_out(Index i, Index j) const {
        const GridGeometry& g = bed_.geometry;
        const bool inside = i >= 0 && j >= 0 && i < g.nx && j < g.ny;
        return inside && !may_be(i, j) && bed_.at(i, j) < *water_.level;
    }
    const Raster& bed_;
    const WaterPhase& water_;
};

/// "1290 m floods 1.2e+06 m2 of the ground, 3.4e+06 m3, 12 m deep at most".
void remark_on_lake(const CaseFile& file, const WaterPhase& water, Scene& scene) {
    const double cell = scene.bed.geometry.cell, level = *water.level;
    const Lake lake(scene, water);
    const std::string place = file.place("water.level");
    if (!(lake.nodes > 0.0)) {
        scene.log.push_back(
            fmt::format("{}: found {:.6g} m, which floods nothing; expected a level above the lowest "
                        "ground, {:.6g} m; correct it, or remove it",
                        place, level, lake.lowest));
        return;
    }
    std::string text = fmt::format("{}: {:.6g} m floods {:.4g} m2 of the ground with {:.4g} m3, {:.4g} m deep at most",
                                   place, level, lake.nodes * cell * cell, lake.depths * cell * cell, lake.deepest);
    if (lake.edges > 0.0 && !are_closed(scene.sides))
        text += fmt::format("; it meets open sides over {:.4g} m, {}", lake.edges * cell,
                            water.lake.empty() ? "beyond which it is held at that level" : "where it falls out");
    if (lake.frees > 0.0)
        text += fmt::format(
            "; it meets free sides over {:.4g} m, where still water on level ground stays; an elevation "
            "below the ground lets it fall out",
            lake.frees * cell);
    if (lake.cut > 0.0)
        text += fmt::format("; its outline cuts it off over {:.4g} m, where it breaks out at the start as behind a dam",
                            lake.cut * cell);
    scene.log.push_back(text);
}

/// Where water.level_within allows the lake. Throws UserError where that is nowhere, or no ground there is lower.
void read_lake(const CaseFile& file, const GisReader& reader, Scene& scene, WaterPhase& water) {
    const std::string key = "water.level_within";
    if (!file.given("water.level"))
        throw UserError("found without water.level; expected the lake's elevation; give it, or remove this");
    const GridGeometry& g = scene.bed.geometry;
    const Polygons outline = reader.read_polygons(file.path(key), scene.bed.crs_wkt, scene.log);
    water.lake.assign(static_cast<std::size_t>(g.size()), 0);
    for (const Polygon& polygon : outline.parts) mark_inside(polygon, g, water.lake);
    if (std::none_of(water.lake.begin(), water.lake.end(), [](char mark) { return mark != 0; })) {
        const auto e = g.pixel_extent();
        throw UserError(fmt::format(
            "{}: found no node of the terrain inside; expected an outline within x {:.10g} to {:.10g}, y {:.10g} to "
            "{:.10g}; check its place and its CRS",
            outline.source, e[0], e[2], e[1], e[3]));
    }
    const Lake lake(scene, water);
    if (!(lake.nodes > 0.0))
        throw UserError(
            fmt::format("{}: found no ground below {:.6g} m inside; expected a level above the lowest there, "
                        "{:.6g} m; correct water.level or the outline",
                        outline.source, *water.level, lake.lowest));
}

/// "water.sides.east: 12 m stands over 300 m of that side, 4 m deep at most".
void remark_on_level(const std::string& place, std::size_t side, double level, Scene& scene) {
    const GridGeometry& g = scene.bed.geometry;
    double nodes = 0.0, lowest = INFINITY;
    const Index count = side < 2 ? g.ny : g.nx;
    for (Index n = 0; n < count; ++n) {
        const double z = side == 0   ? scene.bed.at(0, n)
                         : side == 1 ? scene.bed.at(g.nx - 1, n)
                         : side == 2 ? scene.bed.at(n, 0)
                                     : scene.bed.at(n, g.ny - 1);
        lowest = std::min(lowest, z), nodes += z < level ? 1.0 : 0.0;
    }
    scene.log.push_back(nodes > 0.0
                            ? fmt::format("{}: {:.6g} m stands over {:.4g} m of that side, {:.4g} m deep at most",
                                          place, level, nodes * g.cell, level - lowest)
                            : fmt::format("{}: found {:.6g} m, below all ground there, {:.6g} m; water falls out",
                                          place, level, lowest));
}

std::array<WaterPhase::Side, 4> read_sides(const CaseFile& file, Scene& scene) {
    using Is = WaterPhase::Side::Is;
    std::array<WaterPhase::Side, 4> sides{};
    const char* const names[] = {"west", "east", "south", "north"};
    for (std::size_t side = 0; side < sides.size(); ++side) {
        const std::string key = std::string("water.sides.") + names[side];
        if (!file.given(key)) continue;
        if (file.is_text(key)) {
            sides[side].is = file.word(key) == "wall" ? Is::wall : Is::free;
            continue;
        }
        sides[side] = {Is::level, file.number(key)};
        remark_on_level(file.place(key), side, sides[side].level, scene);
    }
    return sides;
}

}  // namespace

WaterFriction water_friction(const CaseFile& file) { return water_friction(law_of<WaterLaw>(file, kWaterPlace)); }

std::optional<WaterPhase> read_water(const CaseFile& file, const GisReader& reader, Scene& scene, Problems& problems) {
    if (file.word("water.model") == "none") return {};
    WaterPhase water;
    water.share = scene.structure ? number(file, "share") : 1.0;
    if (file.given("water.level")) water.level = number(file, "level");
    water.sides = read_sides(file, scene);
    bool lies = true;
    if (file.given("water.level_within"))
        lies = problems.attempt(file.place("water.level_within"), [&] { read_lake(file, reader, scene, water); });
    if (water.level && lies) remark_on_lake(file, water, scene);
    for (const auto& [key, to] : {std::pair<const char*, Raster*>{"water.rain", &water.rain},
                                  std::pair<const char*, Raster*>{"water.infiltration", &water.infiltration}})
        problems.attempt(file.place(key), [&, key = key, to = to] { *to = rate_on_nodes(file, reader, key, scene); });
    if (!water.rain.values.empty())
        remark_on(scene.log, Remark::rain, file.place("water.rain"),
                  {*std::max_element(water.rain.values.begin(), water.rain.values.end())});
    water.friction = water_friction(file);
    const double viscosity = viscosity_of(file, scene);
    water.exchange = exchange_of(file, viscosity, scene);
    if (file.word("water.viscous") != "none") {
        water.viscosity.kinematic = viscosity / water.exchange.material.fluid_density;
        water.viscosity.solid_gradient = file.flag("water.solid_gradient");
        read_numbers(file, "water.", laws::water_viscosity_keys(), water.viscosity);
    }
    refuse_endless_steps(file, water, scene, problems);
    if (scene.structure) refuse_light_grains(file, water.exchange.material, scene, problems);
    require_ground(file, scene, problems);
    return water;
}

}  // namespace frana
