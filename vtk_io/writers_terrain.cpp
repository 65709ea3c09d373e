#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>

#include <cmath>

#include "base/constants.h"
#include "observe/file_arrays.h"
#include "vtk_io/hillshade.h"
#include "vtk_io/writers.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

constexpr double exaggeration = 1.4;  ///< of heights, in the shading

/// Difference quotient between the two neighbours, one-sided where one is missing, zero where both are.
double difference(double before, double here, double after, double cell) {
    const bool has_before = std::isfinite(before), has_after = std::isfinite(after);
    if (has_before && has_after) return (after - before) / (2.0 * cell);
    if (has_after) return (after - here) / cell;
    return has_before ? (here - before) / cell : 0.0;
}

Vec2 gradient(const Raster& bed, Index i, Index j) {
    const auto z = [&](Index a, Index b) {
        const bool inside = a >= 0 && b >= 0 && a < bed.geometry.nx && b < bed.geometry.ny;
        return inside ? bed.at(a, b) : Raster::nodata;
    };
    const double here = bed.at(i, j), cell = bed.geometry.cell;
    return {difference(z(i - 1, j), here, z(i + 1, j), cell), difference(z(i, j - 1), here, z(i, j + 1), cell)};
}

/// The node fields of a frame, whose first is the elevation.
void write_image(const std::filesystem::path& file, const Frame& frame) {
    const auto outside = outside_nodes(frame);
    const auto image = image_of(frame.grid);
    for (const Field& field : frame.nodes) {
        add_unit(image->GetFieldData(), field.name, field.unit);
        image->GetPointData()->AddArray(to_vtk(field, outside));
    }
    hide_nodes(image, outside);
    vtkNew<WithBase64Stream<vtkXMLImageDataWriter>> writer;
    write_xml(writer, image, file);
}

}  // namespace

void write_terrain(const std::filesystem::path& run_dir, const Raster& bed) {
    const GridGeometry& grid = bed.geometry;
    std::vector<double> slope_deg(bed.values.size(), Raster::nodata);
    const std::vector<float> light = hillshade(bed, exaggeration);
    const std::vector<double> shade(light.begin(), light.end());
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            if (std::isnan(bed.at(i, j))) continue;
            const double tangent = gradient(bed, i, j).norm();
            slope_deg[static_cast<std::size_t>(j * grid.nx + i)] = std::atan(tangent) * constants::kRadian;
        }
    Frame frame;
    frame.grid = grid;
    frame.nodes = {{"elevation", "m", 1, bed.values.data(), grid.size()},
                   {"slope", "degree", 1, slope_deg.data(), grid.size()},
                   {"hillshade", "1", 1, shade.data(), grid.size()}};
    write_image(run_dir / "terrain.vti", frame);
}

void write_terrain_maps(const std::filesystem::path& dir, const Raster& bed, const std::vector<NamedMap>& maps) {
    Frame frame;
    frame.grid = bed.geometry;
    frame.nodes = {{"elevation", "m", 1, bed.values.data(), bed.geometry.size()}};
    for (const NamedMap& map : maps)
        frame.nodes.push_back({map.name, map.unit, 1, map.values.data(), bed.geometry.size()});
    write_image(dir / "maps.vti", frame);
}

}  // namespace frana
