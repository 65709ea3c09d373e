#include "io/hdf5_points.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/atomic_file.h"
#include "base/error.h"
#include "io/hdf5_support.h"

namespace frana {

using hdf5::Access;
using hdf5::Handle;
using hdf5::put_text;

namespace {

void put_value(const Access& access, hid_t object, const char* name, hid_t stored, hid_t held, const void* value) {
    const Handle space(access, H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(access, H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    access.check(H5Awrite(attribute, held, value));
}

void put_dataset(const Access& access, hid_t file, const std::string& name, const std::string& unit, std::size_t rows,
                 int components, hid_t stored, hid_t held, const void* values) {
    const hsize_t shape[2] = {rows, static_cast<hsize_t>(components)};
    const Handle space(access, H5Screate_simple(components > 1 ? 2 : 1, shape, nullptr), H5Sclose);
    const Handle set(access, H5Dcreate2(file, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    write_whole(access, set, held, values);
    put_text(access, set, "unit", unit);
}

void write_all(const Access& access, const std::filesystem::path& path, const PointTable& table) {
    Handle file(access, H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const auto rows = static_cast<std::int64_t>(table.count);
    put_text(access, file, "format", table.format);
    put_text(access, file, "crs_wkt", table.crs_wkt);
    put_value(access, file, "count", H5T_STD_I64LE, H5T_NATIVE_INT64, &rows);
    for (const auto& [name, text] : table.texts) put_text(access, file, name.c_str(), text);
    for (const PointConstant& constant : table.constants) {
        put_value(access, file, constant.name.c_str(), H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &constant.value);
        put_text(access, file, (constant.name + "_unit").c_str(), constant.unit);
    }
    for (const PointColumn& column : table.columns)
        put_dataset(access, file, column.name, column.unit, table.count, static_cast<int>(column.components()),
                    H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, column.values);
    std::vector<std::int64_t> ids(table.count);
    std::iota(ids.begin(), ids.end(), std::int64_t{0});
    put_dataset(access, file, "id", "1", table.count, 1, H5T_STD_I64LE, H5T_NATIVE_INT64, ids.data());
    file.close();
}

/// Bytes that the file needs at most, its metadata included.
off_t space_for(const PointTable& table) {
    std::size_t numbers = table.count;
    for (const PointColumn& column : table.columns) numbers += table.count * column.components();
    return static_cast<off_t>(8 * numbers + (std::size_t{1} << 20));
}

/// A column of so many components, whatever its length.
std::vector<double> read_column(const Access& access, hid_t file, const char* name, std::size_t components) {
    const bool there = H5Lexists(file, name, H5P_DEFAULT) > 0;
    hdf5::Numbers numbers;
    if (there) numbers = hdf5::read_numbers(access, file, name);
    const bool fits =
        components == 1 ? numbers.shape.size() == 1 : numbers.shape.size() == 2 && numbers.shape[1] == components;
    if (!there || !fits)
        throw UserError(
            fmt::format("{}: has no {} of {} per point; expected position (N, 3), velocity (N, 3), mass (N) and "
                        "volume (N), as frana convert writes them; write these",
                        access.file().string(), name, components));
    return std::move(numbers.values);
}

void require_valid(const std::filesystem::path& file, const SolidPoints& points) {
    const std::size_t n = points.mass.size();
    const auto wrong = [&](const std::string& what) {
        return UserError(
            fmt::format("{}: {}; expected finite numbers for each of its points, mass and volume above 0; "
                        "write them so",
                        file.string(), what));
    };
    if (n == 0) throw wrong("holds no points");
    if (points.position.size() != 3 * n || points.velocity.size() != 3 * n || points.volume.size() != n ||
        points.pressure.size() != n)
        throw wrong("its arrays differ in length");
    for (std::size_t k = 0; k < n; ++k) {
        bool finite = std::isfinite(points.mass[k] + points.volume[k] + points.pressure[k]);
        for (std::size_t c = 3 * k; c < 3 * k + 3; ++c)
            finite = finite && std::isfinite(points.position[c]) && std::isfinite(points.velocity[c]);
        if (!finite || points.mass[k] <= 0.0 || points.volume[k] <= 0.0)
            throw wrong(fmt::format("point {} has mass {} and volume {}{}", k, points.mass[k], points.volume[k],
                                    finite ? "" : ", or another number that is not finite"));
    }
}

}  // namespace

SolidPoints read_points_hdf5(const std::filesystem::path& path) {
    const hdf5::QuietErrors quiet;
    const Access access(path, Access::Mode::read);
    if (std::filesystem::is_regular_file(path) && H5Fis_hdf5(path.c_str()) == 0)
        throw UserError(
            fmt::format("{}: found a file that is not HDF5; expected points as `frana convert` writes them to a file "
                        "that ends in .h5; give one, since .csv and .vtp are not read back",
                        path.string()));
    const Handle file(access, H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    SolidPoints points;
    points.position = read_column(access, file, "position", 3);
    points.velocity = read_column(access, file, "velocity", 3);
    points.mass = read_column(access, file, "mass", 1);
    points.volume = read_column(access, file, "volume", 1);
    points.pressure.assign(points.mass.size(), 0.0);
    if (H5Lexists(file, "pressure", H5P_DEFAULT) > 0) points.pressure = read_column(access, file, "pressure", 1);
    require_valid(path, points);
    return points;
}

void write_points_hdf5(const std::filesystem::path& file, const PointTable& table) {
    require_finite(table);
    AtomicFile pending(file);
    const hdf5::QuietErrors quiet;
    const Access access(file);
    Handle(access, H5Fcreate(pending.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose).close();
    hdf5::reserve(access, pending.path(), space_for(table));
    write_all(access, pending.path(), table);
    pending.commit();
}

}  // namespace frana
