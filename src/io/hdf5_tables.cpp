// Saving and putting back what HDF5 changes in place while a file grows.
#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/hdf5_frame.h"

namespace frana {
namespace {

/// What of the first `bytes` of a file lies outside `arrays`.
std::vector<FileExtent> between(std::vector<FileExtent> arrays, Index bytes) {
    std::sort(arrays.begin(), arrays.end(), [](const auto& a, const auto& b) { return a.offset < b.offset; });
    std::vector<FileExtent> gaps;
    Index from = 0;
    for (const FileExtent& array : arrays) {
        if (array.offset > from) gaps.push_back({from, array.offset - from});
        from = std::max(from, array.offset + array.bytes);
    }
    if (bytes > from) gaps.push_back({from, bytes - from});
    return gaps;
}

UserError trouble(const std::filesystem::path& file, const char* what) {
    return UserError(
        fmt::format("{}: {}; check the file, its permissions and the disk's free space", file.string(), what));
}

}  // namespace

std::vector<std::uint8_t> tables_of(const std::filesystem::path& file, std::vector<FileExtent> arrays) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    const auto bytes = static_cast<Index>(stream.tellg());
    std::vector<std::uint8_t> tables;
    for (const FileExtent& gap : between(std::move(arrays), bytes)) {
        const std::size_t at = tables.size();
        tables.resize(at + static_cast<std::size_t>(gap.bytes));
        stream.seekg(gap.offset);
        stream.read(reinterpret_cast<char*>(tables.data() + at), gap.bytes);
    }
    if (!stream) throw trouble(file, "cannot be read");
    return tables;
}

void put_tables_back(const std::filesystem::path& file, Index bytes, std::vector<FileExtent> arrays,
                     const std::vector<std::uint8_t>& tables) {
    cut_back(file, static_cast<std::uintmax_t>(bytes));
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    std::size_t at = 0;
    for (const FileExtent& gap : between(std::move(arrays), bytes)) {
        const auto length = static_cast<std::size_t>(gap.bytes);
        if (at + length > tables.size()) throw trouble(file, "the kept tables do not belong to it");
        stream.seekp(gap.offset);
        stream.write(reinterpret_cast<const char*>(tables.data() + at), gap.bytes);
        at += length;
    }
    stream.flush();
    if (!stream) throw trouble(file, "cannot be written");
}

}  // namespace frana
