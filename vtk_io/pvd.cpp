#include "vtk_io/pvd.h"

#include <fmt/core.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {

void write_pvd(const std::filesystem::path& pvd, const std::vector<PvdEntry>& entries) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
    for (const PvdEntry& entry : entries)
        text +=
            fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time, entry.file);
    write_text(pvd, text + "  </Collection>\n</VTKFile>\n");
}

std::vector<PvdEntry> read_pvd(const std::filesystem::path& pvd) {
    if (!std::filesystem::exists(pvd))
        throw UserError(
            fmt::format("{}: not found; a run directory with VTK output is expected (output.formats "
                        "with \"vtk\")",
                        pvd.string()));
    const auto root =
        vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(pvd.string().c_str()));
    vtkXMLDataElement* collection = root ? root->FindNestedElementWithName("Collection") : nullptr;
    if (!collection)
        throw UserError(
            fmt::format("{}: is not a ParaView collection (.pvd); run the case again", pvd.string()));
    std::vector<PvdEntry> entries;
    for (int k = 0; k < collection->GetNumberOfNestedElements(); ++k) {
        vtkXMLDataElement* line = collection->GetNestedElement(k);
        PvdEntry entry;
        const char* file = line->GetAttribute("file");
        if (!file || line->GetScalarAttribute("timestep", entry.time) != 1)
            throw UserError(
                fmt::format("{}: entry {} has no file or no timestep; run the case again", pvd.string(), k));
        entry.file = file;
        entries.push_back(entry);
    }
    return entries;
}

PvdSeries::PvdSeries(std::filesystem::path pvd, std::string stem, std::string extension)
    : pvd_(std::move(pvd)), stem_(std::move(stem)), extension_(std::move(extension)) {}

std::string PvdSeries::relative(std::int64_t number) const {
    return fmt::format("{0}/{0}_{1:06d}{2}", stem_, number, extension_);
}

std::filesystem::path PvdSeries::file(std::int64_t number) const {
    const std::filesystem::path file = pvd_.parent_path() / relative(number);
    std::error_code failure;
    std::filesystem::create_directories(file.parent_path(), failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be made: {}; give a folder that may be written with --out",
                                    file.parent_path().string(), failure.message()));
    return file;
}

void PvdSeries::add(std::int64_t number, double time) {
    const PvdEntry entry{time, relative(number)};
    const auto same = std::find_if(entries_.begin(), entries_.end(),
                                   [&](const PvdEntry& other) { return other.file == entry.file; });
    if (same == entries_.end())
        entries_.push_back(entry);
    else
        *same = entry;
    write_pvd(pvd_, entries_);
}

}  // namespace frana
