// A frame as VTK data, with units and time in the field data.
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkTypeInt64Array.h>

#include <numeric>

#include "base/error.h"
#include "observe/file_arrays.h"
#include "vtk_io/writers_xml.h"

namespace frana {
namespace {

/// One vertex cell a point: filters that work on cells (Threshold) then see particles one by one.
vtkSmartPointer<vtkCellArray> one_vertex_each(Index count) {
    vtkNew<vtkTypeInt64Array> offsets, points;
    offsets->SetNumberOfValues(count + 1);
    points->SetNumberOfValues(count);
    std::iota(offsets->GetPointer(0), offsets->GetPointer(0) + count + 1, vtkTypeInt64{0});
    std::iota(points->GetPointer(0), points->GetPointer(0) + count, vtkTypeInt64{0});
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(offsets, points);
    return cells;
}

}  // namespace

vtkSmartPointer<vtkPolyData> cloud_of(const Frame& frame) {
    const Field* position = frame.particle("position");
    expect(position && position->components == 3, "particles have no position of 3 components");
    auto cloud = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkPoints> points;
    points->SetData(to_vtk(*position, {}));
    cloud->SetPoints(points);
    cloud->SetVerts(one_vertex_each(position->count));
    for (const Field& field : frame.particles) {
        expect(field.count == position->count, "particle arrays differ in length");
        add_unit(cloud->GetFieldData(), field.name, field.unit);
        if (&field != position) cloud->GetPointData()->AddArray(to_vtk(field, {}));
    }
    add_time(cloud->GetFieldData(), frame.status.time);
    return cloud;
}

vtkSmartPointer<vtkImageData> image_of(const Frame& frame) {
    const auto outside = outside_nodes(frame);
    auto image = image_of(frame.grid);
    for (const Field& field : frame.nodes) {
        expect(field.count == frame.grid.size(), "a node array is not as long as the grid");
        add_unit(image->GetFieldData(), field.name, field.unit);
        image->GetPointData()->AddArray(to_vtk(field, outside));
    }
    hide_nodes(image, outside);
    add_time(image->GetFieldData(), frame.status.time);
    return image;
}

}  // namespace frana
