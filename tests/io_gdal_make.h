#pragma once
// Rasters and vector files of every kind, made with GDAL itself, for the tests of the readers.
#include <gdal_priv.h>

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"

/// A raster file to make. Columns and rows count from the first pixel of the file.
struct RasterSpec {
    int columns = 8, rows = 6;
    std::array<double, 6> transform = {500000.0, 10.0, 0.0, 6000060.0, 0.0, -10.0};  ///< zeros: none
    GDALDataType type = GDT_Float32;
    int bands = 1;
    std::string crs = "EPSG:32632";  ///< empty: none
    std::optional<double> nodata;
    std::string driver = "GTiff";
    std::vector<std::string> options;
    double scale = 1.0, offset = 0.0;
    std::string unit;
    std::function<double(int column, int row)> value = [](int, int) { return 0.0; };  ///< as stored
    std::function<bool(int column, int row)> valid;                                   ///< a mask band, when given
    bool alpha = false;                                                               ///< the last band is alpha
};

/// WKT of a CRS by its code, "EPSG:32632".
std::string wkt_of(const char* code);

/// Makes the file; formats that GDAL cannot create but copy to (ESRI ASCII, COG) are copied from memory.
void make_raster(const std::filesystem::path& file, const RasterSpec& spec);

/// Runs a line of gdalwarp, gdal_translate and gdalbuildvrt commands joined by &&, through GDAL's own parsers
/// of their arguments. File names must be free of blanks.
void run_gdal_line(const std::string& line);

/// The command line in a message: from its first GDAL program to the end, without a remark in brackets.
std::string cure_in(const std::string& message);

/// Message of the UserError that `act` throws; fails the test when it throws none.
std::string user_error(const std::function<void()>& act);

/// What reached stderr while `act` ran.
std::string heard_on_stderr(const std::function<void()>& act);

bool contains(const std::string& text, const std::string& part);
bool any_contains(const std::vector<std::string>& lines, const std::string& part);
