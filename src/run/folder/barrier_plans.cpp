#include "run/folder/barrier_plans.h"

namespace frana {

void add_rings(const std::string& name, const Polygons& outline, std::vector<NamedLine>& plans) {
    for (const Polygon& part : outline.parts)
        for (Polyline ring : part.rings) {
            if (ring.empty()) continue;
            ring.push_back(ring.front());
            plans.push_back({name, ring});
        }
}

std::vector<NamedLine> barrier_plans(const std::vector<Barrier>& barriers) {
    std::vector<NamedLine> plans;
    for (const Barrier& barrier : barriers) {
        add_rings(barrier.name, barrier.outline, plans);
        if (!barrier.line.empty()) plans.push_back({barrier.name, barrier.line});
    }
    return plans;
}

}  // namespace frana
