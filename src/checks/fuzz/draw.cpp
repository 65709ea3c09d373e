#include "checks/fuzz/draw.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace frana::fuzz {
namespace {

/// Pixel (i, j) and its image.
template <class Body>
void for_each_pair(const GridGeometry& grid, Mirror mirror, Body&& body) {
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            if (mirror == Mirror::x) body(i, j, grid.nx - 1 - i, j);
            if (mirror == Mirror::y) body(i, j, i, grid.ny - 1 - j);
            if (mirror == Mirror::diagonal && i < grid.ny && j < grid.nx) body(i, j, j, i);
        }
}

/// The second half of each raster becomes the image of the first, times `sign`.
void reflect(Raster& raster, Mirror mirror, double sign) {
    for_each_pair(raster.geometry, mirror, [&](Index i, Index j, Index a, Index b) {
        if (j * raster.geometry.nx + i < b * raster.geometry.nx + a)
            raster.at(a, b) = sign * raster.at(i, j);
        else if (i == a && j == b && sign < 0.0)
            raster.at(i, j) = 0.0;
    });
}

/// The north-west part of all rasters, as many pixels in x as in y.
void make_square(Draft& draft) {
    const GridGeometry old = draft.dem().geometry;
    const Index n = std::min(old.nx, old.ny);
    for (auto& [name, raster] : draft.rasters) {
        const Raster whole = raster;
        raster.geometry.nx = raster.geometry.ny = n;
        raster.values.assign(static_cast<std::size_t>(n * n), 0.0);
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i) raster.at(i, j) = whole.at(i, j);
    }
}

}  // namespace

void mirror(Draft& draft, Mirror mirror) {
    if (mirror == Mirror::diagonal) make_square(draft);
    for (auto& [name, raster] : draft.rasters) {
        const bool odd = (name == "vx.tif" && mirror == Mirror::x) || (name == "vy.tif" && mirror == Mirror::y);
        if (name != "vy.tif" || mirror != Mirror::diagonal) reflect(raster, mirror, odd ? -1.0 : 1.0);
    }
    Raster& depth = draft.rasters["depth.tif"];  // something must be left
    const Index i = (depth.geometry.nx - 1) / 2, j = mirror == Mirror::diagonal ? i : (depth.geometry.ny - 1) / 2;
    if (!(depth.at(i, j) > 0.0)) depth.at(i, j) = single(0.3 * depth.geometry.cell);
    for (double& z : draft.rasters["dem.tif"].values) z = std::isnan(z) ? 0.0 : z;  // holes lie where it may be now
    reflect(depth, mirror, 1.0);
    if (draft.rasters.count("vx.tif") && mirror == Mirror::diagonal)  // v at (y, x) is u at (x, y)
        for_each_pair(depth.geometry, mirror, [&](Index a, Index b, Index c, Index d) {
            draft.rasters["vy.tif"].at(c, d) = draft.rasters["vx.tif"].at(a, b);
        });
    else if (!draft.rasters.count("vx.tif"))
        draft.keys.erase("release.velocity");
    draft.keys["particles.placement"] = "\"lattice\"";
    // An odd number of points a side would put some on the edges of pixels. These belong to one of two.
    draft.keys["particles.per_cell"] = std::stod(draft.keys["particles.per_cell"]) > 4.0 ? "16" : "4";
    draft.claims.mirror = mirror;
}

void draw_pile(Dice& dice, Draft& draft) {
    GridGeometry grid;
    grid.nx = 16 + dice.below(26);
    grid.ny = 16 + dice.below(26);
    grid.cell = dice.one_of({0.03125, 0.5, 1.0, 5.0, 24.0});
    const bool steep = dice.chance(0.6);
    const double slope = steep ? dice.between(0.0, 1.2) : dice.between(0.0, 0.6);
    const double flank = dice.between(0.02, 0.5), turn = dice.chance(0.5) ? 0.0 : dice.between(0.0, 2 * constants::kPi);
    // Drive over holding friction where the pile is steepest on the way down. Steep ground eases the drive by 1 + B.e
    // and the normal force by 1 + B^2.
    const double e = slope + flank;
    const double drive = steep ? e / (1.0 + slope * e) * (1.0 + slope * slope) : e;
    const double mu = drive * dice.between(1.3, 3.0);
    const double radius = dice.between(2.0, 0.4 * static_cast<double>(std::min(grid.nx, grid.ny)));
    const double x0 = 0.5 * static_cast<double>(grid.nx - 1) + dice.between(-0.5, 0.5);
    const double y0 = 0.5 * static_cast<double>(grid.ny - 1) + dice.between(-0.5, 0.5);
    const bool cone = dice.chance(0.5);
    Raster dem = Raster::filled(grid, 0.0), depth = Raster::filled(grid, Raster::nodata);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const double x = static_cast<double>(i) - x0, y = static_cast<double>(j) - y0;
            const double r = std::hypot(x, y) / radius;
            dem.at(i, j) = single(-grid.cell * slope * (std::cos(turn) * x + std::sin(turn) * y));
            const double h = grid.cell * radius * flank * (cone ? 1.0 - r : 0.5 * (1.0 - r * r));
            if (h > 1e-4 * grid.cell) depth.at(i, j) = single(h);
        }
    draft.rasters = {{"dem.tif", dem}, {"depth.tif", depth}};
    draft.keys = {{"terrain.dem", "\"dem.tif\""}, {"release.depth", "\"depth.tif\""}};
    draft.keys["particles.per_cell"] = dice.one_of({"1", "4", "9", "16"});
    draft.keys["material.bed.law"] = dice.one_of({"\"coulomb\"", "\"voellmy\""});
    draft.keys["material.bed.mu"] = toml_number(mu);
    if (draft.keys["material.bed.law"] == "\"voellmy\"")
        draft.keys["material.bed.xi"] = toml_number(dice.decades(1e-3, 1e7));
    if (!steep) draft.keys["terrain.model"] = "\"shallow\"";
    if (dice.chance(0.3)) draft.keys["scheme.cfl"] = toml_number(dice.between(0.05, 0.5));
    if (dice.chance(0.3)) draft.keys["boundary.sides"] = "\"wall\"";
    if (dice.chance(0.3)) draft.keys["scheme.transfer"] = dice.one_of({"\"apic\"", "\"flip\"", "\"pic\""});
    draft.claims.rests = true;
}

