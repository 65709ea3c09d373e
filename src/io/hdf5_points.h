#pragma once
#include <filesystem>

#include "base/point_table.h"

namespace frana {

/// Points as HDF5: a dataset per column, (N) or (N, components), in double, and id (N) in int64, each with a string
/// attribute `unit`; root attributes format, count, crs_wkt, the table's texts, and its constants with NAME_unit. The
/// file appears whole or not at all. Throws UserError when it cannot be written, InternalError on a number that is not
/// finite.
void write_points_hdf5(const std::filesystem::path& file, const PointTable& table);

}  // namespace frana
