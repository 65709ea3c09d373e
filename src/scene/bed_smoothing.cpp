#include "scene/bed_smoothing.h"

#include <algorithm>
#include <cmath>

namespace frana {

Index smoothing_passes(const Scheme& scheme, double cell) {
    const double length = scheme.curvature_length;
    return std::min<Index>(static_cast<Index>(std::lround(2.0 * length * length / (cell * cell))), 400);
}

Index clear_of_edge(const Scene& scene, double cell) {
    constexpr Index kStencils = 16;  // shape function, slopes, lowest neighbour; what points touch
    constexpr Index kWay = 16;       // of a step, and of what moved since tiles were listed
    const bool smooth = scene.terrain != TerrainModel::shallow;
    return kStencils + kWay + (smooth ? smoothing_passes(scene.scheme, cell) : 0);
}

}  // namespace frana
