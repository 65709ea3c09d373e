#pragma once
#include <vector>

#include "scene/scene.h"

namespace frana {

/// Mass that the flow took of the bed that was there at the start [kg]. Material that the flow itself had left does not
/// count. `eroded_depth` [m] is that of the nodes of `part`, a part of the scene's terrain; NaN counts as nothing. 0
/// where the bed is rock.
double taken_of_bed(const Scene& scene, const GridGeometry& part, const std::vector<double>& eroded_depth);

}  // namespace frana
