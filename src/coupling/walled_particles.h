#pragma once
// Particles among barriers: they take them for ground, and what runs up and over is watched.
#include "coupling/particle_watch.h"
#include "coupling/terrain_particles.h"

namespace frana {

class WalledParticles final : public WrappedSimulation {
public:
    explicit WalledParticles(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    /// Without faces: no force is known.
    const BarrierLoads* loads() const override { return &watch_.loads(); }
    std::vector<std::string> remarks() const override;
    std::vector<PhaseTime> timings() const override;
    void serialize(Archive& archive) override;

    DepthAveraged& particles() const { return terrain_->particles(); }

private:
    Simulation& inner() const override { return *terrain_; }

    double density_;
    std::unique_ptr<TerrainParticles> terrain_;
    ParticleWatch watch_;
    StepClock timed_;
};

}  // namespace frana
