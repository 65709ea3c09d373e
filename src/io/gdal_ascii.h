#pragma once
#include "io/gdal_support.h"

namespace frana::gdal {

/// Refuses a raster written as text (Arc/Info and GRASS ASCII grids, XYZ) that holds anything but numbers. GDAL takes a
/// word for 0 and says nothing. Other rasters pass. UserError with the line and the word.
void require_numbers(const std::filesystem::path& file, GDALDataset& dataset);

}  // namespace frana::gdal
