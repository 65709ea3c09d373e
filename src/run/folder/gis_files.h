#pragma once
#include <filesystem>
#include <vector>

#include "run/folder/products.h"
#include "run/folder/run_record.h"
#include "scene/scene.h"

namespace frana {

/// What makes a run open well in a GIS, besides its rasters: their styles, results.gpkg and run.qgz. The run is worth
/// more than these: trouble is a warning.
void leave_gis_files(const Scene& scene, const std::filesystem::path& run_dir,
                     const std::vector<ProductRaster>& rasters, RunRecord& record);

}  // namespace frana
