#pragma once
// The scene's interface to the outside world (files of a GIS). The solver library builds without GDAL. The program
// supplies readers made with it (src/io/gdal_*.h).
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "terrain/raster.h"

namespace frana {

/// What part of an elevation model to read, and how fine.
struct DemRequest {
    std::optional<std::array<double, 4>> window;  ///< xmin, ymin, xmax, ymax in map coordinates [m]
    std::optional<double> cell;                   ///< node distance [m]; nothing: the pixel of the file
    /// Told the grid before any of it is read (a raster without values): the nodes to read. May throw to refuse it.
    std::function<NodeBox(const Raster& whole)> choose = {};
};

/// How a raster lies to a part of the map.
struct RasterPlace {
    bool touches = true;      ///< otherwise read_raster and read_onto refuse it
    bool needs_warp = false;  ///< its CRS is another one: pixels then depend on the part that is read
};

/// Polygons with a number each.
struct ValuedPolygons {
    Polygons polygons;
    std::vector<double> values;  ///< one for each part; empty: none were requested
};

/// Readers of GIS files. Every problem is a UserError that names the file, what was found and a way out.
/// Remarks that the user should see (resampled from 5 m to 10 m, ...) are appended to `log`.
class GisReader {
public:
    virtual ~GisReader() = default;
    /// Elevation model as nodes. The window is cut. The model is resampled: area average to coarser, cubic to finer;
    /// untouched when the cell is the pixel. Scale and offset are applied, and nodata (value, mask or NaN) becomes NaN.
    /// Refuses a geographic or non-metre CRS with the gdalwarp line that cures it.
    virtual Raster read_dem(const std::filesystem::path& file, const DemRequest& request,
                            std::vector<std::string>& log) const = 0;
    /// Reads parts of that model later on; may outlive this reader. Nothing: parts cannot be read here.
    virtual std::function<Raster(const NodeBox&)> read_dem_later(const std::filesystem::path& /*file*/,
                                                                 const DemRequest& /*request*/) const {
        return {};
    }
    /// A reader of the same files that may outlive this one, for several threads at once. Nothing: parts cannot be read here.
    virtual std::shared_ptr<const GisReader> lasting() const { return {}; }
    /// UserError for a raster that declares its numbers in another unit of length than the metre.
    virtual void require_metres(const std::filesystem::path& /*file*/) const {}
    /// The unit that a raster declares for its numbers; empty: none.
    virtual std::string unit_of(const std::filesystem::path& /*file*/) const { return {}; }
    /// How a raster lies to `extent` of a map of that CRS.
    virtual RasterPlace place_of(const std::filesystem::path& /*file*/, const std::array<double, 4>& /*extent*/,
                                 const std::string& /*crs_wkt*/) const {
        return {};
    }
    /// The box around the pixels above 0 of a raster that `extent` touches, both as xmin, ymin, xmax, ymax.
    /// Nothing: there are none, or it cannot be told here, as for a raster that has to be reprojected.
    virtual std::optional<std::array<double, 4>> extent_above_zero(const std::filesystem::path& /*file*/,
                                                                   const std::array<double, 4>& /*extent*/,
                                                                   const std::string& /*crs_wkt*/) const {
        return {};
    }
    /// Any raster (depth, mask, velocity, ...) in its own pixels, cut to the pixels that touch `extent`
    /// (xmin, ymin, xmax, ymax). It is reprojected only when its CRS is known and differs from `crs_wkt`. Pixels must
    /// be square within 1e-6; NaN where nodata.
    virtual Raster read_raster(const std::filesystem::path& file, const std::array<double, 4>& extent,
                               const std::string& crs_wkt, std::vector<std::string>& log) const = 0;
    /// The same of a raster whose values only tell where something is. A reprojected pixel is one of the file's.
    virtual Raster read_mask(const std::filesystem::path& file, const std::array<double, 4>& extent,
                             const std::string& crs_wkt, std::vector<std::string>& log) const {
        return read_raster(file, extent, crs_wkt, log);
    }
    /// The same, averaged / interpolated onto `grid`.
    virtual Raster read_onto(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                             std::vector<std::string>& log) const = 0;
    /// Heights or thicknesses of a survey on the pixels of `grid`. Readers may also widen it to all of the raster.
    virtual Raster read_deposit(const std::filesystem::path& file, const GridGeometry& grid, const std::string& crs_wkt,
                                std::vector<std::string>& log) const {
        return read_onto(file, grid, crs_wkt, log);
    }
    /// All polygons of a vector file, reprojected to `crs_wkt` when both are known and differ.
    virtual Polygons read_polygons(const std::filesystem::path& file, const std::string& crs_wkt,
                                   std::vector<std::string>& log) const = 0;
    /// The same with a number for each polygon, from the attribute of that name.
    virtual ValuedPolygons read_valued_polygons(const std::filesystem::path& file, const std::string& /*attribute*/,
                                                const std::string& /*crs_wkt*/,
                                                std::vector<std::string>& /*log*/) const {
        throw UserError(file.string() + ": attributes cannot be read here");
    }
    /// A surveyed extent on the terrain of `extent` (xmin, ymin, xmax, ymax). Polygons that do not overlap one
    /// another. Readers may also take a raster whose pixels above 0 are the extent.
    virtual Polygons read_survey(const std::filesystem::path& file, const std::array<double, 4>& extent,
                                 const std::string& crs_wkt, std::vector<std::string>& log) const {
        static_cast<void>(extent);
        return read_polygons(file, crs_wkt, log);
    }
    /// All lines of a vector file, likewise.
    virtual std::vector<Polyline> read_lines(const std::filesystem::path& file, const std::string& crs_wkt,
                                             std::vector<std::string>& log) const = 0;
    /// Of a vector file with one line, likewise.
    virtual Polyline read_line(const std::filesystem::path& file, const std::string& crs_wkt,
                               std::vector<std::string>& log) const {
        const std::vector<Polyline> lines = read_lines(file, crs_wkt, log);
        if (lines.size() == 1) return lines.front();
        throw UserError(file.string() + ": holds " + std::to_string(lines.size()) + " lines; expected one");
    }
};

struct DistanceField;

/// A closed mesh as distances, and the box around it [m].
struct MeshField {
    std::shared_ptr<const DistanceField> field;
    Vec3 low, high;
};

/// How a mesh becomes a field of distances.
struct MeshSampling {
    double spacing = 1.0;  ///< between the field's nodes [m]
    double margin = 0.0;   ///< that the field reaches beyond the mesh [m]
    Vec3 origin{0, 0, 0};  ///< of the mesh's coordinates, in those of the map [m]
};

/// Reads a mesh. Throws UserError for what is no closed surface.
using MeshReader = std::function<MeshField(const std::filesystem::path& file, const MeshSampling& sampling)>;

}  // namespace frana
