#pragma once
// The nodes' part of a step: `braking` (free-surface gradient, bed slope and curvature, artificial viscosity, stress)
// and bed friction. Bed law and terrain model become types once, at the start.
#include <memory>

#include "shallow/flow.h"

namespace frana {

/// Sums over nodes, made tile by tile in a fixed order.
struct GridUpdateSums {
    double kinetic = 0.0;                     ///< after the grid update, along the bed [J]
    double dissipated = 0.0;                  ///< by bed friction in this grid update [J]
    double impulse_x = 0.0, impulse_y = 0.0;  ///< of all nodal forces in this grid update [kg m/s]
    double max_signal = 0.0;                  ///< largest |v| + sqrt(g_c h) on nodes [m/s]
};

class GridUpdateKernel {
public:
    virtual ~GridUpdateKernel() = default;
    /// Velocities of all wet nodes after `dt` [s], from Nodes::before to Nodes::motion, for a drift that takes `drift`
    /// [s]. Goes over the tiles that are active (rest.h). Only writes motion, and where it is (Rest::moving). So it may
    /// be repeated (output uses half a step and no drift).
    virtual GridUpdateSums update(Flow& flow, double dt, double drift) = 0;
    /// Whether the nodes of a tile, all at rest, would stay so in a grid update of any length.
    virtual bool holds(const Flow& flow, Index tile) const = 0;
};

std::unique_ptr<GridUpdateKernel> make_grid_update(const Scene& scene);

}  // namespace frana
