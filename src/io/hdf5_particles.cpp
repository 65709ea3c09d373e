#include "io/hdf5_particles.h"

#include <fmt/core.h>

#include "base/error.h"
#include "io/hdf5_frame.h"
#include "io/hdf5_support.h"

namespace frana {

using hdf5::Access;
using hdf5::Handle;
using hdf5::Numbers;
using hdf5::read_numbers;

namespace {

/// The run may be going on: without locks neither stops the other.
Handle open_to_read(const Access& access) {
    const Handle how(access, H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    access.check(H5Pset_file_locking(how, false, true));
    return {access, H5Fopen(access.file().c_str(), H5F_ACC_RDONLY, how), H5Fclose};
}

/// Numbers of an attribute.
std::vector<double> numbers_of(const Access& access, hid_t object, const char* name) {
    const Handle attribute(access, H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Handle space(access, H5Aget_space(attribute), H5Sclose);
    std::vector<double> numbers(static_cast<std::size_t>(access.check(H5Sget_simple_extent_npoints(space))));
    access.check(H5Aread(attribute, H5T_NATIVE_DOUBLE, numbers.data()));
    return numbers;
}

std::vector<std::string> names_in(const Access& access, hid_t group) {
    H5G_info_t info;
    access.check(H5Gget_info(group, &info));
    std::vector<std::string> names;
    for (hsize_t k = 0; k < info.nlinks; ++k) {
        char name[256];
        access.check(H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT));
        names.push_back(name);
    }
    return names;
}

Raster read_bed(const Access& access, hid_t frame) {
    const Handle grid(access, H5Gopen2(frame, "grid", H5P_DEFAULT), H5Gclose);
    const std::vector<double> origin = numbers_of(access, grid, "origin"), cell = numbers_of(access, grid, "cell");
    Numbers elevation = read_numbers(access, grid, "elevation");
    if (elevation.shape.size() != 3 || origin.size() < 2 || cell.empty())
        throw access.failure("its grid is not that of a run");
    Raster bed;
    bed.geometry = {static_cast<Index>(elevation.shape[2]), static_cast<Index>(elevation.shape[1]), origin[0],
                    origin[1], cell[0]};
    bed.values = std::move(elevation.values);
    bed.source = access.file().string();
    if (H5Lexists(grid, "outside", H5P_DEFAULT) > 0) {
        const std::vector<double> outside = read_numbers(access, grid, "outside").values;
        for (std::size_t k = 0; k < bed.values.size() && k < outside.size(); ++k)
            if (outside[k] != 0.0) bed.values[k] = Raster::nodata;
    }
    return bed;
}

}  // namespace

std::vector<double> hdf5_frame_times(const std::filesystem::path& path) {
    const hdf5::QuietErrors quiet;
    const Access access(path, Access::Mode::read);
    const Handle file = open_to_read(access);
    std::vector<double> times;
    for (const std::string& name : names_in(access, file)) {
        if (name.rfind("frame_", 0) != 0) continue;
        const Handle frame(access, H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose);
        times.push_back(numbers_of(access, frame, "time").at(0));
    }
    return times;
}

StoredParticles read_hdf5_particles(const std::filesystem::path& path, Index number) {
    const hdf5::QuietErrors quiet;
    const Access access(path, Access::Mode::read);
    const Handle file = open_to_read(access);
    const Handle frame(access, H5Gopen2(file, frame_group(number).c_str(), H5P_DEFAULT), H5Gclose);
    const Handle group(access, H5Gopen2(frame, "particles", H5P_DEFAULT), H5Gclose);
    StoredParticles particles;
    particles.time = numbers_of(access, frame, "time").at(0);
    for (const std::string& name : names_in(access, group)) {
        Numbers numbers = read_numbers(access, group, name);
        if (numbers.shape.empty() || numbers.shape.size() > 2) throw access.failure(name + " is not an array of a run");
        particles.count = static_cast<Index>(numbers.shape[0]);
        particles.components[name] = numbers.shape.size() == 2 ? static_cast<int>(numbers.shape[1]) : 1;
        particles.arrays[name] = std::move(numbers.values);
    }
    particles.bed = read_bed(access, frame);
    return particles;
}

}  // namespace frana
