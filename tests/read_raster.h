#pragma once
// A raster of a run as GDAL reads it.
#include <algorithm>
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

/// How far the bed at the end of a run is from `before` and its change, at most [m].
inline double off_its_change(const frana::Raster& before, const std::filesystem::path& run_dir) {
    const frana::Raster after = raster_of(run_dir, "final_elevation.tif"),
                        change = raster_of(run_dir, "bed_change.tif");
    double most = 0.0;
    for (std::size_t k = 0; k < before.values.size(); ++k)
        most = std::max(most, std::abs(after.values.at(k) - before.values[k] - change.values.at(k)));
    return most;
}
