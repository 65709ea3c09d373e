#include "stages/staged_run.h"

namespace frana {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, Start start) {
    if (scene.solid) return std::make_unique<StagedRun>(scene, start);
    if (scene.barriers.empty()) return std::make_unique<DepthAveraged>(scene, start);
    Scene walled = scene;
    walled.bed = with_barriers(scene);
    return std::make_unique<DepthAveraged>(walled, start);
}

}  // namespace frana
