#pragma once
// The gradient of the free surface at a node: fourth order inside the flow, towards the wet side at shores.
#include <cmath>
#include <limits>

#include "base/simd.h"
#include "shallow/surface.h"

namespace frana {

constexpr double kSurfaceRoundOff = 64.0 * std::numeric_limits<double>::epsilon();  ///< of a surface's height

/// Slope of the free surface at a node with material, along one axis. Uniform depth gives the bed's own slope, a lake gives
/// zero, whatever the bed. A dry neighbour that stands higher is a shore and takes no part. A dry neighbour that lies
/// lower enters with its bed, and drives the front. What is as high but for round-off lies lower. A margin's surface
/// often ends on the adjacent ground (z_min), and whether that takes part is a factor of two. One-sided, a film that
/// follows a curved bed takes the bed's own slope at the node. (The difference to a side has the slope of half a cell
/// away.) `slope`: that of the bed.
inline double raw_gradient(const Flow& flow, Index k, Index step, bool wide, double slope) {
    const Nodes& nodes = flow.nodes;
    const double *e = nodes.surface.data() + k, *z = flow.bed.z.data() + k, cell = flow.cell;
    if (wide) return (8.0 * (e[step] - e[-step]) - (e[2 * step] - e[-2 * step])) / (12.0 * cell);
    const double same = kSurfaceRoundOff * std::abs(e[0]);
    const auto shore = [&](Index n) { return !(nodes.flags[k + n] & kWet) && e[n] - e[0] > same; };
    const bool ahead = shore(step), behind = shore(-step);
    const auto to_side = [&](Index n) {
        const double rise = (e[n] - e[0]) / cell, ground = (z[n] - z[0]) / cell;
        return rise + film_share(rise, ground) * ((n > 0 ? slope : -slope) - ground);
    };
    if (ahead && !behind) return -to_side(-step);
    if (behind && !ahead) return to_side(step);
    return ((ahead ? 0.0 : e[step] - e[0]) - (behind ? 0.0 : e[-step] - e[0])) / (2.0 * cell);
}

/// The same without the round-off of the surface's own height. A difference of some units in the last place over a cell
/// is none. So a lake rests to the last bit.
inline double surface_gradient(const Flow& flow, Index k, Index step, bool wide, double bed_slope) {
    const double slope = raw_gradient(flow, k, step, wide, bed_slope);
    return std::abs(slope) * flow.cell <= kSurfaceRoundOff * std::abs(flow.nodes.surface[k]) ? 0.0 : slope;
}

/// The same for four nodes in a row, all wide.
[[gnu::always_inline]] inline Double4 wide_gradients(const Flow& flow, Index k, Index step) {
    const double* e = flow.nodes.surface.data() + k;
    const Double4 none = {},
                  slope = (8.0 * (load(e + step) - load(e - step)) - (load(e + 2 * step) - load(e - 2 * step))) /
                          (12.0 * flow.cell);
    return select(abs(slope) * flow.cell <= kSurfaceRoundOff * abs(load(e)), none, slope);
}

}  // namespace frana
