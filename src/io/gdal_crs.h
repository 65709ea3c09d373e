#pragma once
// Coordinate reference systems: what the program can compute in, and the command line that makes it so.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/gdal_support.h"

namespace frana::gdal {

/// The CRS that a WKT text describes, x (east) first whatever its authority says. UserError when it is no
/// CRS.
OGRSpatialReference crs_from_wkt(const std::string& wkt);

/// WKT2 of its horizontal part; empty for an empty or local (engineering) CRS.
std::string horizontal_wkt(const OGRSpatialReference& crs);

/// Same horizontal CRS for our purpose: axis order and authority names left aside.
bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b);

/// "EPSG:32632 (WGS 84 / UTM zone 32N)", as much of it as is known.
std::string crs_name(const OGRSpatialReference& crs);

/// Code of the UTM zone (WGS 84) of a longitude and latitude in degrees, beyond 84 degrees the polar
/// stereographic.
int utm_code(double longitude, double latitude);

/// Lengths on the map over lengths on the ground at a place of a projected CRS. The least and the largest of all
/// directions. Nothing where the CRS cannot tell.
std::optional<std::array<double, 2>> map_scale(const OGRSpatialReference& crs, const std::array<double, 2>& place);

/// A raster as far as its CRS is concerned.
struct Place {
    std::filesystem::path file;
    const OGRSpatialReference* crs = nullptr;  ///< null: unknown
    std::array<double, 2> centre{};            ///< of what is used, in the CRS
    std::string band_unit;                     ///< unit of the elevations that the band declares, or empty
    bool scaled = false;                       ///< numbers are stored with a scale or an offset
};

/// Checks that map coordinates (and elevations) are metres. UserError with a gdalwarp or gdal_translate line
/// that cures it. Causes are a geographic CRS, another unit than metre, and a vertical unit other than metre. Others are a
/// unit that is not known, and one of the band that is not that of the CRS's heights. So are lengths on the map that are
/// not those on the ground. Remarks go to `log`.
void require_metres(const Place& place, std::vector<std::string>& log);

/// Checks that numbers of a raster on a terrain, such as depths, are metres. The band's unit counts before that of the
/// CRS's heights. UserError with a line that cures it.
void require_metre_values(const Place& place);

/// Arguments after the program's name of a gdalwarp that leaves no pixel that only seems to be terrain.
std::string warp_line(const std::filesystem::path& file, const std::string& target_crs, const std::string& suffix);

}  // namespace frana::gdal
