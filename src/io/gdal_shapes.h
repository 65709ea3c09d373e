#pragma once
// Between OGR's geometries and ours. Not for callers outside src/io.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "io/gdal_support.h"
#include "terrain/raster.h"

namespace frana::gdal {

using Geometry = std::unique_ptr<OGRGeometry>;

/// What was found, for the error that nothing of use was.
struct Census {
    Index features = 0, polygons = 0, lines = 0, points = 0;
    std::string text() const;
};

/// Coordinates that may be longitude and latitude.
bool degrees_possible(const OGREnvelope& e);

/// Vertices without the closing one and without repetitions; UserError when one is not finite.
std::vector<Vec2> vertices(const OGRSimpleCurve& curve, bool ring, const std::string& place);

/// Adds a polygon with its holes; one that is empty or has less than three vertices is left out.
void append_polygon(const OGRPolygon& polygon, const std::string& place, std::vector<Polygon>& parts);

/// Takes a geometry apart into polygons; counts the rest.
void collect_polygons(const OGRGeometry& geometry, Census& census, const std::function<void(const OGRPolygon&)>& use);

/// Outlines with holes of the pixels that are not 0, largest first. Pixels that touch only at a corner belong to
/// different ones. `mask` has the row that `transform` (GDAL's geotransform) puts first in front.
std::vector<std::unique_ptr<OGRPolygon>> outlines_of(std::vector<std::uint8_t>& mask, Index nx, Index ny,
                                                     const std::array<double, 6>& transform);

}  // namespace frana::gdal
