#pragma once
// How far the bed's smoothing reaches.
#include "scene/scene.h"

namespace frana {

/// Passes of the binomial filter that smooth a bed to `curvature_length`. Each adds variance cell^2/2 (scheme: sigma =
/// cell sqrt(passes / 2)).
Index smoothing_passes(const Scheme& scheme, double cell);

/// Nodes around material that its steps depend on, and a step's way: so far it stays from the edge of a part.
Index clear_of_edge(const Scene& scene, double cell);

}  // namespace frana
