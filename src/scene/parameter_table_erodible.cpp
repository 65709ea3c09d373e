// The keys of [erodible]: loose material on the bed that the flow can take up. Its laws bring their own.
#include "law/catalogue.h"
#include "law/erosion/laws.h"
#include "scene/parameter_makers.h"

namespace frana {

void add_erodible(Table& table) {
    using namespace rows;
    using Laws = laws::Catalogue<ErosionLaw>;
    const char* const law = "erodible.law";
    const std::vector<std::string> words = Laws::words();
    std::vector<std::string> choices = {"none"};
    choices.insert(choices.end(), words.begin(), words.end());
    const auto used = [&](Parameter parameter) { return with(std::move(parameter), law, words); };
    table.push_back(
        choice(law, choices, "none",
               "how the flow takes up its bed. growth: by a share of its mass on each metre; steady: in each "
               "second; shear: at a rate, down to what the basal stress allows; energy: by the work of "
               "friction; jump: by the stress that the bed cannot bear; front: what lies in its way; mechanical: by "
               "the shear velocity of the stress that the bed does not hold"));
    Parameter depth =
        make("erodible.depth", Kind::number_or_path, "m",
             "depth of loose material along gravity, or a raster of it; rock where that is 0 or without data");
    depth.range = not_negative;
    table.push_back(with(depth, law, words, words));
    table.push_back(
        absent(used(make("erodible.outline", Kind::path, "",
                         "polygons outside of which the bed is rock; front needs them, or a raster of depth")),
               "loose material on all of the terrain"));
    table.push_back(absent(used(number("erodible.density", "kg/m^3", positive, "density of the loose material")),
                           "that of the flow, material.density"));
    for (const laws::SharedKey& key : Laws::keys()) {
        const std::string name = "erodible." + key.name;
        Parameter row = number(name.c_str(), key.unit.c_str(), key.range, key.meaning.c_str());
        if (key.usual) row.fallback = *key.usual;
        table.push_back(with(row, law, key.used_by, key.needed_by));
    }
    table.push_back(used(
        number("erodible.momentum", "1", fraction, 0.0,
               "share of the flow's velocity that what is taken up has at once: with 0 the friction law is the bed's "
               "resistance, with 1 it is the stress at the flow's base; never more than friction takes meanwhile")));
    table.push_back(
        used(number("erodible.min_depth", "m", not_negative, 0.05, "of the flow, below which nothing is taken")));
    table.push_back(
        used(flag("erodible.bed_evolves", true,
                  "the ground sinks by what is taken; false: it stays, and what is taken is only counted")));
}

}  // namespace frana
