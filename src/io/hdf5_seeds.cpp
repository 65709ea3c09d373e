#include "io/hdf5_seeds.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <cstdint>
#include <numeric>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"

namespace frana {

namespace {

struct Hdf5Failure {};

/// Passes good results on; HDF5 reports failure by negative numbers.
template <class Result>
Result good(Result result) {
    if (result < 0) throw Hdf5Failure{};
    return result;
}

/// An HDF5 object and the function that closes it.
class Handle {
public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(good(id)), close_(close) {}
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }
    /// Closes now and tells: a full disk may show here first.
    void finish() { good(close_(std::exchange(id_, -1))); }

private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// HDF5 prints its errors unless told otherwise; here they become a UserError.
class SilentErrors {
public:
    SilentErrors() {
        H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~SilentErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
    SilentErrors(const SilentErrors&) = delete;
    SilentErrors& operator=(const SilentErrors&) = delete;

private:
    H5E_auto2_t print_ = nullptr;
    void* data_ = nullptr;
};

void put_text(hid_t object, const char* name, const std::string& text) {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    good(H5Tset_size(type, text.size() + 1));
    good(H5Tset_cset(type, H5T_CSET_UTF8));
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    good(H5Awrite(attribute, type, text.c_str()));
}

void put_value(hid_t object, const char* name, hid_t stored, hid_t held, const void* value) {
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle attribute(H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    good(H5Awrite(attribute, held, value));
}

void put_dataset(hid_t file, const std::string& name, const std::string& unit, std::size_t rows,
                 int components, hid_t stored, hid_t held, const void* values) {
    const hsize_t shape[2] = {rows, static_cast<hsize_t>(components)};
    const Handle space(H5Screate_simple(components > 1 ? 2 : 1, shape, nullptr), H5Sclose);
    const Handle set(H5Dcreate2(file, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    good(H5Dwrite(set, held, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    put_text(set, "unit", unit);
}

void write_all(const std::filesystem::path& path, const SeedsExport& data) {
    const std::vector<SeedsColumn> columns = seeds_columns(data);
    const std::size_t count = data.seeds.x.size();
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const auto rows = static_cast<std::int64_t>(count);
    put_text(file, "format", "frana particles 1");
    put_text(file, "crs_wkt", data.crs_wkt);
    put_text(file, "density_unit", "kg/m3");
    put_value(file, "count", H5T_STD_I64LE, H5T_NATIVE_INT64, &rows);
    put_value(file, "density", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &data.density);
    for (const SeedsColumn& column : columns)
        put_dataset(file, column.name, column.unit, count, column.components, H5T_IEEE_F64LE,
                    H5T_NATIVE_DOUBLE, column.values.data());
    std::vector<std::int64_t> ids(count);
    std::iota(ids.begin(), ids.end(), std::int64_t{0});
    put_dataset(file, "id", "1", count, 1, H5T_STD_I64LE, H5T_NATIVE_INT64, ids.data());
    file.finish();
}

}  // namespace

void write_seeds_hdf5(const std::filesystem::path& file, const SeedsExport& data) {
    AtomicFile beside(file);
    const SilentErrors silent;
    try {
        write_all(beside.path(), data);
    } catch (const Hdf5Failure&) {
        throw UserError(
            fmt::format("{}: cannot be written by HDF5; check that the folder exists, its "
                        "permissions and free space",
                        file.string()));
    }
    beside.commit();
}

}  // namespace frana
