// The keys of [forest]: trees that take mass out of the flow.
#include "law/detrainment_keys.h"
#include "scene/parameter_makers.h"

namespace frana {

void add_forest(Table& table) {
    using namespace rows;
    constexpr double kMost = 1e4;  // [Pa]; stands have 10 to 150
    Parameter detrainment =
        make("forest.detrainment", Kind::number_or_path, "Pa",
             "K of the forest, or a raster of it: the flow loses K/u in each second on each square metre, with the "
             "speed u that it has; 10 to 150 by stand; no forest where it is 0 or without data");
    detrainment.range = between(0.0, kMost);
    table.push_back(absent(detrainment, "no trees take mass out of the flow"));
    table.push_back(absent(make("forest.outline", Kind::path, "", "polygons outside of which there is no forest"),
                           "forest wherever detrainment is above 0"));
    const auto keys = laws::detrainment_keys();
    table.push_back(absent(of_law("forest.", keys, "max_speed"), "flow of any speed from 0.1 m/s on loses mass"));
    table.push_back(absent(of_law("forest.", keys, "max_depth"), "flow of any depth loses mass"));
}

}  // namespace frana
