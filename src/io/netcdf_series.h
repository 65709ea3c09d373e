#pragma once
// The flow through time as one file that xarray, Panoply, QGIS and ParaView open.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "observe/observer.h"

namespace frana {

/// Observer that writes series.nc in `run_dir` at the end of the run: netCDF-4 by the conventions CF-1.8. At every
/// output it has depth [m], speed, velocity_x and velocity_y [m s-1] as float32 with shape (time, y, x), compressed.
/// The south row comes first, and -9999 stands where nothing lies. Of these only the ones whose field (depth, speed,
/// velocity) is in `fields`; empty: all. Time is in seconds since 2000-01-01, which stands for the start of the run.
/// `elevation` (y, x) is the bed of the last frame. Where the bed can change, bed_change (time, y, x) has what it has gained
/// since the start, 0 where nothing. Until the end it holds all wet nodes of all outputs, 24 bytes a node, and 12 for each
/// whose bed has changed, also in each checkpoint. A file that the disk refuses is a line in `warnings`, which have to stay
/// as long. Throws
/// UserError where GDAL cannot write the format, NumericsError for a number that is not finite.
std::unique_ptr<Observer> make_netcdf_writer(const std::filesystem::path& run_dir, const std::string& title,
                                             const std::string& crs_wkt, const std::vector<std::string>& fields,
                                             std::vector<std::string>& warnings);

}  // namespace frana
