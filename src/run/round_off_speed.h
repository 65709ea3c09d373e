#pragma once
// How fast water at rest may be by rounding alone.

namespace frana {

class Simulation;

/// Where nothing is faster [m/s]: v^2 / 2 of it is the round-off of g h, h being the greatest depth. Water at rest may get
/// as fast by rounding alone. 0 where something is faster, and of material, which may creep.
double round_off_speed(const Simulation& simulation);

}  // namespace frana
