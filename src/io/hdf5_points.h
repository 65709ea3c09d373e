#pragma once
#include <filesystem>

#include "base/point_table.h"
#include "convert/solid_points.h"

namespace frana {

/// Points as HDF5: a dataset per column, (N) or (N, components), in double, and id (N) in int64. Each has a string
/// attribute `unit`. Root attributes are format, count, crs_wkt, the table's texts, and its constants with NAME_unit.
/// The file appears whole or not at all. Throws UserError when it cannot be written, InternalError on a number that is
/// not finite.
void write_points_hdf5(const std::filesystem::path& file, const PointTable& table);

/// 3D points of any program that writes position (N, 3) [m], velocity (N, 3) [m/s], mass (N) [kg] and volume (N) [m3]
/// as above. A pressure (N) [Pa] is taken when there is one. The other arrays of the result stay empty. Throws
/// UserError when the file cannot be read, lacks one of them, or holds a number impossible for a point.
SolidPoints read_points_hdf5(const std::filesystem::path& file);

}  // namespace frana
