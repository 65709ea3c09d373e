#pragma once
// A raster of a run as GDAL reads it.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "io/gdal_reader.h"

/// Of a file, all of it; without data NaN.
inline frana::Raster raster_in(const std::filesystem::path& file) {
    std::vector<std::string> log;
    return frana::GdalReader().read_raster(file, {-1e9, -1e9, 1e9, 1e9}, "", log);
}

/// rasters/NAME of a run, a field of the flow: zero where there is terrain and the flow never came, which is nodata in the file.
inline frana::Raster raster_of(const std::filesystem::path& run_dir, const char* name) {
    frana::Raster raster = raster_in(run_dir / "rasters" / name);
    const frana::Raster terrain = raster_in(run_dir / "rasters" / "elevation.tif");
    for (std::size_t k = 0; k < raster.values.size(); ++k)
        if (std::isnan(raster.values[k]) && !std::isnan(terrain.values.at(k))) raster.values[k] = 0.0;
    return raster;
}
