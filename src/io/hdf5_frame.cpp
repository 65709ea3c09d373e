#include "io/hdf5_frame.h"

#include <fmt/core.h>
#include <omp.h>

#include <type_traits>

#include "base/error.h"
#include "io/hdf5_packing.h"
#include "io/hdf5_support.h"
#include "observe/file_arrays.h"

namespace frana {

using hdf5::Handle;
using hdf5::put_numbers;
using hdf5::put_text;

namespace {

/// The file while it is written, and where its arrays came to lie.
struct Output : hdf5::Access {
    using Access::Access;
    std::vector<FileExtent> arrays;
};

/// Types of a number in memory and in the file.
struct NumberType {
    hid_t memory, file;
};
template <class T>
NumberType number_type() {
    if constexpr (std::is_same_v<T, float>)
        return {H5T_NATIVE_FLOAT, H5T_IEEE_F32LE};
    else if constexpr (std::is_same_v<T, double>)
        return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
    else if constexpr (std::is_same_v<T, std::int64_t>)
        return {H5T_NATIVE_INT64, H5T_STD_I64LE};
    else {
        static_assert(std::is_same_v<T, std::uint8_t>, "no such type in a file");
        return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
    }
}

/// Long arrays are packed: most of a grid is where no flow is. Short ones would be longer with the tables of their chunks.
bool is_packed(const std::vector<hsize_t>& shape, std::size_t bytes_of_a_number) {
    constexpr hsize_t kShort = hsize_t{1} << 14;  // bytes
    hsize_t bytes = bytes_of_a_number;
    for (const hsize_t length : shape) bytes *= length;
    return bytes >= kShort;
}

/// Notes where an array came to lie.
void note_extents(Output& output, hid_t set) {
    if (const haddr_t at = H5Dget_offset(set); at != HADDR_UNDEF) {
        output.arrays.push_back({static_cast<Index>(at), static_cast<Index>(H5Dget_storage_size(set))});
        return;
    }
    const Handle creation(output, H5Dget_create_plist(set), H5Pclose);
    if (H5Pget_layout(creation) != H5D_CHUNKED) return;
    output.check(H5Dflush(set));  // chunks have no place before
    const Handle space(output, H5Dget_space(set), H5Sclose);
    hsize_t chunks = 0;
    output.check(H5Dget_num_chunks(set, space, &chunks));
    for (hsize_t k = 0; k < chunks; ++k) {
        haddr_t at = 0;
        hsize_t bytes = 0;
        output.check(H5Dget_chunk_info(set, space, k, nullptr, nullptr, &at, &bytes));
        output.arrays.push_back({static_cast<Index>(at), static_cast<Index>(bytes)});
    }
}

template <class T>
void put_array(Output& output, hid_t group, const std::string& name, const std::string& unit,
               const std::vector<hsize_t>& shape, const T* values, const std::vector<std::string>& components) {
    const Handle space(output, H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
    const Handle creation(output, H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    output.check(H5Pset_obj_track_times(creation, false));  // the same run gives the same file
    const bool packed = is_packed(shape, sizeof(T));
    if (packed) hdf5::set_packed(output, creation, shape, sizeof(T));
    Handle set(output,
               H5Dcreate2(group, name.c_str(), number_type<T>().file, space, H5P_DEFAULT, creation, H5P_DEFAULT),
               H5Dclose);
    if (packed)
        hdf5::write_packed(output, set, shape, sizeof(T), values, omp_get_max_threads());
    else
        hdf5::write_whole(output, set, number_type<T>().memory, values);
    put_text(output, set, "unit", unit);
    std::string listed;
    for (const auto& component : components) listed += (listed.empty() ? "" : " ") + component;
    if (!listed.empty()) put_text(output, set, "components", listed);
    note_extents(output, set);
    set.close();
}

template <class T>
void put_array(Output& output, hid_t group, const Field& field, std::vector<hsize_t> shape,
               const std::vector<std::uint8_t>& outside) {
    std::vector<T> values(static_cast<std::size_t>(field.count * field.components));
    copy_array(field, outside, values.data());
    if (field.components > 1) shape.push_back(static_cast<hsize_t>(field.components));
    put_array(output, group, field.name, field.unit, shape, values.data(), component_names(field));
}

void put_field(Output& output, hid_t group, const Field& field, const std::vector<hsize_t>& shape,
               const std::vector<std::uint8_t>& outside) {
    switch (storage_of(field)) {
        case Storage::int64:
            return put_array<std::int64_t>(output, group, field, shape, outside);
        case Storage::float64:
            return put_array<double>(output, group, field, shape, outside);
        case Storage::float32:
            return put_array<float>(output, group, field, shape, outside);
    }
}

Handle new_group(Output& output, hid_t parent, const std::string& name) {
    return {output, H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

void put_grid(Output& output, hid_t parent, const Frame& frame, const std::vector<std::uint8_t>& outside) {
    const GridGeometry& grid = frame.grid;
    const Handle group = new_group(output, parent, "grid");
    put_numbers(output, group, "origin", {grid.x0, grid.y0, 0.0});
    put_numbers(output, group, "cell", {grid.cell});
    const std::vector<hsize_t> shape{1, static_cast<hsize_t>(grid.ny), static_cast<hsize_t>(grid.nx)};
    for (const Field& field : frame.nodes) {
        expect(field.count == grid.size(), "a node array is not as long as the grid");
        put_field(output, group, field, shape, outside);
    }
    if (!outside.empty()) put_array(output, group, "outside", "1", shape, outside.data(), {});
}

void put_particles(Output& output, hid_t parent, const Frame& frame) {
    const Field* position = frame.particle("position");
    expect(position && position->components == 3, "particles have no position of 3 components");
    const Handle group = new_group(output, parent, "particles");
    for (const Field& field : frame.particles) {
        expect(field.count == position->count, "particle arrays differ in length");
        put_field(output, group, field, {static_cast<hsize_t>(field.count)}, {});
    }
}

Handle open_file(Output& output, bool fresh) {
    // Without locks a viewer that has the file open cannot stop the run, nor the run the viewer.
    const Handle access(output, H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    output.check(H5Pset_file_locking(access, false, true));
    const std::string file = output.file().string();
    // Most arrays are one chunk: the usual tables of 64 would be stored with each state.
    const Handle creation(output, H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    output.check(H5Pset_istore_k(creation, 2));
    return {
        output,
        fresh ? H5Fcreate(file.c_str(), H5F_ACC_TRUNC, creation, access) : H5Fopen(file.c_str(), H5F_ACC_RDWR, access),
        H5Fclose};
}

/// Space that a frame needs at most, its metadata included [bytes].
off_t space_for(const Frame& frame) {
    Index numbers = frame.grid.size(), fields = 1;
    for (const auto* list : {&frame.particles, &frame.nodes})
        for (const Field& field : *list) {
            numbers += field.count * field.components;
            ++fields;
        }
    return static_cast<off_t>(8 * numbers + 4096 * fields + 65536);
}

}  // namespace

std::string frame_group(Index number) { return fmt::format("frame_{:06d}", number); }

std::vector<FileExtent> append_frame(const std::filesystem::path& path, bool fresh, const Frame& frame,
                                     const std::vector<std::uint8_t>& outside) {
    const hdf5::QuietErrors quiet;
    Output output(path);
    if (fresh) open_file(output, true).close();
    hdf5::reserve(output, path, space_for(frame));
    Handle file = open_file(output, false);
    const std::string name = frame_group(frame.number);
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0) output.check(H5Ldelete(file, name.c_str(), H5P_DEFAULT));
    {
        const Handle group = new_group(output, file, name);
        put_numbers(output, group, "time", {frame.status.time});
        put_numbers(output, group, "number", {static_cast<double>(frame.number)});
        put_grid(output, group, frame, outside);
        put_particles(output, group, frame);
    }
    output.check(H5Fflush(file, H5F_SCOPE_GLOBAL));
    file.close();
    return output.arrays;
}

}  // namespace frana
