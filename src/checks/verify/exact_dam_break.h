#pragma once
// Dam breaks on flat ground: dry (Ritter 1892) and wet (Stoker 1957).
#include <vector>

#include "checks/verify/problem.h"

namespace frana::verify {

/// State at a ratio s = (x - x_dam) / t [m/s].
struct WaveState {
    double depth, velocity;
};

/// Water of depth hl behind a dam, dry bed before it.
struct Ritter {
    double hl, g = 9.81;
    WaveState at(double s) const;
    double front() const;  ///< speed of the tip [m/s]
};

/// Water of depth hl behind a dam, hr before it, 0 < hr < hl: fan, middle state, shock.
class Stoker {
public:
    Stoker(double left, double right, double gravity = 9.81);
    WaveState at(double s) const;
    double hl, hr, g;
    double hm, um;  ///< middle state [m], [m/s]
    double shock;   ///< speed [m/s]
    /// Jump conditions of mass and momentum, the fan's invariant, and the state at the fan's foot.
    std::vector<Residual> residuals() const;
};

}  // namespace frana::verify
