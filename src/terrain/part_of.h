#pragma once
#include <optional>

#include "terrain/raster.h"

namespace frana {

/// Where the nodes of `grid` are among those of `whole`; some may lie beyond. Nothing when they are not the same nodes, to
/// round-off.
std::optional<NodeBox> box_of(const GridGeometry& grid, const GridGeometry& whole);

/// A raster on other nodes of its grid: those of `box`, beyond its own without values.
Raster part_of(const Raster& raster, const NodeBox& box);

}  // namespace frana
