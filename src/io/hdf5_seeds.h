#pragma once
#include <filesystem>

#include "particles/export.h"

namespace frana {

/// Particles as HDF5: datasets position (N, 2), velocity (N, 2), elevation, depth, size, volume, mass (N) in
/// double and id (N) in int64. Each has a string attribute `unit`. Root attributes are format, count, density [kg/m3],
/// density_unit, crs_wkt. The file appears whole or not at all.
/// Throws UserError when it cannot be written.
void write_seeds_hdf5(const std::filesystem::path& file, const SeedsExport& data);

}  // namespace frana
