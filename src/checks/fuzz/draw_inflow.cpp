// What comes into a random case through a line, or over an area.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"

namespace frana::fuzz {
namespace {

constexpr Index kInside = 7;  ///< cells from the edge of the terrain and from holes, of a line

/// Whether ground lies as far around a place, in cells.
bool has_ground(const Raster& dem, const Vec2& at, Index reach = kInside) {
    const auto i0 = static_cast<Index>(std::lround(at.x())), j0 = static_cast<Index>(std::lround(at.y()));
    for (Index j = j0 - reach; j <= j0 + reach; ++j)
        for (Index i = i0 - reach; i <= i0 + reach; ++i)
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

void draw_spring(Dice& dice, Draft& draft) {
    if (draft.claims.rests || draft.claims.mirror != Mirror::none || draft.has("scheme.preset")) return;
    const Raster& dem = draft.dem();
    const double cell = dem.geometry.cell, radius = dice.decades(1.5, 8.0);  // [cells]
    const Vec2 middle(dice.between(0.1, 0.9) * static_cast<double>(dem.geometry.nx - 1),
                      dice.between(0.1, 0.9) * static_cast<double>(dem.geometry.ny - 1));
    const Index corners = 3 + dice.below(4);
    const double volume = radius * radius * dice.decades(1e-3, 1.0) * cell * cell * cell;
    if (!has_ground(dem, middle, static_cast<Index>(std::ceil(radius)) + 1)) return;
    std::string ring;
    for (Index k = 0; k < corners; ++k) {
        const double turn = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(corners);
        const Vec2 corner = middle + dice.between(0.7, 1.0) * radius * Vec2(std::cos(turn), std::sin(turn));
        ring += (k > 0 ? ", " : "") + toml_point(dem, corner);
    }
    const std::string table = draft.has("inflow#0.name") ? "inflow#1." : "inflow#0.";
    say(draft, table + "name", "spring");
    draft.keys[table + "area"] = "[" + ring + "]";
    say(draft, table + "volume", volume);
}

}  // namespace frana::fuzz
