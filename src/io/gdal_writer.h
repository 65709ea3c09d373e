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
/// does not know stand in GDAL's own tag.
using FileTags = std::map<std::string, std::string>;

/// GeoTIFF of one float32 band on the pixels of `raster` (north row first, tiled, DEFLATE with predictor 3),
/// CRS, nodata -9999 for NaN. `unit` ("m", "m/s", "Pa", "s") and `description` become the band's. One with more than
/// kPlainPixels pixels along a side is cloud-optimised (COG): it has overviews, means of the pixels below them. The same bytes for
/// the same content: no date but that of `tags`. Throws NumericsError for a value that is infinite or too large for
/// float32, UserError when the disk refuses.
constexpr Index kPlainPixels = 512;
void write_geotiff(const std::filesystem::path& target, const Raster& raster, const std::string& unit,
                   const std::string& description, const FileTags& tags = {});

/// A class of a raster of classes.
struct RasterClass {
    std::string name;
    std::array<std::uint8_t, 3> colour{};  ///< red, green, blue
};

/// GeoTIFF of one byte band with the numbers of classes, 0 for none, which is nodata; its colour table has the colours, and the
/// names stand beside it in `target`.aux.xml, where GDAL and QGIS look for them. Throws as write_geotiff.
void write_class_geotiff(const std::filesystem::path& target, const GridGeometry& grid, const std::string& crs_wkt,
                         const std::vector<std::uint8_t>& numbers, const std::vector<RasterClass>& classes,
                         const std::string& description);

/// GeoJSON with the outlines, holes kept, of the nodes' pixels deeper than `threshold` [m], largest first.
/// Pixels that touch only at a corner belong to different outlines. Attributes: area_m2, threshold_m and the
/// given ones. Written with a `crs` member when the raster's CRS has an authority's code (what RFC 7946
/// dropped and every GIS still reads). NaN counts as not covered. Throws as write_geotiff.
void write_footprint(const std::filesystem::path& target, const Raster& covered_depth, double threshold,
                     const std::map<std::string, double>& attributes = {});

}  // namespace frana
