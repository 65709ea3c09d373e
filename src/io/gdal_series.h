#pragma once
// Shapes through time for a GIS.
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "observe/archive.h"
#include "terrain/raster.h"

namespace frana {

/// A GeoPackage with one layer that grows through a run. GeoPackage and not GeoJSON, because that standard (RFC 7946)
/// allows longitude and latitude only. A GeoPackage has any CRS and holds all times in one file. Each call adds all its
/// shapes or none (a transaction). The first one makes the file. From an older one it takes away what is not earlier,
/// unless a state was restored. The bytes depend on the shapes alone. They hold no date, and are the same after a state was
/// restored. UserError when the disk refuses, NumericsError for a place that is not finite.
class ShapeSeries {
public:
    /// `crs_wkt` of the coordinates, or empty: local metres; the layer has the name of the file.
    ShapeSeries(std::filesystem::path gpkg, std::string crs_wkt)
        : gpkg_(std::move(gpkg)), crs_wkt_(std::move(crs_wkt)) {}

    /// Lines of equal value at a time [s]: attributes t_s, level, unit (that of the level).
    void add_lines(double time, const std::vector<std::pair<double, Polyline>>& level_and_line,
                   const std::string& unit);
    /// Outlines with holes of the cells between the grid's nodes that are not 0. There are (nx - 1) (ny - 1) cells, row
    /// 0 south. Cells that touch only at a corner belong to different ones. Attributes t_s, area_m2.
    void add_cells(double time, const GridGeometry& grid, std::vector<std::uint8_t>& cells);

    /// Saves how far it is. A state that is restored takes away at once what came later: a run may end without another
    /// call. What goes wrong with that shows in the next call.
    void serialize(Archive& archive);

private:
    bool forget_later();
    template <class Fill>
    void add(double time, bool lines, const Fill& fill);

    std::filesystem::path gpkg_;
    std::string crs_wkt_;
    bool begun_ = false;
    double last_ = -1.0;      ///< time of the last call; -1: none yet [s]
    bool has_later_ = false;  ///< the file may have what came after the state that was restored
};

}  // namespace frana
