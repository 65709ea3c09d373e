#include "vtk_io/writers_xml.h"

#include <fmt/core.h>
#include <vtkCallbackCommand.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "observe/file_arrays.h"

namespace frana {
namespace {

template <class Array>
vtkSmartPointer<vtkDataArray> filled(const Field& field, const std::vector<std::uint8_t>& outside) {
    auto array = vtkSmartPointer<Array>::New();
    array->SetNumberOfComponents(field.components);
    array->SetNumberOfTuples(field.count);
    copy_array(field, outside, array->GetPointer(0));
    return array;
}

vtkSmartPointer<vtkDataArray> ids(const Field& field, const std::vector<std::uint8_t>& outside) {
    std::vector<std::int64_t> values(static_cast<std::size_t>(field.count * field.components));
    copy_array(field, outside, values.data());
    auto array = vtkSmartPointer<vtkTypeInt64Array>::New();
    array->SetNumberOfComponents(field.components);
    array->SetNumberOfTuples(field.count);
    std::copy(values.begin(), values.end(), array->GetPointer(0));
    return array;
}

}  // namespace

vtkSmartPointer<vtkDataArray> to_vtk(const Field& field, const std::vector<std::uint8_t>& outside) {
    vtkSmartPointer<vtkDataArray> array;
    switch (storage_of(field)) {
        case Storage::int64:
            array = ids(field, outside);
            break;
        case Storage::float64:
            array = filled<vtkDoubleArray>(field, outside);
            break;
        case Storage::float32:
            array = filled<vtkFloatArray>(field, outside);
            break;
    }
    array->SetName(field.name.c_str());
    const auto names = component_names(field);
    for (std::size_t c = 0; c < names.size(); ++c) array->SetComponentName(static_cast<vtkIdType>(c), names[c].c_str());
    return array;
}

void add_unit(vtkFieldData* data, const std::string& name, const std::string& unit) {
    vtkNew<vtkStringArray> text;
    text->SetName((name + "_unit").c_str());
    text->InsertNextValue(unit);
    data->AddArray(text);
}

void add_time(vtkFieldData* data, double time) {
    vtkNew<vtkDoubleArray> value;
    value->SetName("TimeValue");
    value->InsertNextValue(time);
    data->AddArray(value);
}

vtkSmartPointer<vtkImageData> image_of(const GridGeometry& grid) {
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(static_cast<int>(grid.nx), static_cast<int>(grid.ny), 1);
    image->SetOrigin(grid.x0, grid.y0, 0.0);
    image->SetSpacing(grid.cell, grid.cell, grid.cell);
    return image;
}

void hide_nodes(vtkImageData* image, const std::vector<std::uint8_t>& outside) {
    if (outside.empty()) return;
    vtkNew<vtkUnsignedCharArray> marks, ghosts;
    marks->SetName("outside");
    ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    for (auto* array : {marks.Get(), ghosts.Get()}) array->SetNumberOfTuples(static_cast<vtkIdType>(outside.size()));
    for (std::size_t k = 0; k < outside.size(); ++k) {
        const unsigned char ghost = vtkDataSetAttributes::HIDDENPOINT;
        marks->SetValue(static_cast<vtkIdType>(k), outside[k]);
        ghosts->SetValue(static_cast<vtkIdType>(k), outside[k] ? ghost : static_cast<unsigned char>(0));
    }
    image->GetPointData()->AddArray(marks);
    image->GetPointData()->AddArray(ghosts);
    add_unit(image->GetFieldData(), "outside", "1");
}

/// Throws std::bad_alloc when so many bytes are not to be had.
static void require_memory(std::size_t bytes) {
    char* volatile room = new char[bytes];  // volatile: or the compiler drops it as unused
    delete[] room;
}

void write_xml(vtkXMLWriter* writer, vtkDataObject* data, const std::filesystem::path& target) {
    vtkNew<vtkCallbackCommand> quiet;  // without an observer VTK prints its errors; ours is thrown below
    writer->AddObserver("ErrorEvent", quiet);
    writer->GetExecutive()->AddObserver("ErrorEvent", quiet);
    writer->SetInputDataObject(data);
    // VTK 9.1 frees what it never got when memory ends within its writers, and crashes. Where the address space is
    // limited, what they need (compressed blocks, their base64) is reserved first.
    require_memory(std::size_t{3} * 512 * static_cast<std::size_t>(data->GetActualMemorySize()) +
                   (std::size_t{4} << 20));
    // To memory first: VTK 9.1 does not survive a full disk in this mode.
    writer->WriteToOutputStringOn();
    // Inline base64 is a third larger than appended bytes. Debian 12's ParaView 5.11 reads appended data (raw or
    // base64) with libexpat1 2.5.0-1+deb12u1. With the security update 2.5.0-1+deb12u5 it no longer does.
    writer->SetDataModeToBinary();
    writer->SetHeaderTypeToUInt64();
    writer->SetCompressorTypeToLZ4();
    const bool written = writer->Write() == 1;
    const unsigned long code = writer->GetErrorCode();
    if (!written || code != vtkErrorCode::NoError)
        throw UserError(fmt::format("{}: cannot be made: {}; report it with the case", target.string(),
                                    vtkErrorCode::GetStringFromErrorCode(code)));
    write_text(target, writer->GetOutputString());
}

}  // namespace frana
