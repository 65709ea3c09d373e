#include "io/hdf5_seeds.h"

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

void write_all(const Access& access, const std::filesystem::path& path, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    const std::size_t count = data.seeds.x.size();
    Handle file(access, H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const auto rows = static_cast<std::int64_t>(count);
    put_text(access, file, "format", "frana particles 1");
    put_text(access, file, "crs_wkt", data.crs_wkt);
    put_text(access, file, "density_unit", "kg/m3");
    put_value(access, file, "count", H5T_STD_I64LE, H5T_NATIVE_INT64, &rows);
    put_value(access, file, "density", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &data.density);
    for (const SeedsColumn& column : columns)
        put_dataset(access, file, column.name, column.unit, count, column.components, H5T_IEEE_F64LE,
                    H5T_NATIVE_DOUBLE, column.values.data());
    std::vector<std::int64_t> ids(count);
    std::iota(ids.begin(), ids.end(), std::int64_t{0});
    put_dataset(access, file, "id", "1", count, 1, H5T_STD_I64LE, H5T_NATIVE_INT64, ids.data());
    file.close();
}

}  // namespace

void write_seeds_hdf5(const std::filesystem::path& file, const SeedsExport& data) {
    AtomicFile beside(file);
    const hdf5::QuietErrors quiet;
    write_all(Access(file), beside.path(), data);
    beside.commit();
}

}  // namespace frana
