// What comes into a random case through a line.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"

namespace frana::stress {
namespace {

constexpr Index kInside = 7;  ///< cells from the edge of the terrain and from holes

/// Whether ground lies as far around a place, in cells, as an inflow needs it.
bool has_ground(const Raster& dem, const Vec2& at) {
    const auto i0 = static_cast<Index>(std::lround(at.x())), j0 = static_cast<Index>(std::lround(at.y()));
    for (Index j = j0 - kInside; j <= j0 + kInside; ++j)
        for (Index i = i0 - kInside; i <= i0 + kInside; ++i)
            if (i < 0 || j < 0 || i >= dem.geometry.nx || j >= dem.geometry.ny || std::isnan(dem.at(i, j)))
                return false;
    return true;
}

bool has_ground_along(const Raster& dem, const Vec2& a, const Vec2& b) {
    constexpr int kParts = 20;  // of lines of eight cells at most: half a cell each
    for (int n = 0; n <= kParts; ++n)
        if (!has_ground(dem, a + (b - a) * (static_cast<double>(n) / kParts))) return false;
    return true;
}

std::string toml_point(const Raster& dem, const Vec2& cells) {
    const GridGeometry& g = dem.geometry;
    return fmt::format("[{}, {}]", toml_number(g.x0 + g.cell * cells.x()), toml_number(g.y0 + g.cell * cells.y()));
}

}  // namespace

void draw_inflow(Dice& dice, Draft& draft) {
    if (draft.claims.rests || draft.claims.mirror != Mirror::none || draft.has("scheme.preset")) return;
    const Raster& dem = draft.dem();
    const double cell = dem.geometry.cell, turn = dice.between(0.0, 6.283185307179586), half = dice.between(0.6, 4.0);
    const Vec2 middle(dice.between(0.3, 0.7) * static_cast<double>(dem.geometry.nx - 1),
                      dice.between(0.3, 0.7) * static_cast<double>(dem.geometry.ny - 1));
    const Vec2 along(std::cos(turn), std::sin(turn)), across(-along.y(), along.x());
    const Vec2 a = middle - half * along, b = middle + half * along;
    const double volume = 10.0 * dice.decades(0.1, 10.0) * cell * cell * cell;
    const double speed = dice.decades(0.1, 4.0) * std::sqrt(9.81 * cell);
    if (!has_ground_along(dem, a, b)) return;
    say(draft, "inflow#0.name", "fuzz");
    draft.keys["inflow#0.line"] = fmt::format("[{}, {}]", toml_point(dem, a), toml_point(dem, b));
    draft.keys["inflow#0.towards"] = toml_point(dem, middle + across);
    say(draft, "inflow#0.volume", volume);
    say(draft, "inflow#0.velocity", speed);
}

}  // namespace frana::stress
