// Friction of a random case that differs in space.
#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"
#include "scene/parameters.h"

namespace frana::stress {
namespace {

/// Numbers of the bed law that are given and may be rasters.
std::vector<const Parameter*> numbers_of_law(const Draft& draft) {
    std::vector<const Parameter*> all;
    for (const Parameter& key : parameters())
        if (key.table() == "material.bed" && key.kind == Kind::number_or_path && draft.has(key.key))
            all.push_back(&key);
    return all;
}

}  // namespace

void draw_friction(Dice& dice, Draft& draft) {
    if (draft.claims.rests || draft.claims.mirror != Mirror::none) return;
    const std::vector<const Parameter*> numbers = numbers_of_law(draft);
    if (numbers.empty() || draft.has("material.bed.mu_s")) return;  // of mu_s and mu_2 one has to be larger
    const Parameter& key = *numbers[static_cast<std::size_t>(dice.below(static_cast<Index>(numbers.size())))];
    const double usual = std::stod(draft.keys.at(key.key));
    const std::vector<double>& heights = draft.dem().values;
    const double height = heights[static_cast<std::size_t>(dice.below(static_cast<Index>(heights.size())))];
    if (dice.chance(0.5) && std::isfinite(height)) {
        say(draft, "material.zone#0.above", height);
        const std::string name = key.key.substr(key.key.rfind('.') + 1);
        say(draft, "material.zone#0." + name, std::min(usual * dice.decades(0.1, 10.0), key.range.high));
        return;
    }
    Raster map = Raster::filled(draft.dem().geometry, 0.0);
    for (double& value : map.values) value = single(usual * dice.decades(0.1, 1.0));
    draft.rasters["friction.tif"] = map;
    draft.keys[key.key] = "\"friction.tif\"";
}

}  // namespace frana::stress
