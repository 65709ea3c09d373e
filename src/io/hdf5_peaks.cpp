#include "io/hdf5_peaks.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numeric>

#include "base/atomic_file.h"
#include "io/hdf5_support.h"

namespace frana {

using hdf5::Access;
using hdf5::Handle;

namespace {

/// One dataset of numbers, in chunks that are shuffled and deflated.
template <class Number>
void put(const Access& access, hid_t file, const std::string& name, hid_t stored, hid_t type,
         const std::vector<Number>& numbers) {
    constexpr hsize_t chunk_at_most = 65536;
    const hsize_t count = numbers.size(), chunk = std::max<hsize_t>(1, std::min(chunk_at_most, count));
    const Handle space(access, H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle how(access, H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (count > 0) {
        access.check(H5Pset_chunk(how, 1, &chunk));
        access.check(H5Pset_shuffle(how));
        access.check(H5Pset_deflate(how, 4));
    }
    const Handle set(access, H5Dcreate2(file, name.c_str(), stored, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose);
    if (count > 0) access.check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
}

template <class Number>
std::vector<Number> get(const Access& access, hid_t file, const std::string& name, hid_t type) {
    const Handle set(access, H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(access, H5Dget_space(set), H5Sclose);
    std::vector<Number> numbers(static_cast<std::size_t>(access.check(H5Sget_simple_extent_npoints(space))));
    if (!numbers.empty()) access.check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()));
    return numbers;
}

void put_indices(const Access& access, hid_t file, const std::string& name, const std::vector<std::int64_t>& numbers) {
    put(access, file, name, H5T_STD_I64LE, H5T_NATIVE_INT64, numbers);
}

std::vector<std::int64_t> get_indices(const Access& access, hid_t file, const std::string& name) {
    return get<std::int64_t>(access, file, name, H5T_NATIVE_INT64);
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
    return text;
}

std::vector<std::string> words_of(const Access& access, hid_t file) {
    const Handle attribute(access, H5Aopen(file, "fields", H5P_DEFAULT), H5Aclose);
    const Handle type(access, H5Aget_type(attribute), H5Tclose);
    std::string text(H5Tget_size(type), '\0');
    access.check(H5Aread(attribute, type, text.data()));
    std::vector<std::string> words(1);
    for (const char letter : text) {
        if (letter == '\0') break;
        if (letter == ' ')
            words.emplace_back();
        else
            words.back() += letter;
    }
    return words;
}

/// The bytes of the file, made in memory. HDF5 cannot close a compressed file that the disk has no room for.
std::vector<char> bytes_of(const Access& access, const PeakBlock& block) {
    const Handle memory(access, H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    access.check(H5Pset_fapl_core(memory, std::size_t{1} << 20, false));
    const Handle file(access, H5Fcreate(access.file().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, memory), H5Fclose);
    const GridGeometry& g = block.grid;
    hdf5::put_numbers(access, file, "grid", {double(g.nx), double(g.ny), g.x0, g.y0, g.cell});
    hdf5::put_text(access, file, "fields", joined(block.fields));
    std::vector<std::int64_t> rows, pixels, first, count;
    for (const SparseRasters& peaks : block.peaks) {
        rows.push_back(static_cast<std::int64_t>(peaks.rows.size()));
        pixels.push_back(peaks.pixels());
        for (const auto& row : peaks.rows) first.push_back(row.first), count.push_back(row.count);
    }
    put_indices(access, file, "sample", block.samples);
    put_indices(access, file, "rows", rows);
    put_indices(access, file, "pixels", pixels);
    put_indices(access, file, "first", first);
    put_indices(access, file, "count", count);
    for (std::size_t f = 0; f < block.fields.size(); ++f) {
        std::vector<float> values;
        for (const SparseRasters& peaks : block.peaks)
            if (f < peaks.values.size()) values.insert(values.end(), peaks.values[f].begin(), peaks.values[f].end());
        put(access, file, block.fields[f], H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, values);
    }
    access.check(H5Fflush(file, H5F_SCOPE_GLOBAL));
    std::vector<char> bytes(static_cast<std::size_t>(access.check(H5Fget_file_image(file, nullptr, 0))));
    access.check(H5Fget_file_image(file, bytes.data(), bytes.size()));
    return bytes;
}

}  // namespace

void write_peaks(const std::filesystem::path& target, const PeakBlock& block) {
    std::vector<char> bytes;
    {
        const hdf5::QuietErrors quiet;
        bytes = bytes_of(Access(target), block);
    }
    AtomicFile made(target);
    std::ofstream stream(made.path(), std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream)
        throw UserError(
            fmt::format("{}: cannot be written; check the folder's permissions and free space", target.string()));
    made.commit_to_disk();
}

PeakBlock read_peaks(const std::filesystem::path& from, const std::vector<std::string>& wanted) {
    const hdf5::QuietErrors quiet;
    const Access access(from, Access::Mode::read);
    const Handle file(access, H5Fopen(from.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Handle attribute(access, H5Aopen(file, "grid", H5P_DEFAULT), H5Aclose);
    double grid[5] = {};
    const Handle space(access, H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 5) throw access.failure("its grid is not that of an ensemble");
    access.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, grid));
    PeakBlock block;
    block.grid = {static_cast<Index>(grid[0]), static_cast<Index>(grid[1]), grid[2], grid[3], grid[4]};
    block.fields = words_of(access, file);
    block.samples = get_indices(access, file, "sample");
    const auto rows = get_indices(access, file, "rows"), pixels = get_indices(access, file, "pixels"),
               first = get_indices(access, file, "first"), count = get_indices(access, file, "count");
    const auto sum = [](const auto& numbers) {
        return std::accumulate(numbers.begin(), numbers.end(), std::int64_t{0});
    };
    if (rows.size() != block.samples.size() || pixels.size() != rows.size() || count.size() != first.size() ||
        sum(rows) != static_cast<std::int64_t>(first.size()) || sum(count) != sum(pixels))
        throw access.failure("its rows are not those of its samples");
    std::size_t row = 0;
    for (const std::int64_t many : rows) {
        SparseRasters& peaks = block.peaks.emplace_back();
        for (std::int64_t k = 0; k < many; ++k, ++row) {
            if (first[row] < 0 || count[row] < 1 || first[row] + count[row] > block.grid.size())
                throw access.failure("its rows lie outside of its grid");
            peaks.rows.push_back({first[row], count[row]});
        }
    }
    for (const std::string& field : block.fields) {
        if (std::find(wanted.begin(), wanted.end(), field) == wanted.end()) {
            for (SparseRasters& peaks : block.peaks) peaks.values.emplace_back();
            continue;
        }
        const auto values = get<float>(access, file, field, H5T_NATIVE_FLOAT);
        if (static_cast<std::int64_t>(values.size()) != sum(pixels)) throw access.failure("a field has other pixels");
        auto from_value = values.begin();
        for (SparseRasters& peaks : block.peaks) {
            peaks.values.emplace_back(from_value, from_value + peaks.pixels());
            from_value += peaks.pixels();
        }
    }
    return block;
}

}  // namespace frana
