#pragma once
// Holes of an elevation model: nodes without data that the terrain surrounds.
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Nodes without data in connected groups (also by corners), none of which reaches the raster's outer nodes. What does
/// is the outside of the terrain.
struct Holes {
    std::vector<Index> nodes;  ///< of all holes, growing
    Index count = 0;           ///< of holes
    Index largest = 0;         ///< nodes of the largest one
    Index first = -1;          ///< a node of the largest one
};

bool has_nodata(const Raster& bed);
Holes holes_of(const Raster& bed);

/// A remark for the user on mass that was lost in holes, of all that the run had [kg]. Nothing when none was.
std::vector<std::string> remarks_on_lost(double lost, double all);

}  // namespace frana
