#pragma once
// From one CRS to another, by the same operation for rasters and vectors.
#include <ogr_spatialref.h>

#include <array>

#include "io/gdal_support.h"

namespace frana::gdal {

/// For what lies within `extent` (xmin, ymin, xmax, ymax) of `from`. Of several operations, PROJ takes the best one there, as
/// GDALWarp has it. Without a place it may take a coarse one beyond the CRS's own area. Null: no way is known.
Transformation transformation(const OGRSpatialReference& from, const OGRSpatialReference& to,
                              const std::array<double, 4>& extent);

}  // namespace frana::gdal
