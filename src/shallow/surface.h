#pragma once
// From the deposited mass to the free surface: `depth_pass`, `mark_margin`, `filter`, `shoreline` (margin extrapolation).
// The margin comes last: a filter that saw extrapolated values would feed them back and make a shore unstable.
// After these a lake at rest has one and the same surface number on every wet node.
#include <algorithm>

#include "shallow/flow.h"

namespace frana {

/// How far a surface that rises by `rise` where the bed rises by `ground` follows it. 1 is a film on a slope, 0 a lake.
inline double film_share(double rise, double ground) {
    return std::clamp(4.0 * rise * ground / (ground * ground + 1e-6) - 2.0, 0.0, 1.0);
}

/// Sums over nodes, made tile by tile in a fixed order.
struct NodeSums {
    double potential = 0.0;     ///< sum of rho g A h (z + h/2) [J]
    double max_depth = 0.0;     ///< [m]
    double covered_area = 0.0;  ///< deeper than the footprint depth [m2]
    double front2 = 0.0;        ///< squared largest distance of such a node from `centre` [m2]
};

/// What depth_pass needs beyond the flow.
struct DepthRequest {
    double footprint_depth;  ///< [m]
    Vec2 centre;             ///< of the release, in cells
};

/// Nodal depth h = column mass / (rho A), wetness, surface = z + h (z where dry), velocity before the grid update = P /
/// M. Wetness is decided by the depth alone: nodes that only sub-points reach have depth and no momentum.
NodeSums depth_pass(Flow& flow, const DepthRequest& request);

/// Flags the wet nodes that have a dry one within two layers. Also flags those with five wet nodes in a row in x or y.
void mark_margin(Flow& flow);

/// Wet nodes near a dry one have depth and bed averaged over partly dry supports, which lifts h + z. Their
/// surface is extrapolated from the inside in three sweeps, never above h + z, never below the bed nearby. The most by
/// which it is lowered is a sum of two. One is the lift by ground that emerges around the node, the other the depth
/// that it is given.
void shoreline(Flow& flow);

/// Removes the 2-cell wave from the surface where five wet nodes away from the margin stand in a row. It is exact on
/// linear surfaces. Held back at bores (shock_pass), where that wave must stay visible to the pressure that undoes it.
void filter(Flow& flow);

/// Ghost nodes beyond walls take the surface, depth and wetness of their mirror nodes.
void mirror_surface(Flow& flow);

}  // namespace frana
