#include "vtk_io/pvd.h"

#include <fmt/core.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {

void write_pvd(const std::filesystem::path& pvd, const std::vector<PvdEntry>& entries) {
    std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
    for (const PvdEntry& entry : entries)
        text += fmt::format("    <DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time, entry.file);
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
        throw UserError(fmt::format("{}: is not a ParaView collection (.pvd); run the case again", pvd.string()));
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
    std::filesystem::path file = pvd_.parent_path() / relative(number);
    std::error_code failure;
    std::filesystem::create_directories(file.parent_path(), failure);
    if (failure)
        throw UserError(fmt::format("{}: cannot be made: {}; give a folder that may be written with --out",
                                    file.parent_path().string(), failure.message()));
    return file;
}

void PvdSeries::serialize(Archive& archive) {
    std::vector<double> times;
    std::vector<std::string> files;
    for (const PvdEntry& entry : entries_) {
        times.push_back(entry.time);
        files.push_back(entry.file);
    }
    archive.array("times", times);
    archive.texts("files", files);
    if (!archive.loading()) return;
    entries_.clear();
    for (std::size_t i = 0; i < files.size(); ++i) entries_.push_back({times.at(i), files[i]});
    take_back_others();
    if (!entries_.empty())
        write_pvd(pvd_, entries_);
    else
        std::filesystem::remove(pvd_);
}

/// The folder holds the files of the list and no other of the series.
void PvdSeries::take_back_others() const {
    namespace fs = std::filesystem;
    std::set<std::string> listed;
    for (const PvdEntry& entry : entries_) {
        if (!fs::exists(pvd_.parent_path() / entry.file))
            throw UserError(
                fmt::format("{}: not found; expected a file that the run had written when its state was "
                            "kept; put it back, or run without --resume",
                            (pvd_.parent_path() / entry.file).string()));
        listed.insert(entry.file);
    }
    std::error_code none;  // a folder that is not there holds nothing
    for (const auto& found : fs::directory_iterator(pvd_.parent_path() / stem_, none)) {
        const std::string name = found.path().filename().string();
        const bool ours = name.rfind(stem_ + "_", 0) == 0 && found.path().extension() == extension_;
        if (ours && listed.count(stem_ + "/" + name) == 0) fs::remove(found.path());
    }
}

void PvdSeries::add(std::int64_t number, double time) {
    const PvdEntry entry{time, relative(number)};
    const auto same =
        std::find_if(entries_.begin(), entries_.end(), [&](const PvdEntry& other) { return other.file == entry.file; });
    if (same == entries_.end())
        entries_.push_back(entry);
    else
        *same = entry;
    write_pvd(pvd_, entries_);
}

}  // namespace frana
