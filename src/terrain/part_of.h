#pragma once
#include <optional>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// Where the nodes of `grid` are among those of `whole`; some may lie beyond. Nothing when they are not the same
/// nodes, to round-off.
std::optional<NodeBox> box_of(const GridGeometry& grid, const GridGeometry& whole);

/// A raster on other nodes of its grid: those of `box`, beyond its own without values.
Raster part_of(const Raster& raster, const NodeBox& box);

/// The smallest box that holds both; a box without nodes holds nothing.
NodeBox united(const NodeBox& a, const NodeBox& b);
NodeBox common(const NodeBox& a, const NodeBox& b);
NodeBox widened(const NodeBox& box, Index more);
/// The cells of a grid that hold the points; some may lie beyond it.
NodeBox cells_of(const std::vector<Vec2>& points, const GridGeometry& grid);

}  // namespace frana
