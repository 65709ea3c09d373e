// A bed that the flow of a random case can take up.
#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"
#include "scene/parameters.h"

namespace frana::fuzz {
namespace {

/// Rock here and there, and depths that jump from pixel to pixel; or even.
void draw_layer(Dice& dice, Draft& draft, double deepest, bool even) {
    Raster layer = Raster::filled(draft.dem().geometry, even ? single(deepest) : 0.0);
    for (double& depth : layer.values)
        if (!even && dice.chance(0.7)) depth = single(dice.chance(0.5) ? deepest : dice.between(0.0, deepest));
    draft.rasters["loose.tif"] = layer;
    draft.keys["erodible.depth"] = "\"loose.tif\"";
}

}  // namespace

void draw_erodible(Dice& dice, Draft& draft) {
    const bool other_scheme = draft.has("scheme.preset") || draft.has("scheme.shape");
    if (draft.claims.rests || other_scheme) return;
    const Parameter& law = *find_parameter("erodible.law");
    const std::string word =
        law.choices[1 + static_cast<std::size_t>(dice.below(static_cast<Index>(law.choices.size()) - 1))];
    say(draft, "erodible.law", word);
    const double deepest = dice.decades(1e-3, 0.3) * draft.dem().geometry.cell;
    const bool even = draft.claims.mirror != Mirror::none || dice.chance(0.4);
    if (even && word != "front")  // which needs an outline or a raster
        say(draft, "erodible.depth", deepest);
    else
        draw_layer(dice, draft, deepest, even);
    for (const Parameter& key : parameters()) {
        if (key.table() != "erodible" || std::count(key.used_by.begin(), key.used_by.end(), word) == 0) continue;
        if (key.kind != Kind::number || key.range.high < 1e300) continue;
        const bool needed = std::count(key.required_by.begin(), key.required_by.end(), word) > 0;
        if (needed)
            say(draft, key.key, dice.decades(1e-5, 10.0));
        else if (key.fallback && dice.chance(0.5))
            say(draft, key.key, std::get<double>(*key.fallback) * dice.decades(1e-3, 1e3));
    }
    if (dice.chance(0.5)) say(draft, "erodible.momentum", dice.one_of({0.5, 1.0, dice.unit()}));
    if (dice.chance(0.3)) say(draft, "erodible.density", dice.decades(100.0, 3000.0));
    if (dice.chance(0.7)) say(draft, "erodible.min_depth", 0.0);
    if (dice.chance(0.2)) draft.keys["erodible.bed_evolves"] = "false";
}

void draw_deposition(Dice& dice, Draft& draft) {
    const bool other_scheme = draft.has("scheme.preset") || draft.has("scheme.shape");
    const bool mirrored = draft.claims.mirror != Mirror::none;  // round-off tells in which step a node stops
    if (draft.claims.rests || mirrored || other_scheme || draft.has("erodible.bed_evolves")) return;
    say(draft, "deposition.law", "rest");
    say(draft, "deposition.time", dice.chance(0.5) ? 0.0 : dice.decades(1e-3, 10.0));
}

}  // namespace frana::fuzz
