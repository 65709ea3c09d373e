// A made-up mountain valley with a lake behind a moraine that is cut through, and a plain below.
#include <algorithm>
#include <cmath>

#include "terrain_scenes.h"

namespace frana {

MadeScene moraine_lake() {
    const double length = 2400.0, width = 700.0, cell = 10.0, dam = 540.0;
    std::vector<double> floor{1500.0};  // elevation down the valley, a cell apart
    for (double x = 0.5 * cell; x < length; x += cell)
        floor.push_back(floor.back() - cell * (0.005 + 0.035 * smooth_step((x - 500.0) / 200.0) -
                                               0.028 * smooth_step((x - 1350.0) / 350.0)));
    const auto axis = [](double x) {
        return 350.0 + 55.0 * std::sin((x - 650.0) / 170.0) * smooth_step((x - 650.0) / 200.0);
    };
    const auto half_width = [](double x) { return 35.0 + 140.0 * smooth_step((x - 1500.0) / 400.0); };
    const auto z = [&](double x, double y) {
        const double across = std::abs(y - axis(x)), on_flank = std::max(0.0, across - half_width(x));
        const double flank = std::hypot(0.6 * on_flank, 12.0) - 12.0;
        const double head = 60.0 * smooth_step((150.0 - x) / 150.0);
        const double along_dam = (x - dam) / 35.0, from_notch = across / 25.0;
        const double moraine = 26.0 * std::exp(-along_dam * along_dam) * (1.0 - std::exp(-std::pow(from_notch, 4)));
        return floor[static_cast<std::size_t>(std::lround(x / cell))] + head + std::max(flank, moraine);
    };
    return {{{"dem.tif", on_nodes(length, width, cell, z)}},
            {{"lake.geojson", {{0.0, 0.0}, {dam, 0.0}, {dam, width}, {0.0, width}}}}};
}

}  // namespace frana
