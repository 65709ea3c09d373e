#include "vtk_io/seeds_vtp.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataWriter.h>

#include <numeric>

#include "vtk_io/writers_xml.h"

namespace frana {

namespace {

vtkSmartPointer<vtkDoubleArray> array_of(const std::string& name, int components, std::size_t count) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    return array;
}

vtkSmartPointer<vtkTypeInt64Array> numbers(std::size_t count) {
    auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    std::iota(array->GetPointer(0), array->GetPointer(0) + count, vtkTypeInt64{0});
    return array;
}

vtkSmartPointer<vtkPoints> surface_points(const SeedsExport& data) {
    const Seeds& seeds = data.seeds;
    const auto xyz = array_of("position", 3, seeds.x.size());
    double* out = xyz->GetPointer(0);
    for (std::size_t p = 0; p < seeds.x.size(); ++p) {
        *out++ = seeds.x[p];
        *out++ = seeds.y[p];
        *out++ = data.elevation[p] + seeds.depth[p];
    }
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetData(xyz);
    return points;
}

/// A column as a VTK array; pairs get a third component of zero, since VTK's vectors have three.
vtkSmartPointer<vtkDoubleArray> array_of(const SeedsColumn& column, std::size_t count) {
    const int components = column.components == 2 ? 3 : 1;
    const auto array = array_of(column.name, components, count);
    double* out = array->GetPointer(0);
    for (std::size_t k = 0; k < column.values.size(); ++k) {
        *out++ = column.values[k];
        if (column.components == 2 && k % 2 == 1) *out++ = 0.0;
    }
    return array;
}

}  // namespace

void write_seeds_vtp(const std::filesystem::path& file, const SeedsExport& data) {
    const std::size_t count = data.seeds.x.size();
    vtkNew<vtkPolyData> cloud;
    cloud->SetPoints(surface_points(data));
    vtkNew<vtkCellArray> vertices;
    vertices->SetData(1, numbers(count));
    cloud->SetVerts(vertices);
    for (const SeedsColumn& column : seeds_columns(data)) {
        add_unit(cloud->GetFieldData(), column.name, column.unit);
        if (column.name != "position") cloud->GetPointData()->AddArray(array_of(column, count));
    }
    const auto ids = numbers(count);
    ids->SetName("id");
    cloud->GetPointData()->AddArray(ids);
    add_unit(cloud->GetFieldData(), "id", "1");
    add_unit(cloud->GetFieldData(), "density", "kg/m3");
    const auto density = array_of("density", 1, 1);
    density->SetValue(0, data.density);
    cloud->GetFieldData()->AddArray(density);
    vtkNew<vtkStringArray> crs;
    crs->SetName("crs_wkt");
    crs->InsertNextValue(data.crs_wkt);
    cloud->GetFieldData()->AddArray(crs);
    vtkNew<vtkXMLPolyDataWriter> writer;
    write_xml(writer, cloud, file);
}

}  // namespace frana
