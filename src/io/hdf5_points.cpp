#include "io/hdf5_points.h"

#include <cstdint>
#include <numeric>

#include "base/atomic_file.h"
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
    access.check(H5Dwrite(set, held, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
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

}  // namespace

void write_points_hdf5(const std::filesystem::path& file, const PointTable& table) {
    require_finite(table);
    AtomicFile beside(file);
    const hdf5::QuietErrors quiet;
    const Access access(file);
    Handle(access, H5Fcreate(beside.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose).close();
    hdf5::reserve(access, beside.path(), space_for(table));
    write_all(access, beside.path(), table);
    beside.commit();
}

}  // namespace frana
