// The keys of [water]: free water, together with solids that hold together or alone.
#include "law/water_friction.h"
#include "law/water_keys.h"
#include "scene/parameter_makers.h"

namespace frana {

namespace {

void add_water_sides(Table& table) {
    using namespace rows;
    for (const char* side : {"west", "east", "south", "north"}) {
        Parameter parameter = make(
            "", Kind::number_or_choice, "m",
            "that side of the terrain for free water: wall; free: as if the channel went on, so still water on level "
            "ground stays; or the elevation of a lake beyond: what flows in has its energy; where that is below the "
            "ground, water falls out");
        parameter.key = std::string("water.sides.") + side;
        parameter.range = any_number;
        parameter.choices = {"wall", "free"};
        table.push_back(absent(with(parameter, "water.model", {"free"}), "boundary.sides decides"));
    }
}

}  // namespace

void add_water(Table& table) {
    using namespace rows;
    const char* const model = "water.model";
    const auto of = [](const auto& keys, const char* name) { return of_law("water.", keys, name); };
    const auto phases = laws::two_phase_keys();
    const auto exchange = laws::water_exchange_keys();
    const auto viscosity = laws::water_viscosity_keys();
    const auto used = [&](Parameter parameter) { return with(std::move(parameter), model, {"free"}); };
    table.push_back(choice(model, {"none", "free"}, "none",
                           "free: water on the grid. With material.structure it drags, bears and drains its particles; "
                           "without, all that is released and comes in is water"));
    table.push_back(
        used(number("water.share", "1", {0.0, 1.0, false, true}, 0.0,
                    "share of each release's volume that is free water in its pores; the particles have the rest")));
    table.push_back(absent(
        used(number("water.level", "m", any_number,
                    "elevation of a lake at rest at the start, wherever the ground lies lower; it "
                    "goes on beyond open sides that it meets. With water alone a depth that is released adds to it")),
        "no lake"));
    table.push_back(absent(used(make("water.level_within", Kind::path, "",
                                     "polygons that lake lies within, any OGR vector file; beyond sides it does not "
                                     "go on then")),
                           "wherever the ground is lower"));
    add_water_sides(table);
    const auto rate = [&](const char* key, const char* meaning) {
        Parameter parameter = make(key, Kind::number_or_path, "m/s", meaning);
        parameter.range = not_negative;
        parameter.fallback = 0.0;
        table.push_back(used(parameter));
    };
    rate("water.rain", "rain, or a raster of it; 1 mm/h is 2.8e-7");
    rate("water.infiltration", "what the ground takes of free water at most, or a raster of it");
    table.push_back(
        used(choice(kWaterPlace.choice, laws::Catalogue<WaterLaw>::words(), "none", "friction of water at the bed")));
    add_numbers<WaterLaw>(table, kWaterPlace);
    table.push_back(used(of(phases, "density")));
    table.push_back(used(of(phases, "viscosity")));
    table.push_back(
        used(choice("water.viscous", {"none", "clear", "mud"}, "none",
                    "viscosity that the flow of the water feels at the bed and inside: none, that of clear water, "
                    "or mud_alpha exp(mud_beta mud_concentration) (O'Brien and Julien 1988), in which grains then "
                    "settle as well")));
    const auto viscous = [](Parameter parameter, std::vector<std::string> by, std::vector<std::string> needed = {}) {
        return with(std::move(parameter), "water.viscous", std::move(by), std::move(needed));
    };
    table.push_back(
        viscous(number("water.mud_alpha", "Pa s", positive, "of mud; tables often have poise, which is 0.1 Pa s"),
                {"mud"}, {"mud"}));
    table.push_back(viscous(number("water.mud_beta", "1", between(0.0, 100.0), "of mud, 6 to 33"), {"mud"}, {"mud"}));
    table.push_back(viscous(number("water.mud_concentration", "1", {0.0, 1.0, false, true},
                                   "share of fines in the volume of the free water"),
                            {"mud"}, {"mud"}));
    table.push_back(viscous(of(viscosity, "bed_shear"), {"clear", "mud"}));
    table.push_back(used(of(phases, "grain_diameter")));
    table.push_back(used(of(phases, "block_diameter")));
    table.push_back(
        viscous(flag("water.solid_gradient", false,
                     "viscous stress of water that slips along a gradient of the particles' share (van den Bout et "
                     "al. 2021, eq. 30); it takes no energy by itself and may feed slip"),
                {"clear", "mud"}));
    table.push_back(viscous(of(viscosity, "profile_factor"), {"clear", "mud"}));
    table.push_back(
        used(choice("water.drag", {"split", "unsplit"}, "split",
                    "split: blocks of what holds together and grains have each their own (van den Bout et al. "
                    "2021, eq. 31); unsplit: all solids drag as grains in all of the water (Pudasaini 2012)")));
    Parameter power =
        make("water.drag_power", Kind::integer, "1", "drag grows with the slip (1) or with its square (2)");
    power.range = between(1.0, 2.0);
    power.fallback = static_cast<double>(TwoPhaseMaterial{}.power);
    table.push_back(used(power));
    table.push_back(
        used(choice("water.virtual_mass", {"none", "bounded", "unbounded"}, "none",
                    "water that solids speed up with them: Pudasaini and Mergili (2019), or Pudasaini (2012), "
                    "which grows without bound where there is little water")));
    table.push_back(used(of(exchange, "pore_pressure")));
    table.push_back(used(of(exchange, "void_ratio")));
}

}  // namespace frana
