#include "stages/growing_columns.h"
#include "stages/staged_run.h"
#include "stages/structured_run.h"
#include "stages/walled_columns.h"

namespace frana {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, Start start) {
    if (scene.structure) return std::make_unique<StructuredRun>(scene, start);
    if (scene.solid) return std::make_unique<StagedRun>(scene, start);
    if (scene.wider) return std::make_unique<GrowingColumns>(scene, start);
    if (scene.barriers.empty()) return std::make_unique<DepthAveraged>(scene, start);
    return std::make_unique<WalledColumns>(scene, start);
}

}  // namespace frana
