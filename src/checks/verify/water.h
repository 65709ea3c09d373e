#pragma once
// Building scenes of free water for verification problems, running them, and holding them against exact
// fields.
#include "checks/verify/problem.h"
#include "water/water_flow.h"

namespace frana::verify {

/// A grid of nx * ny cells whose low corner is (0, 0): nodes stand in the middle of cells.
GridGeometry cells_over(Index nx, Index ny, double cell);

/// The mean of f >= 0 over a cell, by the midpoints of 8 * 8 parts.
double cell_mean(const Function& f, double x, double y, double cell);

/// A run to `end`, timed; calls each(flow) after every step. Fills steps, points (cells that hold water at
/// the end), mass_error and momentum_residual. That is what the ledger leaves open, over all momentum that went round.
Measurement run_water(WaterFlow& flow, double end, const std::function<void(const WaterFlow&)>& each = {});

/// Exact fields; without velocities there is no norm of momentum.
struct ExactWater {
    Function depth, u = {}, v = {};
};
void add_norms(const WaterFlow& flow, const ExactWater& exact, Measurement& m);

/// Energy over density, level 0 being that of the elevations [m^5/s^2]
double energy_of(const WaterFlow& flow);

}  // namespace frana::verify
