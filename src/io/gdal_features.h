#pragma once
// Shapes with attributes, as files of a GIS have them.
#include <cstdint>
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

/// A polygon, a line, a point or several polygons of the map with what is known of it.
struct AttributedShape {
    std::variant<Polygon, Polyline, Vec2, Polygons> shape;
    std::vector<std::pair<std::string, Attribute>> attributes;
};

/// Shapes of one kind; polygons go with several of them.
struct ShapeLayer {
    std::string name;
    std::vector<AttributedShape> shapes;
};

/// Outlines with holes of the nodes' pixels that `inside` marks, largest first, each with its area_m2. Pixels that
/// touch only at a corner belong to different ones.
std::vector<AttributedShape> pixel_outlines(const GridGeometry& grid, std::vector<std::uint8_t> inside);

/// A GeoPackage, the same bytes for the same content; layers without shapes are left out. An attribute has the type that
/// holds it in all features; names that differ in case only are one. A number that is not finite is left out. UserError when
/// it cannot be written.
void write_layers(const std::filesystem::path& gpkg, const std::string& crs_wkt, const std::vector<ShapeLayer>& layers);

}  // namespace frana
