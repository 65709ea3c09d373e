#pragma once
#include <filesystem>

#include "terrain_scenes.h"

namespace frana {

/// Writes a raster as GeoTIFF of float64 pixels, deflated, without CRS (the ground is made up). The pixel centres are
/// the raster's nodes. NaN is written as such and declared as nodata. UserError with GDAL's reason.
void write_made_raster(const std::filesystem::path& file, const Raster& raster);

/// Writes outlines as GeoJSON in map coordinates, a feature each. UserError when the file cannot be written.
void write_made_outline(const std::filesystem::path& file, const MadeOutline& outline);

/// All files of a scene into a folder, which is made if need be.
void write_scene(const MadeScene& scene, const std::filesystem::path& folder);

}  // namespace frana
