#include "coupling/growing_particles.h"
#include "coupling/particle_watch.h"
#include "coupling/staged_run.h"
#include "coupling/structured_run.h"
#include "coupling/walled_particles.h"

namespace frana {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, Start start) {
    if (scene.structure || scene.water) return std::make_unique<StructuredRun>(scene, start);
    if (scene.solid) return std::make_unique<StagedRun>(scene, start);
    if (!scene.barriers.empty()) return std::make_unique<WalledParticles>(scene, start);
    if (scene.wider) return std::make_unique<GrowingParticles>(scene, start);
    return std::make_unique<DepthAveraged>(scene, start);
}

std::vector<std::string> remarks_on_barriers(const Scene& scene) {
    if (scene.barriers.empty() || scene.structure || scene.solid || scene.water) return {};
    return ParticleWatch(scene).remarks();
}

}  // namespace frana
