#include "vtk_io/xml_reading.h"

#include <fmt/core.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkDataArraySelection.h>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkXMLReader.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace frana {
namespace {

/// VTK 9.1 crashes on an array of an unknown type.
bool knows_type_in(std::string_view tag) {
    constexpr std::array<std::string_view, 12> kTypes = {"Float32", "Float64", "Int8",  "UInt8",  "Int16",  "UInt16",
                                                         "Int32",   "UInt32",  "Int64", "UInt64", "String", "Bit"};
    const std::string_view key = " type=\"";
    const std::size_t found = tag.find(key);
    if (found == tag.npos) return false;
    const std::string_view rest = tag.substr(found + key.size());
    return std::find(kTypes.begin(), kTypes.end(), rest.substr(0, rest.find('"'))) != kTypes.end();
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    const std::streamoff end = stream.tellg();
    std::string text(end > 0 ? static_cast<std::size_t>(end) : 0, '\0');
    stream.seekg(0);
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return text;
}

/// Every array of the file is of a type that VTK has.
bool types_are_known(std::string_view all) {
    for (std::size_t at = all.find('<'); at != all.npos; at = all.find('<', at + 1)) {
        const std::string_view tag = all.substr(at, all.find('>', at) - at);
        if (tag.rfind("<AppendedData", 0) == 0) return true;  // bytes of any kind follow
        const bool is_array = tag.rfind("<DataArray", 0) == 0 || tag.rfind("<Array", 0) == 0;
        if (is_array && !knows_type_in(tag)) return false;
    }
    return true;
}

/// The text without the numbers of the points' arrays that are not wanted. VTK's parser goes through all of a text, and
/// takes most of the time of reading a few arrays.
std::string without_numbers(const std::string& text, const std::function<bool(const std::string& array)>& wanted) {
    const std::string head = "<DataArray", name_mark = " Name=\"", tail = "</DataArray>";
    const std::size_t all = std::min(text.find("</PointData>"), text.size());
    std::string kept;
    std::size_t done = 0;
    for (std::size_t at = text.find(head, text.find("<PointData")); at < all; at = text.find(head, at + 1)) {
        const std::size_t close = text.find('>', at), mark = text.find(name_mark, at), name = mark + name_mark.size();
        if (close >= all || text[close - 1] == '/' || mark >= close) continue;
        if (wanted(text.substr(name, text.find('"', name) - name))) continue;
        kept.append(text, done, close + 1 - done);
        done = std::min(text.find(tail, close), all);
    }
    return kept.append(text, done, std::string::npos);
}

}  // namespace

bool read_xml(vtkXMLReader* reader, const std::filesystem::path& file,
              const std::function<bool(const std::string& array)>& wanted) {
    const std::string text = bytes_of(file);
    if (!types_are_known(text)) return false;
    bool complained = false;
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(&complained);
    listener->SetCallback([](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
    for (const char* event : {"ErrorEvent", "WarningEvent"}) {
        reader->AddObserver(event, listener);
        reader->GetExecutive()->AddObserver(event, listener);
    }
    reader->SetParserErrorObserver(listener);
    if (!reader->CanReadFile(file.string().c_str())) return false;
    reader->SetFileName(file.string().c_str());
    if (wanted) {
        reader->SetReadFromInputString(1);
        reader->SetInputString(without_numbers(text, wanted));
    }
    try {
        if (wanted) {
            reader->UpdateInformation();
            vtkDataArraySelection* const arrays = reader->GetPointDataArraySelection();
            for (int k = 0; k < arrays->GetNumberOfArrays(); ++k)
                arrays->SetArraySetting(arrays->GetArrayName(k), wanted(arrays->GetArrayName(k)) ? 1 : 0);
        }
        reader->Update();
    } catch (const std::length_error&) {  // of a block that claims more than any memory has
        return false;
    }
    return !complained && reader->GetErrorCode() == vtkErrorCode::NoError;
}

std::string fault_of(vtkPolyData* mesh) {
    const vtkIdType points = mesh->GetNumberOfPoints();
    for (vtkCellArray* cells : {mesh->GetVerts(), mesh->GetLines(), mesh->GetPolys(), mesh->GetStrips()}) {
        if (cells->GetNumberOfCells() == 0 && cells->GetNumberOfConnectivityIds() == 0) continue;
        if (!cells->IsValid()) return "its lists of faces and of their corners do not fit each other";
        double range[2];
        cells->GetConnectivityArray()->GetRange(range);
        if (range[0] < 0.0 || range[1] >= static_cast<double>(points))
            return fmt::format("a face names point {:.0f}, counted from 0, of {} points",
                               range[0] < 0.0 ? range[0] : range[1], points);
    }
    return "";
}

}  // namespace frana
