// The keys of [water]: free water beside solids that hold together.
#include "scene/parameter_makers.h"

namespace frana {

void add_water(Table& table) {
    using namespace rows;
    const char* const model = "water.model";
    const auto used = [&](Parameter parameter) { return with(std::move(parameter), model, {"free"}); };
    table.push_back(choice(model, {"none", "free"}, "none",
                           "free: water on the grid that drags, bears and drains the columns of material.structure"));
    table.push_back(used(number("water.share", "1", {0.0, 1.0, false, true}, 0.0,
                                "share of each release's volume that is free water in its pores; the columns have the rest")));
    table.push_back(absent(used(number("water.level", "m", any,
                                       "elevation of a lake at rest at the start, wherever the ground lies lower")),
                           "no lake"));
    table.push_back(used(number("water.rain", "m/s", not_negative, 0.0, "rain on all of the terrain; 1 mm/h is 2.8e-7")));
    table.push_back(used(number("water.infiltration", "m/s", not_negative, 0.0, "what the ground takes of free water at most")));
    table.push_back(used(choice("water.friction", {"none", "manning", "darcy_weisbach"}, "none", "friction of water at the bed")));
    table.push_back(with(number("water.manning_n", "s/m^(1/3)", above_to(0.0, 1.0), "Manning's roughness"), "water.friction",
                         {"manning"}, {"manning"}));
    table.push_back(with(number("water.darcy_f", "1", positive, "Darcy and Weisbach's factor"), "water.friction",
                         {"darcy_weisbach"}, {"darcy_weisbach"}));
    table.push_back(used(number("water.density", "kg/m^3", positive, 1000.0, "of the water, confined or free")));
    table.push_back(used(number("water.viscosity", "Pa s", positive, 1e-3, "of the water, for grains that settle in it")));
    table.push_back(used(number("water.grain_diameter", "m", positive, 1e-3, "of grains, for their drag")));
    table.push_back(used(number("water.block_diameter", "m", positive, 0.1, "of blocks of what has structure, for their drag")));
    Parameter power = make("water.drag_power", Kind::integer, "1", "drag grows with the slip (1) or with its square (2)");
    power.range = between(1.0, 2.0);
    power.fallback = 2.0;
    table.push_back(used(power));
    table.push_back(used(choice("water.virtual_mass", {"none", "bounded", "unbounded"}, "none",
                                "water that solids speed up with them: Pudasaini and Mergili (2019), or Pudasaini (2012), "
                                "which grows without bound where there is little water")));
    table.push_back(used(number("water.pore_pressure", "1", fraction, 1.0,
                                "share of the pores' pressure that bears the columns on the bed where pores are full")));
    table.push_back(used(number("water.void_ratio", "1", positive, 0.67,
                                "free water over grains and their confined water that fills the pores")));
}

}  // namespace frana
