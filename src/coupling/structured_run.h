#pragma once
// A run of solids that hold together (van den Bout et al. 2021), with or without free water, or of water alone. It has
// one model from the start to the end.
#include <array>
#include <optional>

#include "coupling/two_phase_flow.h"
#include "observe/frame_store.h"
#include "run/simulation.h"
#include "scene/scene.h"
#include "structured/breakage.h"
#include "structured/structured_map.h"

namespace frana {

/// The scene of the particles. The bed's slope is by central differences of its nodes, as far as there is ground. Walls
/// and barriers are obstacles.
StructuredScene structured_scene(const Scene& scene);
/// The same with its water, or the water alone. Holds on to `scene` until a flow is made of it.
TwoPhaseScene two_phase_scene(const Scene& scene);

/// The box of a barrier's outline, which the case's reader has found to be one. Nothing for a barrier below the ground.
std::optional<Obstacle> obstacle_of(const Barrier& barrier, const Raster& bed);

class StructuredRun final : public Simulation {
public:
    /// `scene` has a structure, free water, or both.
    explicit StructuredRun(const Scene& scene, Start start = Start::placed);

    void advance(double until) override;
    const Status& status() const override { return status_; }
    double longest_step() const override { return both_ ? both_->longest_step() : alone_->longest_step(); }
    MovingMass motion(const MotionQuery& query) const override;
    /// "stress" is what the structure passes on, its undamaged share; "effective_stress" that and the earth pressure of
    /// grains. "damage" is 0 where intact, 1 where grains; "cohesion" is what is left of it. With water, "depth" of
    /// nodes is that of both, "water_depth" its part. Water alone has none of these, and no particles.
    Frame frame() override;
    std::shared_ptr<const void> give_frame_away() override { return store_.give_away(); }
    Sample at(const Vec2& point) const override;
    bool may_rest() const override;
    bool more_comes() const override;
    std::string why_not_add(const Seeds& particles) const override;
    std::vector<std::string> remarks() const override;
    Extras extras() const override;
    Breakage breakage() const;
    /// Nothing in a dry run.
    std::optional<WaterBudget> water_budget() const;
    /// Nothing without inflows.
    std::optional<InflowBudget> inflow_budget() const;
    std::vector<PhaseTime> timings() const override;
    void serialize(Archive& archive) override;

    const StructuredFlow& flow() const { return both_ ? both_->structured() : *alone_; }
    /// nullptr in a dry run.
    const WaterFlow* water() const { return both_ ? &both_->water() : nullptr; }

private:
    void accumulate();
    void accumulate_water();
    double time() const { return both_ ? both_->time() : alone_->status().time; }
    void particle_fields(Frame& frame);
    void node_fields(Frame& frame);
    void inner_fields(Frame& frame);
    void water_fields(Frame& frame);
    void own_water_fields(Frame& frame);

    void remark_on_low_barriers(std::vector<std::string>& remarks) const;

    Raster bed_;
    std::vector<Barrier> barriers_;
    double water_density_ = 0.0;
    double solid_density_;  ///< of grains [kg/m^3]
    bool solids_;           ///< otherwise there is water alone
    bool inflows_;
    bool aside_ = false;  ///< it shows an output between two of its steps, and comes back to the state before
    std::unique_ptr<StructuredFlow> alone_;  ///< of a dry run
    std::unique_ptr<TwoPhaseFlow> both_;     ///< of one with water
    StructuredMap map_;
    Neighbours neighbours_;  ///< of the start
    StepClock timed_;
    Status status_;
    /// Per node, sums of what particles show times their mass, and of mass.
    struct Inner {
        double stress[3], effective[3], damage, cohesion, mass;
    };
    LazyArray<Inner> inner_;
    FrameStore store_;
};

}  // namespace frana
