#include "vtk_io/survey_vtp.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "compare/outline.h"
#include "compare/overlap.h"
#include "terrain/bed_points.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

bool on_terrain(const GridGeometry& g, const Vec2& point) {
    const auto [xmin, ymin, xmax, ymax] = g.pixel_extent();
    return point.x() >= xmin && point.x() <= xmax && point.y() >= ymin && point.y() <= ymax;
}

void write_polydata(vtkPolyData* data, const std::filesystem::path& file) {
    vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
    write_xml(writer, data, file);
}

/// Quadrilaterals of pixels with what they are; corners are not shared, so that any of them can be left out.
struct AreaMesh {
    const Raster& bed;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> quads;
    vtkNew<vtkIntArray> agreement;
    vtkNew<vtkFloatArray> share;

    explicit AreaMesh(const Raster& ground) : bed(ground) {
        points->SetDataTypeToDouble();
        agreement->SetName("agreement");
        share->SetName("surveyed_share");
    }
    void add(Index i, Index j, int what, double surveyed_share) {
        const GridGeometry& g = bed.geometry;
        vtkIdType corners[4];
        const double half = 0.5 * g.cell;
        const Vec2 to[4] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
        for (int c = 0; c < 4; ++c) {
            const Vec2 corner = Vec2(g.x(i), g.y(j)) + to[c];
            corners[c] = points->InsertNextPoint(corner.x(), corner.y(), bed_below(bed, corner.x(), corner.y()));
        }
        quads->InsertNextCell(4, corners);
        agreement->InsertNextValue(what);
        share->InsertNextValue(static_cast<float>(surveyed_share));
    }
};

vtkSmartPointer<vtkPolyData> areas(const Raster& bed, const Raster& depth, double limit, const Rings& survey) {
    const GridGeometry& g = depth.geometry;
    AreaMesh mesh(bed);
    for_each_pixel_area(g, survey, [&](Index i, Index j, double surveyed_area) {
        if (!std::isfinite(bed.at(i, j))) return;
        const double share = surveyed_area / (g.cell * g.cell);
        const bool simulated = depth.at(i, j) > limit, surveyed = share >= 0.5;
        if (simulated || surveyed) mesh.add(i, j, simulated ? (surveyed ? 1 : 2) : 3, share);
    });
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(mesh.points);
    data->SetPolys(mesh.quads);
    data->GetCellData()->AddArray(mesh.agreement);
    data->GetCellData()->AddArray(mesh.share);
    for (const char* name : {"agreement", "surveyed_share"}) add_unit(data->GetFieldData(), name, "1");
    return data;
}

struct LineMesh {
    const Raster& bed;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkIntArray> extent;

    explicit LineMesh(const Raster& ground) : bed(ground) {
        points->SetDataTypeToDouble();
        extent->SetName("extent");
    }
    /// Pieces of the line so far that lie on the terrain become a cell.
    void finish(std::vector<vtkIdType>& line, int what) {
        if (line.size() > 1) {
            lines->InsertNextCell(static_cast<vtkIdType>(line.size()), line.data());
            extent->InsertNextValue(what);
        }
        line.clear();
    }
    void add(const std::vector<Vec2>& ring, int what) {
        std::vector<vtkIdType> line;
        for (std::size_t k = 0; k < ring.size(); ++k) {
            const Vec2& a = ring[k];
            const Vec2 way = ring[(k + 1) % ring.size()] - a;
            const auto parts = std::max<Index>(static_cast<Index>(std::ceil(way.norm() / bed.geometry.cell)), 1);
            const bool last = k + 1 == ring.size();
            for (Index part = 0; part < parts + (last ? 1 : 0); ++part) {
                const Vec2 point = a + static_cast<double>(part) / static_cast<double>(parts) * way;
                const double z =
                    on_terrain(bed.geometry, point) ? bed_below(bed, point.x(), point.y()) : Raster::nodata;
                if (std::isfinite(z))
                    line.push_back(points->InsertNextPoint(point.x(), point.y(), z));
                else
                    finish(line, what);
            }
        }
        finish(line, what);
    }
};

}  // namespace

void write_survey(const std::filesystem::path& run_dir, const Raster& bed, const Raster& depth, double limit,
                  const Rings& survey) {
    expect(bed.geometry == depth.geometry, "terrain and depth have the same pixels");
    write_polydata(areas(bed, depth, limit, survey), run_dir / "survey_areas.vtp");
    LineMesh mesh(bed);
    for (const auto& ring : pixel_outline(depth, limit)) mesh.add(ring, 1);
    for (const auto& ring : survey) mesh.add(ring, 2);
    vtkNew<vtkPolyData> data;
    data->SetPoints(mesh.points);
    data->SetLines(mesh.lines);
    data->GetCellData()->AddArray(mesh.extent);
    add_unit(data->GetFieldData(), "extent", "1");
    write_polydata(data, run_dir / "survey_outlines.vtp");
}

}  // namespace frana
