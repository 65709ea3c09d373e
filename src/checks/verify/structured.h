#pragma once
// Building scenes of structured solids for verification problems, and running them.
#include "checks/verify/problem.h"
#include "structured/structured_flow.h"

namespace frana::verify {

/// A rectangular block, its particles on a lattice from the low corner on.
struct StructuredBlock {
    Vec2 low{0, 0}, high{1, 1};  ///< [m]
    double depth = 1.0;          ///< [m]
    double cohesion = 0.0;       ///< [Pa]
    Vec2 velocity{0, 0};         ///< [m/s]
    double damage = 0.0;         ///< [1]
    int per_side = 2;            ///< particles a cell and direction
};
void add_block(StructuredScene& scene, const StructuredBlock& block);

/// A grid with a node at (0, 0) that holds the box from low to high, with room around.
GridGeometry grid_over(const Vec2& low, const Vec2& high, double cell);

/// Smooth walls at y = low and y = high.
void add_channel(StructuredScene& scene, double low, double high);

/// A run to `end`, timed; calls each(flow) after every step. momentum_residual: what the ledger leaves open,
/// over all momentum that went round.
Measurement run_structured(StructuredFlow& flow, double end,
                           const std::function<void(const StructuredFlow&)>& each = {});

/// Length of all particles along x [m].
double length_of(const StructuredFlow& flow);

}  // namespace frana::verify
