#pragma once
// Structured particles and free water on one grid: a mass of rock and water as it breaks and drains. Or the water
// alone.
#include "structured/structured_flow.h"
#include "water/water_flow.h"

namespace frana {

struct TwoPhaseScene {
    StructuredScene structured;
    WaterScene water;  ///< on the same grid; its depth at the start is free water, above the particles where both are
    WaterExchange exchange;
    bool alone = false;  ///< there are no particles, nor will be
};

/// Steps of the water, each followed by as many of the particles as elastic waves need. In those the water stands still
/// but for what it exchanges with the particles at their nodes. That is momentum, exactly, and what they release.
class TwoPhaseFlow {
public:
    explicit TwoPhaseFlow(const TwoPhaseScene& scene);

    /// One step of the water and those of the particles, never past `until` [s].
    void advance(double until);
    /// Length at most of the next step; 0 where nothing bounds it [s].
    double longest_step() const;
    const StructuredFlow& structured() const { return structured_; }
    /// The particles' timings() tell CPU time too from now on.
    void count_cpu_time() { structured_.count_cpu_time(); }
    const WaterFlow& water() const { return water_; }
    double time() const { return water_.status().time; }
    /// Whether there is the water only: the particles then take no steps.
    bool alone() const { return alone_; }
    /// Steps of the particles for each of the water, so far.
    double sub_cycles() const;
    /// Water now, confined and free, and lost, less what was given [m^3]: round-off
    double volume_residual() const;
    double volume_given() const { return volume_given_; }
    /// In particles, now [m^3].
    double confined() const;
    /// Of the water over its density: energies of height and of motion along the ground [m^5/s^2]. Also the sum of
    /// volume times speed [m^4/s].
    double water_potential() const { return potential_; }
    double water_kinetic() const { return kinetic_; }
    /// Saves the state between two steps, or restores it with all its bits, in a flow of the same scene.
    void serialize(Archive& archive);

private:
    void move_particles();
    void confine();
    void mix();
    void touch(const std::vector<Index>& tiles);
    void update_totals();
    double step_of_particles() const;

    StructuredFlow structured_;
    WaterFlow water_;
    bool alone_;
    std::vector<Index> confined_;       ///< tiles where the water lies on particles
    std::vector<Index> reached_tiles_;  ///< tiles where particles were since the last step of the water
    std::vector<Index> scratch_;
    double volume_given_ = 0.0, potential_ = 0.0, kinetic_ = 0.0;
};

}  // namespace frana
