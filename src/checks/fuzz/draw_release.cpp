// What is let go in a random case, and how fast it already is.
#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"

namespace frana::fuzz {
namespace {

constexpr double kNone = Raster::nodata;

/// A depth raster, nothing anywhere.
Raster empty_like(const Raster& dem) { return Raster::filled(dem.geometry, kNone); }

/// Where the material lies: a disc, a box, a strip, scattered pixels, everywhere.
std::vector<std::uint8_t> draw_place(Dice& dice, const GridGeometry& grid) {
    std::vector<std::uint8_t> inside(static_cast<std::size_t>(grid.size()), 0);
    const double nx = static_cast<double>(grid.nx), ny = static_cast<double>(grid.ny);
    const double x0 = dice.between(0.1, 0.9) * nx, y0 = dice.between(0.1, 0.9) * ny;
    const double reach_x = dice.between(0.8, 0.35 * nx), reach_y = dice.between(0.8, 0.35 * ny);
    const double share = dice.between(0.05, 0.6);
    const Index shape = dice.below(12);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const double x = static_cast<double>(i) - x0, y = static_cast<double>(j) - y0;
            bool in = std::hypot(x, y) < std::min(reach_x, reach_y);
            if (shape == 0 || shape == 1) in = std::abs(x) < reach_x && std::abs(y) < reach_y;
            if (shape == 2) in = std::abs(x) < reach_x;
            if (shape == 3) in = dice.chance(share);
            if (shape == 4) in = (i + j) % 2 == 0 && std::hypot(x, y) < std::min(reach_x, reach_y);
            if (shape == 5) in = true;
            inside[static_cast<std::size_t>(j * grid.nx + i)] = in;
        }
    if (shape == 6) std::fill(inside.begin(), inside.end(), std::uint8_t{0});
    if (shape == 6 || std::count(inside.begin(), inside.end(), 1) == 0)
        inside[static_cast<std::size_t>((grid.ny / 2) * grid.nx + grid.nx / 2)] = 1;  // alone
    return inside;
}

/// Depths of 0.1 mm to 100 m, more often of about a cell.
double draw_depth(Dice& dice, double cell) {
    return dice.chance(0.5) ? std::clamp(cell * dice.decades(0.01, 3.0), 1e-4, 100.0) : dice.decades(1e-4, 100.0);
}

Raster draw_depths(Dice& dice, const Raster& dem) {
    Raster depth = empty_like(dem);
    const auto inside = draw_place(dice, dem.geometry);
    const double usual = draw_depth(dice, dem.geometry.cell), other = draw_depth(dice, dem.geometry.cell);
    const Index pattern = dice.below(6);
    for (Index j = 0; j < depth.geometry.ny; ++j)
        for (Index i = 0; i < depth.geometry.nx; ++i) {
            if (!inside[static_cast<std::size_t>(j * depth.geometry.nx + i)]) continue;
            double& h = depth.at(i, j);
            h = usual;
            if (pattern == 0) h = dice.decades(std::min(usual, other), std::max(usual, other) * 1.01);
            if (pattern == 1) h = i < depth.geometry.nx / 2 ? usual : other;
            if (pattern == 2) h = dice.chance(0.1) ? other : usual;
            h = single(std::max(h, 1e-4));
        }
    return depth;
}

void draw_velocity(Dice& dice, Draft& draft, double cell) {
    const double speed = std::min(dice.decades(0.01, 10.0) * std::sqrt(9.81 * cell), 60.0);
    if (dice.chance(0.5)) {
        const double vx = dice.between(-speed, speed);
        const double vy = dice.between(-speed, speed);
        draft.keys["release.velocity"] = "[" + toml_number(vx) + ", " + toml_number(vy) + "]";
        return;
    }
    for (const char* name : {"vx.tif", "vy.tif"}) {
        Raster v = Raster::filled(draft.dem().geometry, 0.0);
        const Index pattern = dice.below(3);
        for (Index j = 0; j < v.geometry.ny; ++j)
            for (Index i = 0; i < v.geometry.nx; ++i) {
                double share = dice.between(-1.0, 1.0);
                if (pattern == 0) share = i < v.geometry.nx / 2 ? 1.0 : -1.0;
                if (pattern == 1) share = j < v.geometry.ny / 2 ? 1.0 : -1.0;
                v.at(i, j) = single(speed * share);
            }
        draft.rasters[name] = v;
    }
    draft.keys["release.velocity"] = "[\"vx.tif\", \"vy.tif\"]";
}

/// Holes in the elevation model, four cells and more from any material (nearer ones are refused).
void draw_exits(Dice& dice, Draft& draft, const Raster& depth) {
    Raster& dem = draft.rasters["dem.tif"];
    const double share = dice.between(0.01, 0.4);
    for (Index j = 0; j < dem.geometry.ny; ++j)
        for (Index i = 0; i < dem.geometry.nx; ++i) {
            const bool free =
                all_near(dem.geometry, i, j, [&](Index a, Index b) { return std::isnan(depth.at(a, b)); });
            if (free && dice.chance(share)) dem.at(i, j) = Raster::nodata;
        }
    draft.keys["boundary.holes"] = "\"open\"";
}

/// The outer row of pixels lies half beyond the domain; a release of nothing but such pixels could be none.
void draw_particles(Dice& dice, Draft& draft, Index pixels) {
    const std::string placement = dice.chance(0.7) ? "lattice" : dice.one_of({"r2", "slope"});
    draft.keys["particles.placement"] = "\"" + placement + "\"";
    int per_cell = dice.one_of({1, 2, 4, 4, 4, 9, 16});
    while (per_cell > 1 && per_cell * pixels > 1200) per_cell /= 2;
    draft.keys["particles.per_cell"] = std::to_string(per_cell);
}

}  // namespace

