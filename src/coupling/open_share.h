#pragma once
// How much room barriers and closed sides leave 3D points around the nodes of the terrain.
#include <vector>

#include "scene/scene.h"

namespace frana {

/// Of what each node stands for, bilinear, the share that points can fill, row after row [1]: barriers that stand out of the
/// ground take the rest, and what lies beyond walls of the terrain and closed sides of the stage's window. 1 where next to nothing is left: what is
/// found there stands on top.
std::vector<double> open_shares(const Scene& scene);

}  // namespace frana
