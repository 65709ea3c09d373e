#pragma once
// Particles among barriers: they take them for ground, and what runs up and over is watched.
#include "coupling/footings.h"
#include "coupling/growing_particles.h"
#include "coupling/particle_watch.h"

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

    DepthAveraged& particles() const { return growing_ ? growing_->particles() : *whole_; }

private:
    Simulation& inner() const override {
        if (growing_) return *growing_;
        return *whole_;
    }

    void hold_all(Scene scene, Start start);

    double density_;
    Footings footings_;                          ///< of barriers on all of the terrain
    std::unique_ptr<DepthAveraged> whole_;       ///< on all of the terrain
    std::unique_ptr<GrowingParticles> growing_;  ///< or on a part of it
    ParticleWatch watch_;
    StepClock timed_;
};

}  // namespace frana
