#include "vtk_io/figures/actors_3d.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOpenGLSphereMapper.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include "vtk_io/figures/map_figure_block.h"

namespace frana {
namespace {

vtkIdType insert(vtkPoints* points, const Vec3& p, const Vec2& origin) {
    return points->InsertNextPoint(p.x() - origin.x(), p.y() - origin.y(), p.z());
}

}  // namespace

vtkSmartPointer<vtkActor> balls_actor(const std::vector<Objects3d::Ball>& balls, const Vec2& origin) {
    const auto count = static_cast<vtkIdType>(balls.size());
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(count);
    vtkNew<vtkFloatArray> radius;
    radius->SetName("radius");
    radius->SetNumberOfValues(count);
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    colours->SetNumberOfTuples(count);
    for (vtkIdType k = 0; k < count; ++k) {
        const Objects3d::Ball& ball = balls[static_cast<std::size_t>(k)];
        points->SetPoint(k, ball.centre.x() - origin.x(), ball.centre.y() - origin.y(), ball.centre.z());
        radius->SetValue(k, ball.radius);
        const unsigned char rgb[3] = {ball.colour.r, ball.colour.g, ball.colour.b};
        colours->SetTypedTuple(k, rgb);
    }
    vtkNew<vtkCellArray> all;  // VTK draws nothing of data without cells
    all->InsertNextCell(static_cast<int>(count));
    for (vtkIdType k = 0; k < count; ++k) all->InsertCellPoint(k);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetVerts(all);
    data->GetPointData()->SetScalars(colours);
    data->GetPointData()->AddArray(radius);
    vtkNew<vtkOpenGLSphereMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetScaleArray("radius");
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(0.45);  // colours stay those of the bar but for the edges
    actor->GetProperty()->SetDiffuse(0.6);
    actor->GetProperty()->SetSpecular(0.0);
    return actor;
}

vtkSmartPointer<vtkActor> facets_actor(const std::vector<Objects3d::Facet>& facets, const Vec2& origin) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    for (const Objects3d::Facet& facet : facets) {
        cells->InsertNextCell(static_cast<int>(facet.corners.size()));
        for (const Vec3& corner : facet.corners) cells->InsertCellPoint(insert(points, corner, origin));
        colours->InsertNextTuple3(facet.colour.r, facet.colour.g, facet.colour.b);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetCellData()->SetScalars(colours);
    return unlit_actor(data);
}

vtkSmartPointer<vtkActor> edges_actor(const std::vector<std::vector<Vec3>>& edges, const Vec2& origin, double width) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const std::vector<Vec3>& edge : edges) {
        cells->InsertNextCell(static_cast<int>(edge.size()));
        for (const Vec3& p : edge) cells->InsertCellPoint(insert(points, p, origin));
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(cells);
    auto actor = unlit_actor(data);
    actor->GetProperty()->SetColor(0.0, 0.0, 0.0);
    actor->GetProperty()->SetLineWidth(static_cast<float>(width));
    return actor;
}

}  // namespace frana
