#include "run/folder/barrier_plans.h"

namespace frana {

std::vector<NamedLine> barrier_plans(const std::vector<Barrier>& barriers) {
    std::vector<NamedLine> plans;
    for (const Barrier& barrier : barriers) {
        for (const Polygon& part : barrier.outline.parts)
            for (Polyline ring : part.rings) {
                if (ring.empty()) continue;
                ring.push_back(ring.front());
                plans.push_back({barrier.name, ring});
            }
        if (!barrier.line.empty()) plans.push_back({barrier.name, barrier.line});
    }
    return plans;
}

}  // namespace frana
