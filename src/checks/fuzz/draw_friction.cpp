// Spatially varying friction of a random case: of its bed law, its rheology or its water.
#include <algorithm>
#include <cmath>

#include "checks/fuzz/draw.h"
#include "scene/law_places.h"
#include "scene/parameters.h"

namespace frana::fuzz {
namespace {

/// A number that the draft gives and that may vary spatially.
struct Placed {
    const Parameter* key;
    std::string in_zone;  ///< its name there
};

std::vector<Placed> numbers_of_laws(const Draft& draft) {
    std::vector<Placed> all;
    for (const LawPlace& place : kLawPlaces)
        for (const Parameter& key : parameters())
            if (key.switch_key == place.choice && key.kind == Kind::number_or_path && draft.has(key.key))
                all.push_back({&key, place.in_zone + key.name()});
    return all;
}

/// "rheology.viscosity" -> "rheology_viscosity.tif".
std::string file_of(std::string name) {
    std::replace(name.begin(), name.end(), '.', '_');
    return name + ".tif";
}

}  // namespace

void draw_friction(Dice& dice, Draft& draft) {
    if (draft.claims.rests || draft.claims.mirror != Mirror::none) return;
    const std::vector<Placed> numbers = numbers_of_laws(draft);
    if (numbers.empty() || draft.has("material.bed.mu_s")) return;  // of mu_s and mu_2 one has to be larger
    const Placed& placed = numbers[static_cast<std::size_t>(dice.below(static_cast<Index>(numbers.size())))];
    const Parameter& key = *placed.key;
    const double usual = std::stod(draft.keys.at(key.key));
    const std::vector<double>& heights = draft.dem().values;
    const double height = heights[static_cast<std::size_t>(dice.below(static_cast<Index>(heights.size())))];
    if (dice.chance(0.5) && std::isfinite(height)) {
        say(draft, "material.zone#0.above", height);
        say(draft, "material.zone#0." + placed.in_zone, std::min(usual * dice.decades(0.1, 10.0), key.range.high));
        return;
    }
    Raster map = Raster::filled(draft.dem().geometry, 0.0);
    for (double& value : map.values) value = single(usual * dice.decades(0.1, 1.0));
    draft.rasters[file_of(placed.in_zone)] = map;
    draft.keys[key.key] = "\"" + file_of(placed.in_zone) + "\"";
}

}  // namespace frana::fuzz
