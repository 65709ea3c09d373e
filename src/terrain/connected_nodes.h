#pragma once
// Nodes of a grid that touch one another.
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Takes the marked nodes that are connected with `first`, also by corners, out of the marks (one for each node of the grid).
/// They come in the order in which they were found. None where `first` is not marked.
std::vector<Index> take_connected(const GridGeometry& grid, std::vector<char>& marked, Index first);

}  // namespace frana
