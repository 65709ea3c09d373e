#include "io/gdal_sum.h"

#include <cpl_vsi.h>
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "base/checksum.h"
#include "base/error.h"
#include "io/gdal_support.h"

namespace frana {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The file, and what GDAL reads along with it where it is GDAL's.
std::vector<std::string> files_behind(const std::filesystem::path& file) {
    gdal::register_drivers();
    const gdal::Messages quiet;
    const gdal::Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR | GDAL_OF_READONLY));
    const CPLStringList listed(dataset ? dataset->GetFileList() : nullptr);
    std::vector<std::string> files;
    for (int k = 0; k < listed.size(); ++k)
        if (!ends_with(listed[k], ".aux.xml") && !ends_with(listed[k], ".ovr")) files.emplace_back(listed[k]);
    if (files.empty()) files.push_back(file.string());
    return files;
}

struct CloseFile {
    void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// Through GDAL, which reads files within archives as well.
std::uint64_t sum_of_file(const std::string& name) {
    Checksum sum;
    const std::unique_ptr<VSILFILE, CloseFile> file(VSIFOpenL(name.c_str(), "rb"));
    std::vector<char> piece(1 << 20);
    while (file) {
        const std::size_t bytes = VSIFReadL(piece.data(), 1, piece.size(), file.get());
        sum.add(piece.data(), bytes);
        if (bytes < piece.size()) break;
    }
    return sum.sum();
}

}  // namespace

std::string sum_of_input(const std::filesystem::path& file) {
    const gdal::Messages quiet;
    VSIStatBufL there;
    if (VSIStatL(file.c_str(), &there) != 0) return "missing";
    Checksum all;
    for (const std::string& name : files_behind(file)) {
        const std::uint64_t sum = sum_of_file(name);
        all.add(&sum, sizeof sum);
    }
    return fmt::format("{:016x}", all.sum());
}

}  // namespace frana
