// The ground of a random case.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/fuzz/draw.h"

namespace frana::fuzz {
namespace {

/// Of 1 cm to 100 m; three significant bits, so that map coordinates and pixel edges are exact.
double draw_cell(Dice& dice) {
    const double cell = dice.chance(0.4) ? dice.one_of({0.5, 1.0, 2.0, 5.0, 10.0, 20.0}) : dice.decades(0.01, 100.0);
    const double unit = std::exp2(std::floor(std::log2(cell)) - 2.0);
    return std::round(cell / unit) * unit;
}

GridGeometry draw_grid(Dice& dice, bool wide) {
    GridGeometry grid;
    grid.cell = draw_cell(dice);
    grid.nx = wide ? 64 + dice.below(40) : 6 + dice.below(30);
    grid.ny = wide ? 64 + dice.below(40) : 6 + dice.below(30);
    if (dice.chance(0.3)) {  // somewhere on a national grid
        grid.x0 = grid.cell * std::round(dice.between(1e5, 9e5) / grid.cell);
        grid.y0 = grid.cell * std::round(dice.between(1e6, 6e6) / grid.cell);
    }
    return grid;
}

/// A direction of the map: along the axes, the diagonal, or any.
Vec2 direction(Dice& dice) {
    const double angle = dice.chance(0.5) ? 0.25 * constants::kPi * static_cast<double>(dice.below(8))
                                          : 2 * constants::kPi * dice.unit();
    return {std::cos(angle), std::sin(angle)};
}

/// Adds f(x, y) to all pixels, x and y in cells.
template <class Shape>
void add(Raster& dem, Shape&& shape) {
    for (Index j = 0; j < dem.geometry.ny; ++j)
        for (Index i = 0; i < dem.geometry.nx; ++i)
            dem.at(i, j) += dem.geometry.cell * shape(static_cast<double>(i), static_cast<double>(j));
}

void add_plane(Dice& dice, Raster& dem) {
    const double any = dice.between(0.0, 80.0);
    const double steepness =
        std::tan(dice.one_of({0.0, 5.0, 20.0, 35.0, 50.0, 70.0, 80.0, any}) * constants::kPi / 180);
    const Vec2 down = direction(dice);
    add(dem, [&](double x, double y) { return -steepness * (down.x() * x + down.y() * y); });
}

void add_waves(Dice& dice, Raster& dem) {
    const Vec2 along = direction(dice);
    const double length = dice.decades(3.0, 60.0), height = length * dice.decades(0.003, 0.3);
    add(dem, [&](double x, double y) {
        return height * std::sin(2 * constants::kPi * (along.x() * x + along.y() * y) / length);
    });
}

void add_hill(Dice& dice, Raster& dem) {
    const double x0 = dice.unit() * static_cast<double>(dem.geometry.nx);
    const double y0 = dice.unit() * static_cast<double>(dem.geometry.ny);
    const double radius = dice.decades(0.7, 12.0), height = radius * dice.between(-2.0, 2.0);
    add(dem, [&](double x, double y) {
        return height * std::exp(-((x - x0) * (x - x0) + (y - y0) * (y - y0)) / (radius * radius));
    });
}

void add_cliff(Dice& dice, Raster& dem) {
    const Vec2 across = direction(dice);
    const double edge = dice.between(0.2, 0.8), height = dice.decades(0.05, 30.0);
    const Vec2 corner(static_cast<double>(dem.geometry.nx), static_cast<double>(dem.geometry.ny));
    const double at = edge * across.dot(corner);
    add(dem, [&](double x, double y) { return across.x() * x + across.y() * y > at ? 0.0 : height; });
}

void add_terraces(Dice& dice, Raster& dem) {
    const Vec2 across = direction(dice);
    const double width = dice.between(2.0, 8.0), height = dice.decades(0.05, 5.0);
    add(dem, [&](double x, double y) { return height * std::floor((across.x() * x + across.y() * y) / width); });
}

/// Single pixels, up or down.
void add_pits(Dice& dice, Raster& dem) {
    const Index count = 1 + dice.below(6);
    for (Index n = 0; n < count; ++n) {  // one throw a statement: the order of operands is the compiler's choice
        const Index i = dice.below(dem.geometry.nx);
        const Index j = dice.below(dem.geometry.ny);
        const double up = dice.one_of({-1.0, -1.0, 1.0});
        dem.at(i, j) += up * dem.geometry.cell * dice.decades(0.05, 20.0);
    }
}

void add_noise(Dice& dice, Raster& dem) {
    const double height = dice.decades(1e-4, 1.0);
    add(dem, [&](double, double) { return height * dice.between(-1.0, 1.0); });
}

}  // namespace

void draw_terrain(Dice& dice, Draft& draft) {
    Raster dem = Raster::filled(draw_grid(dice, draft.claims.threads), 0.0);
    if (dice.chance(0.85)) add_plane(dice, dem);
    if (dice.chance(0.3)) add_waves(dice, dem);
    if (dice.chance(0.25)) add_hill(dice, dem);
    if (dice.chance(0.15)) add_cliff(dice, dem);
    if (dice.chance(0.1)) add_terraces(dice, dem);
    if (dice.chance(0.15)) add_pits(dice, dem);
    if (dice.chance(0.2)) add_noise(dice, dem);
    const double base = dice.chance(0.3) ? dice.between(-400.0, 4000.0) : 0.0;
    for (double& z : dem.values) z = single(base + z);
    draft.rasters["dem.tif"] = dem;
    draft.keys["terrain.dem"] = "\"dem.tif\"";
    if (dice.chance(0.1)) draft.keys["terrain.gravity"] = dice.one_of({"1.62", "0.1", "274.0"});
    draft.keys["boundary.sides"] = dice.chance(0.4) ? "\"wall\"" : "\"open\"";
}

void flatten(Draft& draft, double rise) {
    Raster& dem = draft.rasters["dem.tif"];
    const GridGeometry& g = dem.geometry;
    double largest = 0.0;
    for (Index j = 0; j + 1 < g.ny; ++j)
        for (Index i = 0; i + 1 < g.nx; ++i)
            largest = std::max(
                {largest, std::abs(dem.at(i + 1, j) - dem.at(i, j)), std::abs(dem.at(i, j + 1) - dem.at(i, j))});
    if (largest <= rise * g.cell) return;
    const double low = *std::min_element(dem.values.begin(), dem.values.end());
    for (double& z : dem.values) z = single(low + (z - low) * rise * g.cell / largest);
}

void draw_ground(Dice& dice, Draft& draft) {
    draw_terrain(dice, draft);
    const double rise = dice.one_of({0.2, 0.5, 0.8, 1.2, 2.0, 1e9});
    flatten(draft, rise);
}

}  // namespace frana::fuzz
