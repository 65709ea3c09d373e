// What VTK's filters find in the mesh of a barrier: its sharp edges, and its cut with a plane.
#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkContourTriangulator.h>
#include <vtkCutter.h>
#include <vtkFeatureEdges.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStripper.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "vtk_io/figures/mesh_3d.h"

namespace frana {
namespace {

using Move = std::function<Vec3(const Vec3&)>;

/// The mesh with each of its points moved.
vtkSmartPointer<vtkPolyData> polydata_of(const TriangleMesh& mesh, const Move& moved) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Vec3& x : mesh.points) points->InsertNextPoint(moved(x).data());
    vtkNew<vtkCellArray> triangles;
    for (const auto& t : mesh.triangles) triangles->InsertNextCell({t[0], t[1], t[2]});
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(triangles);
    return data;
}

/// The corners of every cell.
std::vector<std::vector<Vec3>> cells_of(vtkPolyData* data) {
    std::vector<std::vector<Vec3>> cells;
    for (vtkIdType k = 0; k < data->GetNumberOfCells(); ++k) {
        vtkPoints* const corners = data->GetCell(k)->GetPoints();
        auto& cell = cells.emplace_back();
        for (vtkIdType c = 0; c < corners->GetNumberOfPoints(); ++c) cell.emplace_back(corners->GetPoint(c));
    }
    return cells;
}

std::vector<std::vector<Vec2>> flat(const std::vector<std::vector<Vec3>>& cells) {
    std::vector<std::vector<Vec2>> shapes;
    for (const auto& cell : cells) {
        auto& shape = shapes.emplace_back();
        for (const Vec3& x : cell) shape.emplace_back(x.head<2>());
    }
    return shapes;
}

/// The parts of the cut that are loaded: where its pieces cross the plane.
std::vector<MeshCut::Strip> strips_of(const BarrierSolid& barrier, const Move& in_plane) {
    std::vector<MeshCut::Strip> strips;
    for (const BarrierSolid::Piece& piece : barrier.pieces) {
        if (piece.pressure <= 0.0) continue;
        std::vector<Vec2> crossings;
        for (std::size_t k = 0; k < piece.corners.size(); ++k) {
            const Vec3 a = in_plane(piece.corners[k]), b = in_plane(piece.corners[(k + 1) % piece.corners.size()]);
            if ((a.z() > 0.0) != (b.z() > 0.0))
                crossings.emplace_back((a + (b - a) * (a.z() / (a.z() - b.z()))).head<2>());
        }
        const Vec2 inward = -(in_plane(piece.corners[0] + piece.normal) - in_plane(piece.corners[0])).head<2>();
        if (crossings.size() == 2 && inward.norm() > 0.0)
            strips.push_back({crossings[0], crossings[1], inward.normalized(), piece.pressure});
    }
    return strips;
}

}  // namespace

std::vector<std::vector<Vec3>> sharp_edges(const TriangleMesh& mesh, double longest) {
    vtkNew<vtkFeatureEdges> filter;
    filter->SetInputData(polydata_of(mesh, [](const Vec3& x) { return x; }));
    filter->BoundaryEdgesOff(), filter->NonManifoldEdgesOff(), filter->ManifoldEdgesOff();
    filter->FeatureEdgesOn();
    filter->SetFeatureAngle(30.0);
    filter->ColoringOff();
    filter->Update();
    std::vector<std::vector<Vec3>> parts;
    for (const auto& edge : cells_of(filter->GetOutput())) {
        const Vec3 way = edge[1] - edge[0];
        const double count = std::max(1.0, std::ceil(way.norm() / longest));
        for (double n = 0.0; n < count; n += 1.0)
            parts.push_back({edge[0] + way * (n / count), edge[0] + way * ((n + 1.0) / count)});
    }
    return parts;
}

MeshCut cut_of(const BarrierSolid& barrier, const Vec2& from, const Vec2& along) {
    const Move in_plane = [&](const Vec3& x) {
        const Vec2 way = x.head<2>() - from;
        return Vec3(along.dot(way), x.z(), along.x() * way.y() - along.y() * way.x());
    };
    vtkNew<vtkPlane> plane;
    plane->SetNormal(0.0, 0.0, 1.0);
    vtkNew<vtkCutter> cutter;
    cutter->SetInputData(polydata_of(*barrier.mesh, in_plane));
    cutter->SetCutFunction(plane);
    vtkNew<vtkContourTriangulator> areas;
    areas->SetInputConnection(cutter->GetOutputPort());
    areas->Update();
    vtkNew<vtkStripper> outlines;
    outlines->SetInputConnection(cutter->GetOutputPort());
    outlines->SetMaximumLength(1000000);
    outlines->Update();
    return {flat(cells_of(areas->GetOutput())), flat(cells_of(outlines->GetOutput())), strips_of(barrier, in_plane)};
}

}  // namespace frana
