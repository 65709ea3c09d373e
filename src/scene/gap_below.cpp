#include "scene/gap_below.h"

#include <algorithm>
#include <cmath>

#include "terrain/bed_points.h"

namespace frana {
namespace {

/// How far above a place the solid begins, or infinity.
double room_above(const DistanceField& solid, const Vec3& ground) {
    const double step = 0.5 * solid.spacing, top = solid.end().z();
    double before = solid.contact(ground).distance;
    if (before <= 0.0) return 0.0;
    for (double up = step; ground.z() + up < top + step; up += step) {
        const double here = solid.contact(ground + Vec3(0, 0, up)).distance;
        if (here < 0.0) return up - step * here / (here - before);
        before = here;
    }
    return INFINITY;
}

}  // namespace

Gap gap_below(const DistanceField& solid, const Raster& bed, double least, double most) {
    if (*std::min_element(solid.nodes.begin(), solid.nodes.end()) < 2) return {};
    Gap gap;
    double covered = 0.0, open = 0.0;
    for (Index j = 0; j < solid.nodes[1]; ++j)
        for (Index i = 0; i < solid.nodes[0]; ++i) {
            const Vec3 place = solid.place(i, j, 0);
            const double ground = bilinear(bed, place.head<2>());
            if (!std::isfinite(ground)) continue;
            const double room = room_above(solid, {place.x(), place.y(), ground});
            if (!std::isfinite(room)) continue;
            ++covered;
            if (room < least || room > most) continue;
            ++open;
            gap.height = std::max(gap.height, room);
        }
    if (covered > 0.0) gap.share = open / covered;
    return gap;
}

}  // namespace frana
