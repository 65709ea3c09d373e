#include "io/hdf5_support.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace frana::hdf5 {
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

}  // namespace

std::string Access::last_reason() {
    std::string reason;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_reason, &reason);
    return reason.empty() ? "HDF5 failed" : reason;
}

UserError Access::failure(const std::string& reason) const {
    if (mode_ == Mode::read)
        return UserError(
            fmt::format("{}: cannot be read: {}; check the file and its permissions", file_.string(), reason));
    return UserError(fmt::format("{}: cannot be written: {}; check the folder's permissions and free space",
                                 file_.string(), reason));
}

void put_text(const Access& access, hid_t object, const char* name, const std::string& text) {
    const Handle type(access, H5Tcopy(H5T_C_S1), H5Tclose);
    access.check(H5Tset_size(type, text.size() + 1));
    access.check(H5Tset_cset(type, H5T_CSET_UTF8));
    const Handle space(access, H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(access, H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    access.check(H5Awrite(attribute, type, text.c_str()));
}

void put_numbers(const Access& access, hid_t object, const char* name, const std::vector<double>& numbers) {
    const hsize_t count = numbers.size();
    const Handle space(access, numbers.size() == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr),
                       H5Sclose);
    const Handle attribute(access, H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    access.check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data()));
}

std::size_t axis_of(const std::vector<hsize_t>& shape) {
    std::size_t axis = 0;
    while (axis + 1 < shape.size() && shape[axis] == 1) ++axis;
    return axis;
}

namespace {

/// What follows the axis, for each of its places.
hsize_t bytes_of_a_row(const std::vector<hsize_t>& shape, std::size_t axis, std::size_t bytes_of_a_number) {
    hsize_t row = bytes_of_a_number;
    for (std::size_t n = axis + 1; n < shape.size(); ++n) row *= shape[n];
    return row;
}

}  // namespace

std::vector<hsize_t> piece_of(std::vector<hsize_t> shape, std::size_t bytes_of_a_number, hsize_t most) {
    if (shape.empty()) return shape;
    const std::size_t axis = axis_of(shape);
    const hsize_t row = bytes_of_a_row(shape, axis, bytes_of_a_number);
    if (row > 0) shape[axis] = std::min(shape[axis], std::max<hsize_t>(1, most / row));
    return shape;
}

void write_whole(const Access& access, hid_t set, hid_t type, const void* values) {
    const Handle space(access, H5Dget_space(set), H5Sclose);
    std::vector<hsize_t> shape(static_cast<std::size_t>(access.check(H5Sget_simple_extent_ndims(space))));
    if (shape.empty()) return;
    access.check(H5Sget_simple_extent_dims(space, shape.data(), nullptr));
    const std::size_t axis = axis_of(shape);
    const hsize_t row = bytes_of_a_row(shape, axis, H5Tget_size(type));
    if (row == 0) return;
    constexpr hsize_t kPiece = hsize_t{1} << 20;  // bytes
    const hsize_t rows = shape[axis], at_once = piece_of(shape, H5Tget_size(type), kPiece)[axis];
    std::vector<hsize_t> start(shape.size(), 0), count = shape;
    for (hsize_t first = 0; first < rows; first += at_once) {
        start[axis] = first;
        count[axis] = std::min(at_once, rows - first);
        const Handle piece(access, H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose);
        access.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
        access.check(H5Dwrite(set, type, piece, space, H5P_DEFAULT, static_cast<const char*>(values) + first * row));
    }
}

Numbers read_numbers(const Access& access, hid_t group, const std::string& name) {
    const Handle set(access, H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Handle space(access, H5Dget_space(set), H5Sclose);
    Numbers numbers;
    numbers.shape.resize(static_cast<std::size_t>(access.check(H5Sget_simple_extent_ndims(space))));
    access.check(H5Sget_simple_extent_dims(space, numbers.shape.data(), nullptr));
    numbers.values.resize(static_cast<std::size_t>(access.check(H5Sget_simple_extent_npoints(space))));
    if (!numbers.values.empty())
        access.check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.values.data()));
    return numbers;
}

void reserve(const Access& access, const std::filesystem::path& path, off_t bytes) {
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) throw access.failure(std::strerror(errno));
    struct stat before {};
    int problem = ::fstat(file, &before) == 0 ? 0 : errno;
    if (problem == 0) problem = ::posix_fallocate(file, before.st_size, bytes);
    if (problem != 0 && ::ftruncate(file, before.st_size) != 0) problem = errno;
    ::close(file);
    if (problem != 0) throw access.failure(std::strerror(problem));
}

}  // namespace frana::hdf5
