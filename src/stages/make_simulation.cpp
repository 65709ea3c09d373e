#include "stages/staged_run.h"

namespace frana {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, Start start) {
    if (scene.solid) return std::make_unique<StagedRun>(scene, start);
    return std::make_unique<DepthAveraged>(scene, start);
}

}  // namespace frana
