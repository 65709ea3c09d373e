#include "io/hdf5_frame.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <type_traits>

#include "base/error.h"
#include "observe/file_columns.h"

namespace frana {
namespace {

/// Keeps the innermost reason of the error stack that names what the system said.
herr_t keep_reason(unsigned, const H5E_error2_t* error, void* text) {
    auto& reason = *static_cast<std::string*>(text);
    const std::string said = error->desc ? error->desc : "";
    const auto from = said.find("error message = '");
    if (from != std::string::npos)
        reason = said.substr(from + 17, said.find('\'', from + 17) - from - 17);
    else if (reason.empty())
        reason = said;
    return 0;
}

/// Silences HDF5's printing while errors are thrown instead.
class QuietErrors {
public:
    QuietErrors() {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

private:
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

/// The file while it is written: every HDF5 result passes `check`, which throws with the file's name.
class Output {
public:
    explicit Output(std::filesystem::path file) : file_(std::move(file)) {}

    template <class Result>
    Result check(Result result) const {
        if (result >= 0) return result;
        std::string reason;
        H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason);
        throw failure(reason.empty() ? "HDF5 failed" : reason);
    }
    UserError failure(const std::string& reason) const {
        return UserError(
            fmt::format("{}: cannot be written: {}; check the folder's permissions and free space",
                        file_.string(), reason));
    }
    const std::filesystem::path& file() const { return file_; }

private:
    std::filesystem::path file_;
};

/// An HDF5 identifier with its closing function.
class Handle {
public:
    Handle(const Output& output, hid_t id, herr_t (*closer)(hid_t))
        : output_(output), id_(output.check(id)), closer_(closer) {}
    ~Handle() {
        if (id_ >= 0) closer_(id_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }
    /// Closes and checks; what is still in memory is written now, so a full disk shows here.
    void close() {
        const hid_t id = id_;
        id_ = -1;
        output_.check(closer_(id));
    }

private:
    const Output& output_;
    hid_t id_;
    herr_t (*closer_)(hid_t);
};

void put_text(const Output& output, hid_t object, const char* name, const std::string& text) {
    const Handle type(output, H5Tcopy(H5T_C_S1), H5Tclose);
    output.check(H5Tset_size(type, text.size() + 1));
    output.check(H5Tset_cset(type, H5T_CSET_UTF8));
    const Handle space(output, H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(output, H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    output.check(H5Awrite(attribute, type, text.c_str()));
}

void put_numbers(const Output& output, hid_t object, const char* name, const std::vector<double>& numbers) {
    const hsize_t count = numbers.size();
    const Handle space(
        output, numbers.size() == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle attribute(output, H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    output.check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data()));
}

/// Types of a number in memory and in the file.
struct NumberType {
    hid_t memory, file;
};
template <class T>
NumberType number_type() {
    if constexpr (std::is_same_v<T, float>) return {H5T_NATIVE_FLOAT, H5T_IEEE_F32LE};
    if constexpr (std::is_same_v<T, double>) return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
    if constexpr (std::is_same_v<T, std::int64_t>) return {H5T_NATIVE_INT64, H5T_STD_I64LE};
    if constexpr (std::is_same_v<T, std::uint8_t>) return {H5T_NATIVE_UINT8, H5T_STD_U8LE};
}

template <class T>
void put_array(const Output& output, hid_t group, const std::string& name, const std::string& unit,
               const std::vector<hsize_t>& shape, const T* values,
               const std::vector<std::string>& components) {
    const Handle space(output, H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                       H5Sclose);
    Handle set(
        output,
        H5Dcreate2(group, name.c_str(), number_type<T>().file, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    if (H5Sget_simple_extent_npoints(space) > 0)
        output.check(H5Dwrite(set, number_type<T>().memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    put_text(output, set, "unit", unit);
    std::string listed;
    for (const auto& component : components) listed += (listed.empty() ? "" : " ") + component;
    if (!listed.empty()) put_text(output, set, "components", listed);
    set.close();
}

template <class T>
void put_column(const Output& output, hid_t group, const Field& field, std::vector<hsize_t> shape,
                const std::vector<std::uint8_t>& outside) {
    std::vector<T> values(static_cast<std::size_t>(field.count * field.components));
    copy_column(field, outside, values.data());
    if (field.components > 1) shape.push_back(static_cast<hsize_t>(field.components));
    put_array(output, group, field.name, field.unit, shape, values.data(), component_names(field));
}

void put_field(const Output& output, hid_t group, const Field& field, const std::vector<hsize_t>& shape,
               const std::vector<std::uint8_t>& outside) {
    switch (storage_of(field)) {
        case Storage::int64:
            return put_column<std::int64_t>(output, group, field, shape, outside);
        case Storage::float64:
            return put_column<double>(output, group, field, shape, outside);
        case Storage::float32:
            return put_column<float>(output, group, field, shape, outside);
    }
}

Handle new_group(const Output& output, hid_t parent, const std::string& name) {
    return {output, H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

void put_grid(const Output& output, hid_t parent, const Frame& frame,
              const std::vector<std::uint8_t>& outside) {
    const GridGeometry& grid = frame.grid;
    const Handle group = new_group(output, parent, "grid");
    put_numbers(output, group, "origin", {grid.x0, grid.y0, 0.0});
    put_numbers(output, group, "cell", {grid.cell});
    const std::vector<hsize_t> shape{1, static_cast<hsize_t>(grid.ny), static_cast<hsize_t>(grid.nx)};
    for (const Field& field : frame.nodes) {
        expect(field.count == grid.size(), "a node column is not as long as the grid");
        put_field(output, group, field, shape, outside);
    }
    if (!outside.empty()) put_array(output, group, "outside", "1", shape, outside.data(), {});
}

void put_particles(const Output& output, hid_t parent, const Frame& frame) {
    const Field* position = frame.particle("position");
    expect(position && position->components == 3, "particles have no position of 3 components");
    const Handle group = new_group(output, parent, "particles");
    for (const Field& field : frame.particles) {
        expect(field.count == position->count, "particle columns differ in length");
        put_field(output, group, field, {static_cast<hsize_t>(field.count)}, {});
    }
}

Handle open_file(const Output& output, bool fresh) {
    // Without locks a viewer that has the file open cannot stop the run, nor the run the viewer.
    const Handle access(output, H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    output.check(H5Pset_file_locking(access, false, true));
    const std::string file = output.file().string();
    return {output,
            fresh ? H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                  : H5Fopen(file.c_str(), H5F_ACC_RDWR, access),
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

/// Asks the system for the space before HDF5 writes: HDF5 leaves a broken file behind (and crashes at exit)
/// when the disk fills up under it. What is too much is given back when HDF5 closes the file.
void reserve(const Output& output, off_t bytes) {
    const int file = ::open(output.file().c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) throw output.failure(std::strerror(errno));
    struct stat before {};
    int problem = ::fstat(file, &before) == 0 ? 0 : errno;
    if (problem == 0) problem = ::posix_fallocate(file, before.st_size, bytes);
    if (problem != 0 && ::ftruncate(file, before.st_size) != 0) problem = errno;
    ::close(file);
    if (problem != 0) throw output.failure(std::strerror(problem));
}

}  // namespace

std::string frame_group(Index number) { return fmt::format("frame_{:06d}", number); }

void append_frame(const std::filesystem::path& path, bool fresh, const Frame& frame,
                  const std::vector<std::uint8_t>& outside) {
    const QuietErrors quiet;
    const Output output(path);
    if (fresh) open_file(output, true).close();
    reserve(output, space_for(frame));
    Handle file = open_file(output, false);
    const std::string name = frame_group(frame.number);
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
        output.check(H5Ldelete(file, name.c_str(), H5P_DEFAULT));
    {
        const Handle group = new_group(output, file, name);
        put_numbers(output, group, "time", {frame.status.time});
        put_numbers(output, group, "number", {static_cast<double>(frame.number)});
        put_grid(output, group, frame, outside);
        put_particles(output, group, frame);
    }
    output.check(H5Fflush(file, H5F_SCOPE_GLOBAL));
    file.close();
}

}  // namespace frana
