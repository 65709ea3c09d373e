// Free water: lakes, rain, waves let go, with little that is solid.
#include <algorithm>

#include "checks/fuzz/draw.h"
#include "checks/fuzz/draw_structure.h"

namespace frana::fuzz {
namespace {

/// Rain that fills a cell by up to a tenth in a step of waves, or a raster of it.
void draw_rate(Dice& dice, Draft& draft, const std::string& key, const std::string& file) {
    const Scales of = scales_of(draft);
    const double rate = of.wave * dice.decades(1e-6, 1e-1);
    if (dice.chance(0.5)) return say(draft, key, rate);
    Raster raster = Raster::filled(draft.dem().geometry, 0.0);
    for (double& value : raster.values) value = single(dice.chance(0.5) ? rate * dice.unit() : 0.0);
    draft.rasters[file] = raster;
    draft.keys[key] = "\"" + file + "\"";
}

}  // namespace

void draw_level(Dice& dice, Draft& draft) {
    double low = INFINITY, high = -INFINITY;
    for (const double z : draft.dem().values) low = std::min(low, z), high = std::max(high, z);
    say(draft, "water.level", low + dice.between(0.05, 1.1) * std::max(high - low, 0.5 * draft.dem().geometry.cell));
}

void draw_free_water(Dice& dice, Draft& draft) {
    say(draft, "water.model", "free");
    const std::string friction = dice.one_of({"none", "manning", "darcy_weisbach"});
    say(draft, "water.friction", friction);
    if (friction == "manning") say(draft, "water.manning_n", dice.decades(1e-3, 1.0));
    if (friction == "darcy_weisbach") say(draft, "water.darcy_f", dice.decades(1e-3, 1.0));
    const std::string viscous = dice.one_of({"none", "none", "clear", "mud"});
    say(draft, "water.viscous", viscous);
    if (dice.chance(0.3)) say(draft, "water.viscosity", dice.decades(1e-4, 10.0));
    if (viscous == "mud") {
        say(draft, "water.mud_alpha", dice.decades(1e-5, 1e-1));
        say(draft, "water.mud_beta", dice.between(6.0, 25.0));
        say(draft, "water.mud_concentration", dice.between(0.05, 0.5));
    }
    if (viscous != "none" && dice.chance(0.3)) {
        draft.keys["water.solid_gradient"] = "true";
        if (dice.chance(0.5)) say(draft, "water.profile_factor", 3.0);
    }
    if (dice.chance(0.5)) say(draft, "water.grain_diameter", dice.decades(1e-5, 0.3));
    if (dice.chance(0.5)) say(draft, "water.block_diameter", dice.decades(1e-2, 3.0));
    if (dice.chance(0.3)) say(draft, "water.drag", "unsplit");
    if (dice.chance(0.3)) draft.keys["water.drag_power"] = "1";
    if (dice.chance(0.4)) say(draft, "water.virtual_mass", dice.one_of({"bounded", "unbounded"}));
    if (dice.chance(0.3)) say(draft, "water.pore_pressure", dice.between(0.0, 1.0));
    if (dice.chance(0.3)) say(draft, "water.void_ratio", dice.decades(0.1, 3.0));
}

void draw_water(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    const bool wave = dice.chance(0.4);  // most of what is let go is water
    draw_release(dice, draft, {0.02, 3.0, wave ? 200 : 2});
    draw_structure(dice, draft);
    draw_free_water(dice, draft);
    if (wave) say(draft, "water.share", dice.between(0.8, 0.99));
    if (!wave || dice.chance(0.3)) draw_level(dice, draft);
    if (dice.chance(0.4)) draw_rate(dice, draft, "water.rain", "rain.tif");
    if (dice.chance(0.3)) draw_rate(dice, draft, "water.infiltration", "soak.tif");
}

namespace {

/// Each side a wall, free, or at a level.
void draw_sides(Dice& dice, Draft& draft) {
    double low = INFINITY, high = -INFINITY;
    for (const double z : draft.dem().values) low = std::min(low, z), high = std::max(high, z);
    for (const char* side : {"west", "east", "south", "north"}) {
        const std::string key = std::string("water.sides.") + side;
        const double kind = dice.unit(), level = low + dice.between(-0.2, 1.0) * std::max(high - low, 0.1);
        if (kind < 0.2) say(draft, key, "wall");
        if (kind >= 0.2 && kind < 0.5) say(draft, key, "free");
        if (kind >= 0.5 && kind < 0.7) say(draft, key, level);
    }
}

}  // namespace

void draw_flood(Dice& dice, Draft& draft) {
    draw_ground(dice, draft);
    draw_release(dice, draft, {0.02, 3.0, 200});
    say(draft, "water.model", "free");
    const std::string friction = dice.one_of({"none", "manning", "darcy_weisbach"});
    say(draft, "water.friction", friction);
    if (friction == "manning") say(draft, "water.manning_n", dice.decades(1e-3, 1.0));
    if (friction == "darcy_weisbach") say(draft, "water.darcy_f", dice.decades(1e-3, 1.0));
    if (dice.chance(0.2)) say(draft, "water.viscous", "clear"), say(draft, "water.viscosity", dice.decades(1e-4, 10.0));
    if (dice.chance(0.5)) draw_level(dice, draft);
    if (dice.chance(0.3)) draw_rate(dice, draft, "water.rain", "rain.tif");
    if (dice.chance(0.3)) draw_rate(dice, draft, "water.infiltration", "soak.tif");
    if (dice.chance(0.5)) draw_inflow(dice, draft);
    if (dice.chance(0.3)) draw_spring(dice, draft);
    if (dice.chance(0.6)) draw_sides(dice, draft);
}

}  // namespace frana::fuzz
