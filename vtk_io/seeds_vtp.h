#pragma once
#include <filesystem>

#include "particles/export.h"

namespace frana {

/// Particles as vtkPolyData (.vtp, LZ4 in inline base64): points on the free surface (bed elevation + depth),
/// one vertex cell per particle. Point arrays are depth, elevation, size, volume, mass, velocity (3) and id. The unit
/// of array `name` is in the field data as `name_unit`, with density [kg/m3] and crs_wkt. The file appears whole or not
/// at all. Throws UserError when it cannot be written.
void write_seeds_vtp(const std::filesystem::path& file, const SeedsExport& data);

}  // namespace frana
