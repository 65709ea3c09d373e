#pragma once
#include "coupling/footings.h"

namespace frana::test {

/// The bed as depth-averaged particles meet it: where a node lies in a barrier, or within half a cell of it, it rises to the
/// barrier's top.
inline Raster with_barriers(Scene scene) {
    stand_in(scene, barrier_nodes(scene), 0, 0);
    return scene.bed;
}

}  // namespace frana::test
