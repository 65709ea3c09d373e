#pragma once
// All that the invariants read, copied out of a simulation after a step. It is plain data, which a test can falsify.
#include <cstdint>
#include <vector>

#include "run/simulation.h"

namespace frana {
class DepthAveraged;
}

namespace frana::fuzz {

/// A node of the domain near material.
struct NodeState {
    Index i = 0, j = 0;
    bool wet = false;
    double depth = 0.0, bed = 0.0, surface = 0.0;  ///< [m]
    double vx = 0.0, vy = 0.0, speed = 0.0;        ///< along the map, and along the bed on steep terrain [m/s]
    double foot = 0.0;  ///< lowest bed that its surface slopes to: its own, or of a node beside it [m]
};

/// Points of any model, equal lengths.
struct PointStates {
    std::vector<double> x, y;    ///< from the terrain's first node [cells]
    std::vector<double> z;       ///< of 3D points their height, of particles that of their surface [m]
    std::vector<double> vx, vy;  ///< along the map; of the depth-averaged flow half a step behind [m/s]
    std::vector<double> speed;   ///< along the bed or in 3D [m/s]
    std::vector<double> mass;    ///< [kg]
    std::vector<double> depth;   ///< [m]
    std::vector<double> change;  ///< of the velocity across a cell, of particles; else empty [m/s]
    std::vector<double> own;     ///< of the velocity, what the nodes around do not have; with flip, else empty [m/s]
    std::vector<double> id;
    std::vector<std::uint8_t> in_3d;  ///< 1: a 3D point, 0: a particle

    Index count() const { return static_cast<Index>(mass.size()); }
};

struct Snapshot {
    Status between;  ///< as it stands between frames: momentum and impulse half a step behind
    Status now;      ///< as in a frame: all at its time
    PointStates points;
    double max_speed = 0.0;  ///< of particles and of water at `now`, along the bed on steep terrain [m/s]
    std::vector<NodeState> nodes;
    Index not_finite = 0;  ///< numbers of the frame that are not, but for nodes without ground

    /// Of all material, in 3D too [m/s].
    double fastest() const;
};

/// The depth-averaged flow of a run that is nothing else, among barriers or not; nullptr of other runs.
const DepthAveraged* particles_of(const Simulation& simulation);

/// The present state. Looking does not change the run (tests/conserve_runs.cpp).
Snapshot snapshot_of(Simulation& simulation, bool steep);

}  // namespace frana::fuzz
