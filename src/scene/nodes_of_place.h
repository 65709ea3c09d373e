#pragma once
// Properties of a place, from rasters and outlines to nodes. A node has the value of the pixel, or of the polygon, that
// it lies in.
#include <string>

#include "base/range.h"
#include "scene/scene_parts.h"

namespace frana {

/// "x 1037.5, y 2027.5" of the node or pixel number k.
std::string place_text(const GridGeometry& g, std::size_t k);

/// Of the pixel that holds a point; nodata beyond the raster.
double pixel_at(const Raster& raster, double x, double y);

/// "the terrain's nodes", or of the part of it that the scene holds.
std::string nodes_text(const Scene& scene);

/// A raster on the scene's terrain in its own pixels. Where the scene's part of the terrain does not touch the raster,
/// one pixel without data. UserError when the raster touches none of the terrain.
Raster pixels_on(const std::filesystem::path& file, const GisReader& reader, Scene& scene);
/// The same on the nodes of the terrain.
Raster field_on(const std::filesystem::path& file, const GisReader& reader, Scene& scene);

/// The same, of values that are 0 or more, given its pixels. On pixels larger than the cells it ends where they do, and
/// no value leaves the range of the pixels around. Interpolation across a step would carry a third of it on.
Raster field_within_pixels(const std::filesystem::path& file, const Raster& pixels, const GisReader& reader,
                           Scene& scene);

/// Whether polygons that hold no node of the scene's part of the terrain may hold some beyond it. Never where the scene
/// has all of the terrain.
bool may_begin_beyond(const Polygons& polygons, const Scene& scene);

/// Throws UserError, naming a pixel, unless all that have data lie in a key's range.
void require_range(const Raster& pixels, const Range& range, const std::string& file);

/// Marks the nodes inside a polygon, row by row. They lie between its first and second crossing of the row, its third
/// and fourth, ...
void mark_inside(const Polygon& polygon, const GridGeometry& grid, NodeMarks& marks);

}  // namespace frana