void draw_lake(Dice& dice, Draft& draft) {
    const Raster& dem = draft.dem();
    double low = INFINITY, high = -INFINITY;
    for (const double z : dem.values) low = std::min(low, z), high = std::max(high, z);
    const double level = low + dice.between(0.3, 1.2) * std::max(high - low, 0.1 * dem.geometry.cell);
    draft.keys["release.surface"] = toml_number(level);
    draft.keys["particles.per_cell"] = dem.geometry.size() > 600 ? "1" : "4";
    draft.keys["boundary.sides"] = "\"wall\"";  // an open side lets it out
    draft.claims.rests = true;
}

namespace {

/// Numbers of a series of its own: every model draws other scenes from one seed.
std::uint64_t salted(std::uint64_t seed, std::uint64_t salt) {
    return Dice(seed ^ (salt * 0x9fb21c651e98df25u)).bits();
}

constexpr std::uint64_t kModel = 1, kBits = 2, kLoose = 3, kInflow = 4, kLate = 5, kFriction = 6, kDeposition = 7,
                        kSpring = 8, kForest = 9, kPreset = 10, kScene = 16;  // salts

}  // namespace

Draft draw(std::uint64_t seed, std::uint64_t n) {
    Dice dice(seed, n);
    Draft draft;
    draft.steps = 30 + dice.below(70);
    const double kind = dice.unit();
    if (kind < 0.10) {
        draw_pile(dice, draft);
    } else {
        draft.claims.threads = kind > 0.98;
        draw_terrain(dice, draft);
        if (kind < 0.15) {
            draw_lake(dice, draft);
        } else {
            draw_release(dice, draft);
            draw_material(dice, draft);
            draw_scheme(dice, draft);
            if (kind < 0.27) mirror(draft, dice.one_of({Mirror::x, Mirror::y, Mirror::diagonal}));
            Dice loose(salted(seed, kLoose), n);
            if (loose.chance(0.2)) draw_erodible(loose, draft);
            Dice inflow(salted(seed, kInflow), n);
            if (inflow.chance(0.15)) draw_inflow(inflow, draft);
            Dice spring(salted(seed, kSpring), n);
            if (spring.chance(0.1)) draw_spring(spring, draft);
            Dice late(salted(seed, kLate), n), friction(salted(seed, kFriction), n);
            if (late.chance(0.1)) draw_late(late, draft);
            if (friction.chance(0.1)) draw_friction(friction, draft);
            Dice deposition(salted(seed, kDeposition), n);
            if (deposition.chance(0.2)) draw_deposition(deposition, draft);
            Dice forest(salted(seed, kForest), n);
            if (forest.chance(0.15)) draw_forest(forest, draft);
            Dice preset(salted(seed, kPreset), n);
            if (!draft.has("scheme.preset") && preset.chance(0.2)) say(draft, "scheme.preset", "fast");
        }
    }
    draft.keys["time.end"] = "1.0e6";
    draft.keys["output.formats"] = "[\"vtk\"]";
    return draft;
}

namespace {

void draw_other(Dice& dice, Draft& draft) {
    draft.steps = 25 + dice.below(50);
    switch (draft.model) {
        case Model::depth_averaged:
            break;
        case Model::mpm3d:
            return draw_mpm3d(dice, draft);
        case Model::structured:
            return draw_structured(dice, draft);
        case Model::water:
            return draw_water(dice, draft);
        case Model::mixture:
            return draw_mixture(dice, draft);
        case Model::staged:
            return draw_staged(dice, draft);
        case Model::flood:
            return draw_flood(dice, draft);
    }
}

}  // namespace

Draft draw(Model model, std::uint64_t seed, std::uint64_t n) {
    Dice bits(salted(seed, kBits), n);
    const bool threads = bits.chance(0.05), resumes = bits.chance(0.1);
    if (model == Model::depth_averaged) {
        Draft draft = draw(seed, n);
        draft.claims.resumes = resumes;
        return draft;
    }
    Dice dice(salted(seed, kScene + static_cast<std::uint64_t>(model)), n);
    Draft draft;
    draft.model = model;
    draft.claims.threads = threads, draft.claims.resumes = resumes;  // with threads the terrain is wide
    draw_other(dice, draft);
    Dice friction(salted(seed, kFriction), n);
    if (friction.chance(0.2)) draw_friction(friction, draft);
    // No scene gets there. Mud as thick as is drawn has steps too short for more (scene_water.cpp).
    draft.keys["time.end"] = draft.has("water.mud_alpha") ? "1.0e4" : "1.0e6";
    draft.keys["output.formats"] = "[\"vtk\"]";
    return draft;
}

Model model_of(const std::vector<Model>& models, std::uint64_t seed, std::uint64_t n) {
    return models[static_cast<std::size_t>(Dice(salted(seed, kModel), n).below(static_cast<Index>(models.size())))];
}

}  // namespace frana::fuzz