void draw_release(Dice& dice, Draft& draft) {
    Raster depth = draw_depths(dice, draft.dem());
    const Index pixels =
        static_cast<Index>(std::count_if(depth.values.begin(), depth.values.end(), [](double h) { return h > 0.0; }));
    if (dice.chance(0.15)) draw_exits(dice, draft, depth);
    draft.rasters["depth.tif"] = depth;
    draft.keys["release.depth"] = "\"depth.tif\"";
    if (dice.chance(0.5)) draw_velocity(dice, draft, draft.dem().geometry.cell);
    draw_particles(dice, draft, pixels);
}

void draw_release(Dice& dice, Draft& draft, const ReleaseKind& kind) {
    const GridGeometry& grid = draft.dem().geometry;
    Raster depth = empty_like(draft.dem());
    const auto inside = draw_place(dice, grid);
    const double usual = dice.decades(kind.least, kind.most), other = dice.decades(kind.least, kind.most);
    const Index pattern = dice.below(4);
    Index pixels = 0;
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            if (!inside[static_cast<std::size_t>(j * grid.nx + i)] || pixels == kind.pixels) continue;
            const bool differs = (pattern == 0 && i < grid.nx / 2) || (pattern == 1 && dice.chance(0.2));
            depth.at(i, j) = single(grid.cell * (differs ? other : usual));
            ++pixels;
        }
    draft.rasters["depth.tif"] = depth;
    draft.keys["release.depth"] = "\"depth.tif\"";
    if (dice.chance(0.5)) draw_velocity(dice, draft, grid.cell);
    draw_particles(dice, draft, pixels);
}

Scales scales_of(const Draft& draft) {
    Scales of{0.0, 0.0, 0.0, 0.0, 9.81};
    const Raster& depth = draft.rasters.at("depth.tif");
    const double area = depth.geometry.cell * depth.geometry.cell;
    for (const double h : depth.values)
        if (h > 0.0) of.deepest = std::max(of.deepest, h), of.volume += area * h;
    if (draft.has("terrain.gravity")) of.gravity = std::stod(draft.keys.at("terrain.gravity"));
    for (const char* name : {"vx.tif", "vy.tif"})
        if (draft.rasters.count(name))
            for (const double v : draft.rasters.at(name).values) of.speed = std::max(of.speed, std::abs(v));
    if (draft.has("release.velocity") && !draft.rasters.count("vx.tif")) {
        const std::string& text = draft.keys.at("release.velocity");  // "[vx, vy]"
        of.speed = std::max(std::abs(std::stod(text.substr(1))), std::abs(std::stod(text.substr(text.find(',') + 1))));
    }
    of.wave = of.speed + std::sqrt(of.gravity * of.deepest);
    return of;
}

}  // namespace frana::fuzz
