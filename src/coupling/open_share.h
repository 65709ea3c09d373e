#pragma once
// How much room barriers and closed sides leave 3D points around the nodes of the terrain.
#include <vector>

#include "scene/scene.h"

namespace frana {

/// The share that points can fill of what each node stands for, bilinear, row after row [1]. Barriers that stand out of
/// the ground take the rest. So does what lies beyond walls of the terrain and closed sides of the stage's window. 1
/// where next to nothing is left: what is found there stands on top.
std::vector<double> open_shares(const Scene& scene);

}  // namespace frana
