#pragma once
// run.qgz: a project of QGIS that shows a run.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "io/gdal_features.h"
#include "run/folder/products.h"

namespace frana {

/// What a project shows.
struct MapProject {
    std::string title;
    std::string crs_wkt;
    std::array<double, 4> extent{};  ///< xmin, ymin, xmax, ymax at first [m]
    double limit = 0.1;              ///< depth below which flow fades out [m]
};

/// run.qgz in the run's folder, of rasters/NAME.tif and the layers of results.gpkg that have shapes. Its groups are
/// Results (peak depth on), Input (with the terrain as hillshade, under all) and Survey. Paths are relative. The same
/// bytes for the same run. Throws UserError.
void write_project(const std::filesystem::path& run_dir, const MapProject& project,
                   const std::vector<ProductRaster>& rasters, const std::vector<ShapeLayer>& layers);

}  // namespace frana
