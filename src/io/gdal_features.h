#pragma once
// Polygons with attributes, as files of a GIS have them.
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "terrain/raster.h"

namespace frana {

/// What is neither a number nor text (dates, lists) is text.
using Attribute = std::variant<double, long long, std::string>;

struct AttributedPolygon {
    Polygon polygon;
    std::vector<std::pair<std::string, Attribute>> attributes;  ///< those that are given
};

/// The polygons of GdalReader::read_polygons, in its order, each with the attributes of its feature. Remarks go to `log`.
/// UserError as there.
std::vector<AttributedPolygon> read_attributed_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                                                        std::vector<std::string>& log);

/// A GeoPackage of one layer, the same bytes for the same content. An attribute has the type that holds it in all features;
/// names that differ in case only are one. A number that is not finite is left out. UserError when it cannot be written.
void write_attributed_polygons(const std::filesystem::path& gpkg, const std::string& layer, const std::string& crs_wkt,
                               const std::vector<AttributedPolygon>& polygons);

}  // namespace frana
