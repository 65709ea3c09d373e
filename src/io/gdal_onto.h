#pragma once
// From a raster file onto the nodes of a grid, in the CRS of the file.
#include "io/gdal_raster_file.h"

namespace frana::gdal {

/// Values at the nodes of `grid` (see resample); all NaN where the file has no pixels. Reads only what it
/// needs.
std::vector<double> onto_grid(const RasterFile& file, const GridGeometry& grid);

/// "5 m pixels averaged to 10 m cells", "10 m pixels interpolated (cubic) to 5 m cells", ...
std::string how_resampled(const RasterFile& file, double cell);

/// "[xmin, ymin, xmax, ymax]" with as many digits as needed.
std::string extent_text(const std::array<double, 4>& extent);

}  // namespace frana::gdal
