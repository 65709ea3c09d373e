#pragma once
// Which nodes of a grid stand for what has an outline in the map.
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// From the nearest place of an outline to a point [m]; zero inside, and without an outline.
Vec2 away_from(const Polygons& outline, const Vec2& point);

/// The same outside, in front of a side; none where a corner is nearest. In an outline and on its sides they are the
/// directions that the nearest sides face.
std::vector<Vec2> out_of(const Polygons& outline, const Vec2& point, double cell);

/// For each node of the grid, row after row: 1 in the outline or within half a cell of it. A strip thinner than a cell
/// counts as a cell thick: else its nodes meet at corners only where it is askew, and ground raised at them sags to half
/// between them. The cost is that of the grid times the sides.
std::vector<char> nodes_of_outline(const Polygons& outline, const GridGeometry& grid);

/// Of the nodes that a polygon stands on, or of its corners where it lies between nodes [m]; infinity where it has no
/// ground.
double lowest_ground(const Polygon& polygon, const Raster& bed);

}  // namespace frana
