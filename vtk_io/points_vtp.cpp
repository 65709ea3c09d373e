#include "vtk_io/points_vtp.h"

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

/// Numbers of the caller as a VTK array, not copied; VTK only reads them.
vtkSmartPointer<vtkDoubleArray> borrowed(const std::string& name, const double* values, std::size_t count,
                                         std::size_t components) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name.c_str());
    array->SetNumberOfComponents(static_cast<int>(components));
    array->SetArray(const_cast<double*>(values), static_cast<vtkIdType>(count) * static_cast<vtkIdType>(components), 1);
    return array;
}

vtkSmartPointer<vtkDoubleArray> vectors_of_pairs(const PointColumn& column, std::size_t count) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(column.name.c_str());
    array->SetNumberOfComponents(3);
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    double* out = array->GetPointer(0);
    for (std::size_t p = 0; p < count; ++p) {
        *out++ = column.values[2 * p];
        *out++ = column.values[2 * p + 1];
        *out++ = 0.0;
    }
    return array;
}

vtkSmartPointer<vtkTypeInt64Array> numbers(std::size_t count) {
    auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
    array->SetNumberOfTuples(static_cast<vtkIdType>(count));
    std::iota(array->GetPointer(0), array->GetPointer(0) + count, vtkTypeInt64{0});
    return array;
}

void name_components(vtkDoubleArray* array) {
    static const char* const kTensor[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    static const char* const kVector[] = {"X", "Y", "Z"};
    const int components = array->GetNumberOfComponents();
    for (int c = 0; c < components; ++c)
        if (components == 6 || components == 3) array->SetComponentName(c, components == 6 ? kTensor[c] : kVector[c]);
}

void add_text(vtkFieldData* data, const std::string& name, const std::string& text) {
    vtkNew<vtkStringArray> array;
    array->SetName(name.c_str());
    array->InsertNextValue(text);
    data->AddArray(array);
}

void add_constant(vtkFieldData* data, const PointConstant& constant) {
    add_unit(data, constant.name, constant.unit);
    vtkNew<vtkDoubleArray> array;
    array->SetName(constant.name.c_str());
    array->InsertNextValue(constant.value);
    data->AddArray(array);
}

}  // namespace

void write_points_vtp(const std::filesystem::path& file, const PointTable& table, const double* places) {
    require_finite(table);
    vtkNew<vtkPolyData> cloud;
    vtkNew<vtkPoints> points;
    points->SetData(borrowed("position", places, table.count, 3));
    cloud->SetPoints(points);
    vtkNew<vtkCellArray> vertices;
    vertices->SetData(1, numbers(table.count));
    cloud->SetVerts(vertices);
    vtkFieldData* field = cloud->GetFieldData();
    for (const PointColumn& column : table.columns) {
        add_unit(field, column.name, column.unit);
        if (column.name == "position") continue;
        const auto array = column.components() == 2
                               ? vectors_of_pairs(column, table.count)
                               : borrowed(column.name, column.values, table.count, column.components());
        name_components(array);
        cloud->GetPointData()->AddArray(array);
    }
    const auto ids = numbers(table.count);
    ids->SetName("id");
    cloud->GetPointData()->AddArray(ids);
    add_unit(field, "id", "1");
    for (const PointConstant& constant : table.constants) add_constant(field, constant);
    add_text(field, "crs_wkt", table.crs_wkt);
    for (const auto& [name, text] : table.texts) add_text(field, name, text);
    vtkNew<WithBase64Stream<vtkXMLPolyDataWriter>> writer;
    write_xml(writer, cloud, file);
}

}  // namespace frana
