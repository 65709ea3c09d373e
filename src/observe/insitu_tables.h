#pragma once
// Works of [[insitu]] that leave a table.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "observe/insitu.h"
#include "observe/scalar.h"

namespace frana {

/// Values of a node field at a point of the map, bilinear. NaN outside the grid or next to a node without a value.
double value_at(const Scalar& nodes, const GridGeometry& grid, const Vec2& point);

/// A cut along a line: t [s], distance [m], x [m], y [m], bed [m], then the fields with their units. Stations are half
/// a cell apart, and rows are added at every sample. Empty cells where there is no terrain.
std::unique_ptr<InsituWork> make_cut_table(const std::filesystem::path& csv, const Polyline& line,
                                           const std::vector<std::string>& fields);

/// One row a sample over the nodes that are deeper than `above` [m]: t [s], area [m2] (their pixels), volume [m3]
/// (depth times pixel). Of each field it has min, max, where the largest is (x, y) and the mean over the area. Empty
/// cells when no node is that deep.
std::unique_ptr<InsituWork> make_reduction(const std::filesystem::path& csv, const std::vector<std::string>& fields,
                                           double above);

}  // namespace frana
