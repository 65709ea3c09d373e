#pragma once
// How QGIS is to show what a run leaves: the colours of the pictures, ranges, units. QGIS 3.22's XML.
#include <filesystem>
#include <string>
#include <vector>

#include "base/colour.h"
#include "run/folder/products.h"

namespace frana {

/// Text as XML has it.
std::string xml(const std::string& text);

/// The `<pipe>` of a raster. Elevations are a hillshade. Other values have steps over the range of the report's
/// pictures (map_range.h), signed ones to either side of grey. Depths below `limit`
/// fade out. Labels have units, kPa for Pa.
std::string raster_pipe(const ProductRaster& product, const ProductRaster* peak_depth, double limit);

/// The `<renderer-v2>` of shapes: lines, outlines of polygons, or points, of one colour.
enum class Shapes { lines, outlines, points };
std::string shape_renderer(Shapes shapes, const Colour& colour, double millimetres, bool dashed = false);
constexpr double kOutline = 0.5;  ///< width of outlines on a map [mm]

/// rasters/NAME.qml next to each raster, and footprint.qml. QGIS reads them with the files next to them. Throws
/// UserError.
void write_styles(const std::filesystem::path& run_dir, const std::vector<ProductRaster>& rasters, double limit);

}  // namespace frana
