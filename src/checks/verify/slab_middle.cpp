#include "checks/verify/slab_middle.h"

#include <cmath>

namespace frana::verify {

SlabState middle_of(Trial& trial, double middle, double cosine) {
    const Seeds& seeds = trial.scene().particles;
    const double reach = 2.0 * trial.scene().bed.geometry.cell;
    const Frame frame = trial.simulation().frame();
    const double *place = frame.particle("position")->data, *speed = frame.particle("speed")->data;
    const double *thickness = frame.particle("thickness")->data, *id = frame.particle("id")->data;
    SlabState sum{};
    double count = 0.0;
    for (Index p = 0; p < frame.particle("id")->count; ++p) {
        const Index first = static_cast<Index>(id[p]);
        if (first >= seeds.count() || std::abs(seeds.x[first] - middle) > reach) continue;
        sum.speed += speed[p], sum.thickness += thickness[p], sum.way += (place[3 * p] - seeds.x[first]) / cosine;
        count += 1.0;
    }
    return {sum.speed / count, sum.way / count, sum.thickness / count};
}

}  // namespace frana::verify
