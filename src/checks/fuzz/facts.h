#pragma once
// What of a scene decides on which invariants hold, and how well.
#include <limits>

#include "checks/fuzz/draft.h"
#include "run/simulation.h"

namespace frana::fuzz {

/// What of a scene decides on which invariants hold, and how well.
struct Facts {
    Claims claims;
    double gravity = 9.81;  ///< [m/s^2]
    Index nodes_x = 0, nodes_y = 0;
    bool walls = false;
    bool steep = true;
    /// The model itself conserves V^2/2 + g z along a path. Shallow terrain always does (speeds along the map). Steep
    /// terrain does where the Hessian that the scheme uses bends the path as the slopes do. There the flow must be thin
    /// against the radius of curvature (whose pressure is none of gravity). Elsewhere a path along a bent bed changes
    /// its speed along the bed. The factor is `stretch` = sqrt(1 + B^2) between level and steepest.
    bool energy_law = true;
    bool bed_energy = false;  ///< it has one but for what it exchanges with the bed, whose energy is recorded
    double stretch = 1.0;
    double release_depth = 0.0;   ///< largest of the release; nodes have it averaged over a cell and more [m]
    double release_energy = 0.0;  ///< that its depth alone could set free [J]
    /// Of release_energy, what the nodes do not have at the start, as they average depths over a cell and more [J].
    double hidden_energy = 0.0;
    /// Structured particles: stress is by the depth that they carry, so that all of release_energy is there. With grains
    /// velocities are half a step behind, at frames too.
    bool structured = false;
    double loose = 0.0;                                                ///< deepest that an erodible bed may sink [m]
    double inflow_speed = 0.0;                                         ///< fastest that comes in later [m/s]
    double highest_inflow = -std::numeric_limits<double>::infinity();  ///< its highest surface [m]
    bool erodes = false;                                               ///< the flow takes up its bed
    bool linear = false;                                               ///< linear shape functions
    double turn = 0.0;           ///< largest change of the slope across a cell that turns velocities [1]
    bool affine = false;         ///< points bring the nodes a velocity that changes along the gradient they carry
    bool carried_depth = false;  ///< pressure is that of the depth which points carry, not of the nodes' (paper preset)
    double one_cell_drop = 0.0;  ///< largest difference of the bed between neighbouring nodes [m]
    double cell = 1.0;           ///< [m]
    double steepest = 0.0;       ///< largest slope of the bed that a velocity follows; none on shallow terrain [1]
    bool lake = false;
    double level_error = 0.0;      ///< of a lake: how far its surface is off the level at the start [m]
    double level_round_off = 0.0;  ///< of elevations, depths and their sum in a lake [m]
    double one_cell_bend = 0.0;    ///< largest second difference of the bed between neighbouring nodes [m]
    double density = 0.0;          ///< of the particles or points [kg/m^3]
    bool all_in_points = true;     ///< no mass but that of points: no free water, nothing on its way between two models
    bool in_3d = false;            ///< 3D points, some of the time
    double cell_3d = 0.0;          ///< of their grid [m]
    bool cancels = false;       ///< impulses of weight and pressure are recorded each, and cancel where material rests
    double displaces = 0.0;     ///< weight of the water that particles can displace [N]
    double bears = 1.0;         ///< share of that which bears them (WaterExchange::pore_pressure) [1]
    double drained_drop = 0.0;  ///< fall of free water that has left a cell but for a film [m]
    bool virtual_mass = false;  ///< particles carry water's inertia: they part from it by what a step gets wrong
    double highest_rain = -std::numeric_limits<double>::infinity();  ///< highest ground that rain falls on [m]
};
/// Of a simulation that make_simulation() made of `scene` and that has not moved.
Facts facts_of(const Scene& scene, const Simulation& simulation, const Claims& claims);

}  // namespace frana::fuzz
