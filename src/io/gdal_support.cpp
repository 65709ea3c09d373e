#include "io/gdal_support.h"

#include <fmt/core.h>

#include <atomic>
#include <mutex>

#include "base/error.h"
#include "base/shell_word.h"

namespace frana::gdal {

Messages::Messages() { CPLPushErrorHandlerEx(hear, this); }

Messages::~Messages() {
    CPLPopErrorHandler();
    CPLErrorReset();
}

void Messages::hear(CPLErr kind, CPLErrorNum, const char* text) {
    auto& self = *static_cast<Messages*>(CPLGetErrorHandlerUserData());
    std::string line(text ? text : "");
    if (const auto end = line.find_first_of("\r\n"); end != std::string::npos) line.resize(end);
    if (kind == CE_Warning) self.warning_ = line;
    if (kind < CE_Failure) return;
    if (!self.failed_) self.failure_ = line;
    self.failed_ = true;
}

std::string Messages::reason(const std::string& otherwise) const {
    if (!failure_.empty()) return failure_;
    return warning_.empty() ? otherwise : warning_;
}

void Messages::clear() {
    failed_ = false;
    failure_.clear();
    warning_.clear();
}

void register_drivers() {
    static std::once_flag once;
    std::call_once(once, [] {
        const Messages quiet;
        GDALAllRegister();
    });
}

Dataset open(const std::filesystem::path& file, unsigned kind) {
    register_drivers();
    const Messages messages;
    std::error_code ignored;
    const auto kind_of_file = std::filesystem::status(file, ignored).type();
    using Type = std::filesystem::file_type;
    if (kind_of_file == Type::fifo || kind_of_file == Type::character || kind_of_file == Type::socket)
        throw UserError(
            fmt::format("{}: is a pipe or a device, which may never end; expected a file; copy what comes "
                        "out of it into a file",
                        file.string()));
    Dataset dataset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    if (dataset) return dataset;
    const bool raster = kind == GDAL_OF_RASTER;
    const char* wanted = raster ? "a raster that GDAL can read (GeoTIFF, ESRI ASCII grid, ...)"
                                : "a vector file that GDAL can read (GeoJSON, GeoPackage, Shapefile, ...)";
    if (!std::filesystem::exists(file, ignored))
        throw UserError(
            fmt::format("{}: no such file; expected {}; check the name, which is taken relative to the "
                        "case file's folder",
                        file.string(), wanted));
    throw UserError(fmt::format("{}: cannot be opened ({}); expected {}; try `{} {}`", file.string(),
                                messages.reason("unknown format"), wanted, raster ? "gdalinfo" : "ogrinfo -al -so",
                                shell_word(file.string())));
}

Dataset warp(const std::string& target, GDALDataset& source, const std::vector<std::string>& arguments) {
    CPLStringList list;
    for (const std::string& argument : arguments) list.AddString(argument.c_str());
    const std::unique_ptr<GDALWarpAppOptions, decltype(&GDALWarpAppOptionsFree)> options(
        GDALWarpAppOptionsNew(list.List(), nullptr), GDALWarpAppOptionsFree);
    if (!options) return nullptr;
    GDALDatasetH sources[] = {GDALDataset::ToHandle(&source)};
    int misuse = 0;
    return Dataset(GDALDataset::FromHandle(GDALWarp(target.c_str(), nullptr, 1, sources, options.get(), &misuse)));
}

std::string name_in_memory(const std::string& end) {
    static std::atomic<unsigned> count{0};
    return fmt::format("/vsimem/frana_{}_{}", count++, end);
}

std::string taken_from_memory(const std::string& held) {
    vsi_l_offset length = 0;
    const std::unique_ptr<GByte, decltype(&VSIFree)> bytes(VSIGetMemFileBuffer(held.c_str(), &length, TRUE), VSIFree);
    return bytes ? std::string(reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(length))
                 : std::string();
}

std::string sibling(const std::filesystem::path& file, const std::string& suffix) {
    return (file.parent_path() / (file.stem().string() + suffix + ".tif")).string();
}

}  // namespace frana::gdal
