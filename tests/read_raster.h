#pragma once
// A raster of a run as GDAL reads it.
#include <filesystem>
#include <string>
#include <vector>

#include "io/gdal_reader.h"

/// Of a file, all of it; without data NaN.
inline frana::Raster raster_in(const std::filesystem::path& file) {
    std::vector<std::string> log;
    return frana::GdalReader().read_raster(file, {-1e9, -1e9, 1e9, 1e9}, "", log);
}

/// rasters/NAME of a run.
inline frana::Raster raster_of(const std::filesystem::path& run_dir, const char* name) {
    return raster_in(run_dir / "rasters" / name);
}
