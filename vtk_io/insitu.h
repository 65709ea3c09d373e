#pragma once
// Works of [[insitu]] that run a VTK pipeline inside the solver process. Each sample leaves a file of a series, listed
// in a .pvd as soon as it is there. Files appear whole or not at all.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "observe/insitu.h"
#include "terrain/raster.h"

namespace frana {

/// Lines on the map along which a node field has the given values, each with its value. Cells at nodes without terrain
/// have none.
std::vector<std::pair<double, Polyline>> level_lines_of(const Frame& frame, const std::string& field,
                                                        const std::vector<double>& levels);

/// Those lines: `folder`/`name`/`name`_NNNNNN.vtp, laid on the surface of the
/// flow (z = elevation + depth), with cell data `level` in the field's unit.
std::unique_ptr<InsituWork> make_contours(const std::filesystem::path& folder, const std::string& name,
                                          const std::string& field, const std::vector<double>& levels);

/// Values that count; both ends belong to it.
struct Interval {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
};

/// 1 for the grid's cells all of whose nodes have terrain and the field within the interval, else 0. There are (nx - 1)
/// (ny - 1) of them, row 0 south.
std::vector<std::uint8_t> cells_within(const Frame& frame, const std::string& field, const Interval& kept);

/// Cells of the grid all of whose nodes have terrain and the field within the interval. They have all node fields:
/// `name`_NNNNNN.vtu (vtkUnstructuredGrid).
std::unique_ptr<InsituWork> make_cell_threshold(const std::filesystem::path& folder, const std::string& name,
                                                const std::string& field, const Interval& kept);

/// Particles whose field is within the interval, with all their arrays: `name`_NNNNNN.vtp (vtkPolyData, one vertex a
/// particle).
std::unique_ptr<InsituWork> make_particle_threshold(const std::filesystem::path& folder, const std::string& name,
                                                    const std::string& field, const Interval& kept);

}  // namespace frana
