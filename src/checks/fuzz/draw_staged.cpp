// Runs in stages: particles first or points from the start, in a window, and particles again.
#include <fmt/core.h>

#include <algorithm>

#include "checks/fuzz/draw.h"
#include "checks/fuzz/draw_3d.h"

namespace frana::fuzz {
namespace {

/// Some nodes of the terrain, three and more each way.
void draw_window(Dice& dice, Draft& draft, const std::string& stage) {
    const GridGeometry& g = draft.dem().geometry;
    const auto span = [&](Index nodes) {
        const Index width = 3 + dice.below(nodes - 3), first = dice.below(nodes - width + 1);
        return std::pair{first, first + width - 1};
    };
    const auto [i0, i1] = span(g.nx);
    const auto [j0, j1] = span(g.ny);
    constexpr double kPast = 0.25;  // of a cell: well around the nodes
    draft.keys[stage + ".window"] =
        fmt::format("[{}, {}, {}, {}]", toml_number(g.x(i0) - kPast * g.cell), toml_number(g.y(j0) - kPast * g.cell),
                    toml_number(g.x(i1) + kPast * g.cell), toml_number(g.y(j1) + kPast * g.cell));
}

}  // namespace

void draw_staged(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    draw_release(dice, draft, {0.15, 3.0, 120});
    draw_bed_law(dice, draft);
    const double step = 0.3 * draft.dem().geometry.cell / scales_of(draft).wave;  // of particles, about [s]
    const bool particles_first = dice.chance(0.7), particles_again = dice.chance(0.4);
    const double begin = particles_first ? step * dice.between(0.5, 12.0) : 0.0;
    const std::string stage = particles_first ? "stage#1" : "stage#0";
    if (particles_first) {
        say(draft, "stage#0.model", "depth_averaged");
        say(draft, "stage#0.until", begin);
    }
    draw_3d(dice, draft, stage);
    if (dice.chance(0.85)) draw_window(dice, draft, stage);
    if (!particles_again) return;
    say(draft, stage + ".until", begin + step * dice.between(0.2, 3.0));
    say(draft, particles_first ? "stage#2.model" : "stage#1.model", "depth_averaged");
}

}  // namespace frana::fuzz
