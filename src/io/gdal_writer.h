#pragma once
// Rasters and outlines for a GIS. Files appear whole or not at all; nothing that is not finite is written.
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// What a file says of where it comes from, by GDAL's names: TIFFTAG_SOFTWARE, TIFFTAG_DOCUMENTNAME, ... Those that TIFF
/// does not have stand in GDAL's own tag.
using FileTags = std::map<std::string, std::string>;

/// GeoTIFF of one float32 band on the pixels of `raster` (north row first, tiled, DEFLATE with predictor 3). It has the
/// CRS, and nodata -9999 for NaN. `unit` ("m", "m/s", "Pa", "s") and `description` become the band's. One with more
/// than kPlainPixels pixels along a side is cloud-optimised (COG). It has overviews, means of the pixels below them.
/// The same bytes for the same content: no date but that of `tags`. Throws NumericsError for a value that is infinite
/// or too large for float32, UserError when the disk refuses.
constexpr Index kPlainPixels = 512;
void write_geotiff(const std::filesystem::path& target, const Raster& raster, const std::string& unit,
                   const std::string& description, const FileTags& tags = {});

/// A class of a raster of classes.
struct RasterClass {
    std::string name;
    std::array<std::uint8_t, 3> colour{};  ///< red, green, blue
};

/// GeoTIFF of one byte band with the numbers of classes, 0 for none, which is nodata. Its colour table has the colours.
/// The names are in `target`.aux.xml, which GDAL and QGIS read. Throws as write_geotiff.
void write_class_geotiff(const std::filesystem::path& target, const GridGeometry& grid, const std::string& crs_wkt,
                         const std::vector<std::uint8_t>& numbers, const std::vector<RasterClass>& classes,
                         const std::string& description);

/// GeoJSON with the outlines of the nodes' pixels deeper than `threshold` [m], with holes, largest first. Pixels that
/// touch only at a corner belong to different outlines. Attributes: area_m2, threshold_m and the given ones. It has a
/// `crs` member when the raster's CRS has an authority's code. RFC 7946 dropped that member, and every GIS still reads
/// it. Without a code the outlines are in longitude and latitude of WGS 84, as that standard asks for. NaN counts as not
/// covered. Throws as write_geotiff.
void write_footprint(const std::filesystem::path& target, const Raster& covered_depth, double threshold,
                     const std::map<std::string, double>& attributes = {});

/// Such a file of the pixels with at least each of `levels` of a field, level by level. Attributes: area_m2, and `name`
/// with the level, all > 0. Throws as write_geotiff.
void write_levels(const std::filesystem::path& target, const Raster& field, const std::string& name,
                  const std::vector<double>& levels);

/// How such a file places its outlines: in a CRS that it names, in degrees, or in unnamed coordinates of the map. A GIS
/// takes those for degrees. They are left where there is no CRS, or none that PROJ can bring to degrees.
enum class FootprintPlace { named, degrees, unnamed };
FootprintPlace footprint_place(const std::string& crs_wkt);

}  // namespace frana
