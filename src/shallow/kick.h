#pragma once
// The nodes' part of a step: `kick` (free-surface gradient, bed slope and curvature, artificial viscosity, stress)
// and bed friction. Bed law and terrain model become types once, at the start.
#include <memory>

#include "shallow/flow.h"

namespace frana {

/// Sums over nodes, made tile by tile in a fixed order.
struct KickSums {
    double kinetic = 0.0;          ///< after the kick, along the bed [J]
    double dissipated = 0.0;       ///< by bed friction in this kick [J]
    double impulse_x = 0.0, impulse_y = 0.0;  ///< of all nodal forces in this kick [kg m/s]
    double max_signal = 0.0;       ///< largest |v| + sqrt(g_c h) on nodes [m/s]
};

class KickKernel {
public:
    virtual ~KickKernel() = default;
    /// Velocities of all wet nodes after `dt` [s], from Nodes::before to Nodes::motion, for a drift that takes `drift`
    /// [s]. Walks the tiles that are stirred (rest.h). Only writes motion, and where it is (Rest::moving), so it may be repeated (output uses half a step and no drift).
    virtual KickSums kick(Flow& flow, double dt, double drift) = 0;
    /// Whether the nodes of a tile, all at rest, would stay so in a kick of any length.
    virtual bool holds(const Flow& flow, Index tile) const = 0;
};

std::unique_ptr<KickKernel> make_kick(const Scene& scene);

}  // namespace frana
