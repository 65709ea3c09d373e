#pragma once
#include <memory>
#include <string>

#include "scene/toolbox.h"

namespace frana {

/// GIS files through GDAL and OGR. Their own messages never reach stderr: they are part of ours. Safe to use
/// from several threads at once; each call opens and closes its file.
class GdalReader : public GisReader {
public:
    /// Nodes are on the raster's pixels when `cell` is the pixel, within 1e-9 of it. A window is then widened to whole
    /// pixels. Otherwise they are on cells counted from the south-west corner of the window. Reads the window's pixels
    /// only. UserErrors besides those of GisReader: window not inside the raster, no data in it, rotated raster. So too
    /// values that must be nodata but are not declared so, and more nodes than memory holds.
    Raster read_dem(const std::filesystem::path& file, const DemRequest& request,
                    std::vector<std::string>& log) const override;

    std::function<Raster(const NodeBox&)> read_dem_later(const std::filesystem::path& file,
                                                         const DemRequest& request) const override;

    std::shared_ptr<const GisReader> lasting() const override { return std::make_shared<GdalReader>(); }

    /// The unit is that of the band or, where that declares none, of the CRS's heights.
    void require_metres(const std::filesystem::path& file) const override;

    std::string unit_of(const std::filesystem::path& file) const override;

    RasterPlace place_of(const std::filesystem::path& file, const std::array<double, 4>& extent,
                         const std::string& crs_wkt) const override;

    /// Reads strips of rows, and stores none.
    std::optional<std::array<double, 4>> extent_above_zero(const std::filesystem::path& file,
                                                           const std::array<double, 4>& extent,
                                                           const std::string& crs_wkt) const override;

    /// A reprojected raster comes in square pixels of the mean area of its own, bilinear.
    Raster read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                       const std::string& crs_wkt, std::vector<std::string>& log) const override;

    /// Reprojected likewise, each pixel the file's nearest: a blend of two would be above 0 beyond the edge.
    Raster read_mask(const std::filesystem::path& file, const std::array<double, 4>& extent, const std::string& crs_wkt,
                     std::vector<std::string>& log) const override;

    /// Nodes that the raster does not cover by half a cell are NaN; UserError when it covers none.
    Raster read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                     std::vector<std::string>& log) const override;

    /// Z and M are dropped, curves become chords, multipolygons and collections are flattened, all layers are
    /// read. Outlines that cross themselves are repaired and named in the log. A GeoJSON without a crs member
    /// counts as WGS 84 only where that makes sense. It does not when `crs_wkt` is empty or a coordinate is no
    /// longitude or latitude. UserError when there is no polygon. Polygons may overlap one another.
    Polygons read_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                           std::vector<std::string>& log) const override;

    /// UserError for an attribute that is not there, is no number, or is not given for a feature.
    ValuedPolygons read_valued_polygons(const std::filesystem::path& file, const std::string& attribute,
                                        const std::string& crs_wkt, std::vector<std::string>& log) const override;

    /// Polygons or, where the file is a raster, the outlines of its pixels above 0. These run along the pixels' edges,
    /// and are then reprojected. Stricter than read_polygons, since a survey in the wrong place would still give
    /// scores. UserError also when the terrain has a CRS and the file none, or claims degrees for coordinates that are
    /// none. So too when nothing of it lies within `extent`. What lies outside stays. Overlapping polygons are united.
    Polygons read_survey(const std::filesystem::path& file, const std::array<double, 4>& extent,
                         const std::string& crs_wkt, std::vector<std::string>& log) const override;

    /// Thickness of a surveyed deposit, or a surveyed change of the bed, on the pixels of `grid`. That is widened by
    /// whole pixels to all of the raster, so that no volume is lost. UserError as read_onto, read_survey and require_metres.
    Raster read_deposit(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                        std::vector<std::string>& log) const override;

    std::vector<Polyline> read_lines(const std::filesystem::path& file, const std::string& crs_wkt,
                                     std::vector<std::string>& log) const override;
    /// UserError with the layer, and what it holds, when that is not one line.
    Polyline read_line(const std::filesystem::path& file, const std::string& crs_wkt,
                       std::vector<std::string>& log) const override;
};

/// WKT of a raster's map coordinates, without those of heights; empty: none or local ones. UserError: no raster.
std::string crs_of_raster(const std::filesystem::path& file);

/// Version of the GDAL library in use, such as "3.6.2".
std::string gdal_version();

}  // namespace frana
