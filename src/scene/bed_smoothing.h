#pragma once
// How far the bed's smoothing reaches.
#include "scene/scene.h"

namespace frana {

/// Passes of the binomial filter that smooth a bed to `curvature_length`. Each adds variance cell^2/2 (scheme: sigma =
/// cell sqrt(passes / 2)).
Index smoothing_passes(const Scheme& scheme, double cell);

/// Width around material, in nodes, that its steps depend on, and the way of one step. Material stays so far from the
/// edge of a part.
Index clear_of_edge(const Scene& scene, double cell);

}  // namespace frana
