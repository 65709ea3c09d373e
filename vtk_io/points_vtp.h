#pragma once
#include <filesystem>

#include "base/point_table.h"

namespace frana {

/// Points as vtkPolyData (.vtp, LZ4 in inline base64). `places` holds x, y, z per point [m], each with a vertex cell.
/// Point arrays are every column but "position", and id. Pairs get a third component of zero, since VTK's vectors have
/// three. Six components are a symmetric tensor xx, yy, zz, xy, yz, xz as VTK counts them. The unit of array `name` is
/// in the field data as `name_unit`, with the constants, the texts and crs_wkt. The file appears whole or not at all.
/// Throws UserError when it cannot be written, InternalError on a number that is not finite.
void write_points_vtp(const std::filesystem::path& file, const PointTable& table, const double* places);

}  // namespace frana
