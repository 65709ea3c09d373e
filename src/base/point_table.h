#pragma once
// Points for other programs: named columns with units, and the text formats. HDF5 and VTK live in io/hdf5_points.h and
// vtk_io/points_vtp.h. A table holds points to export; what the formats have in common is here.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace frana {

/// One quantity of all points; `values` is borrowed and holds a number per point and head, a point's together.
struct PointColumn {
    std::string name;                ///< "position", "velocity", ...
    std::string unit;                ///< "m", "m/s", "Pa", "kg", "m3", "1"
    std::vector<std::string> heads;  ///< names of the components in a text table: {"x", "y", "z"}
    const double* values = nullptr;
    std::size_t components() const { return heads.size(); }
};

/// A number that holds for all points.
struct PointConstant {
    std::string name, unit;
    double value = 0.0;
};

struct PointTable {
    std::string format;   ///< what it is and in which version: "frana particles 1"
    std::string crs_wkt;  ///< WKT2 of the map coordinates, empty when unknown
    std::vector<PointConstant> constants;
    std::vector<std::pair<std::string, std::string>> texts;  ///< name and text
    std::size_t count = 0;
    std::vector<PointColumn> columns;
};

/// Throws InternalError on a number that is not finite, so that none reaches a file.
void require_finite(const PointTable& table);

/// Text table: id (0, 1, ...) and the heads of all columns; units are those of the columns. Numbers read back to the
/// same bits. Throws UserError when the file cannot be written, InternalError as above.
void write_points_csv(const std::filesystem::path& file, const PointTable& table);

/// One JSON object: format, count, the constants, crs_wkt, the texts, units (name: unit), id, and an array per column.
/// An array has arrays where it has several components. Numbers read back to the same bits. Throws as above.
void write_points_json(const std::filesystem::path& file, const PointTable& table);

}  // namespace frana
