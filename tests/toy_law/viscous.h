#pragma once
#include <vector>

#include "law/bed/key.h"
#include "law/friction_step.h"

namespace frana::bed {

/// A law that no model has, for the test of how a law is added: tau = mu sigma_n + rho h rate |V|.
struct Viscous {
    double mu = 0.0;    ///< [1]
    double rate = 0.5;  ///< [1/s]

    static constexpr const char* name = "viscous";
    static constexpr const char* is = "a toy";
    static std::vector<Key<Viscous>> keys() {
        return {friction_angle(&Viscous::mu),
                friction(&Viscous::mu),
                {&Viscous::rate, "drag_rate", "1/s", ranges::positive, "rate at which drag slows it", Missing::usual}};
    }
    double friction_at_rest() const { return mu; }

    /// Exact for a constant drive: ds/dt = drive - mu N / kappa - rate s.
    double speed_after(const BedState& bed, double s0, double driven, double dt) const {
        const double left = std::exp(-rate * dt), gain = driven - s0 - dt * mu * bed.normal_gravity;
        return std::max(s0 * left + gain * (1.0 - left) / (rate * dt), 0.0);
    }
};

}  // namespace frana::bed
