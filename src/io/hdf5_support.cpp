#include "io/hdf5_support.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

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
    const Handle space(
        access, numbers.size() == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr), H5Sclose);
    const Handle attribute(access, H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    access.check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, numbers.data()));
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
