#pragma once
// When a run is over: what still moves can change the deposit no more. One rule for every model
// (shallow/THEORY.md, 63).
// A run is judged by its deposit on cells. So the question is what would change in as much time again. Material that is
// braked evenly and stops then goes v t / 2, t being the time so far. That is less than a cell when v < 2 cells / t. So
// - the mean speed is below a share of its peak (time.rest_fraction): the flow has been, and is not about to begin;
// - no more than a hundredth of the mass is faster than 2 cells / t;
// - where material lately came for the first time it is slower than that too: no front runs on, however thin;
// - and all this for a twentieth of t, since friction may hold for a moment what goes on.
// Nothing at all in motion is rest at once.
#include "base/types.h"
#include "observe/archive.h"

namespace frana {

class Simulation;

/// What moves at one moment.
struct MovingMass {
    double mass = 0.0;     ///< of all material [kg]
    double moving = 0.0;   ///< of the material faster than the given speed [kg]
    double fastest = 0.0;  ///< of all, along the map [m/s]
    Index fronts = 0;      ///< nodes that are faster too, and were first deeper than the footprint depth after `since`

    double share() const { return mass > 0.0 ? moving / mass : 0.0; }
};

struct MotionQuery {
    double faster_than = 0.0;  ///< speed along the map [m/s]
    double since = 0.0;        ///< [s]
};

class RestRule {
public:
    /// `cell` of the terrain [m]; `fraction` is time.rest_fraction.
    RestRule(double cell, double fraction) : cell_(cell), fraction_(fraction) {}

    /// At the start and after every step. Reads the material only when its mean speed is low, and then at most 140
    /// times while the time doubles. The answer depends on the steps alone, not on the times of frames.
    void note(const Simulation& simulation);
    bool at_rest() const { return nothing_moves_ || rests_; }
    /// What is slower does not count as moving, at a time [s] of the run [m/s].
    double slow_at(double time) const;
    void serialize(Archive& archive);

private:
    bool is_at_rest(const Simulation& simulation) const;

    double cell_, fraction_;
    double peak_mean_speed_ = 0.0;                ///< [m/s]
    double calm_since_ = 0.0, next_check_ = 0.0;  ///< [s]
    bool nothing_moves_ = false, rests_ = false;
};

}  // namespace frana
