// Folders of finished and running runs, read back; rasters in and out.
#include "apps/frana_compare.h"
#include "base/error.h"
#include "bindings.h"
#include "io/gdal_reader.h"
#include "io/gdal_writer.h"
#include "run/folder/products.h"
#include "scene/case_file.h"
#include "vtk_io/reader.h"

namespace frana {

py::array array_of(std::vector<double>&& numbers, std::vector<py::ssize_t> shape) {
    auto* const kept = new std::vector<double>(std::move(numbers));
    const py::capsule owner(kept, [](void* held) { delete static_cast<std::vector<double>*>(held); });
    return py::array_t<double>(std::move(shape), kept->data(), owner);
}

py::tuple north_up(const Raster& raster) {
    const GridGeometry& g = raster.geometry;
    std::vector<double> rows;
    rows.reserve(raster.values.size());
    for (Index j = g.ny - 1; j >= 0; --j)
        rows.insert(rows.end(), raster.values.begin() + j * g.nx, raster.values.begin() + (j + 1) * g.nx);
    const auto extent = g.pixel_extent();
    return py::make_tuple(array_of(std::move(rows), {g.ny, g.nx}), extent[0], extent[3], g.cell, raster.crs_wkt);
}

namespace {

py::dict arrays_of(std::map<std::string, std::vector<double>>& arrays, const std::map<std::string, int>& components,
                   const std::map<std::string, std::string>& units, const std::vector<py::ssize_t>& shape) {
    py::dict all;
    for (auto& [name, numbers] : arrays) {
        std::vector<py::ssize_t> of = shape;
        const auto several = components.find(name);
        if (several != components.end() && several->second > 1) of.push_back(several->second);
        const auto unit = units.find(name);
        all[py::str(name)] =
            py::make_tuple(array_of(std::move(numbers), of), unit == units.end() ? std::string() : unit->second);
    }
    return all;
}

py::tuple grid_frame(const std::string& dir, Index number) {
    LoadedFrame frame = aside([&] { return read_frame(dir, number); });
    const GridGeometry& g = frame.grid;
    return py::make_tuple(frame.time, py::make_tuple(g.nx, g.ny, g.x0, g.y0, g.cell),
                          arrays_of(frame.nodes, frame.components, frame.units, {g.ny, g.nx}));
}

py::tuple particle_frame(const std::string& dir, Index number) {
    LoadedParticles frame = aside([&] { return read_particles(dir, number); });
    return py::make_tuple(frame.time, arrays_of(frame.arrays, frame.components, frame.units, {frame.count}));
}

/// Of a run's rasters or, before there are some, of its terrain. A terrain that has gone tells nothing.
std::string crs_of_folder(const std::filesystem::path& dir) {
    try {
        const std::filesystem::path written = dir / "rasters" / "peak_depth.tif", keys = dir / "resolved.toml";
        return crs_of_raster(std::filesystem::exists(written) ? written : CaseFile::read(keys).path("terrain.dem"));
    } catch (const UserError&) {
        return {};
    }
}

std::string crs_in(const std::string& dir) {
    return aside([&] { return crs_of_folder(dir); });
}

py::list rasters_in(const std::string& dir) {
    const std::vector<ProductRaster> rasters = aside([&] { return read_rasters(dir); });
    py::list all;
    for (const ProductRaster& product : rasters)
        all.append(
            py::make_tuple(product.name, product.unit, product.description, north_up(as_in_file(product, rasters))));
    return all;
}

std::string compared(const std::string& dir, const std::string& survey, const std::string& deposit,
                     const std::string& path, const std::string& bed_change, double bed_change_noise) {
    CompareOptions options;
    options.run_dir = dir, options.survey = survey, options.deposit = deposit, options.path = path;
    options.bed_change = bed_change, options.bed_change_noise = bed_change_noise;
    return aside([&] { return comparison_json(read_run_and_survey(options).comparison); });
}

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

void save_raster(const std::string& file, const Numbers& array, double west, double north, double cell,
                 const std::string& crs, const std::string& unit, const std::string& description) {
    if (array.ndim() != 2 || array.size() == 0)
        throw UserError(file + ": found an array of " + std::to_string(array.ndim()) +
                        " dimensions; expected (rows, columns) of a raster; give one band");
    Raster raster;
    const Index rows = array.shape(0), columns = array.shape(1);
    raster.geometry = {columns, rows, west + 0.5 * cell, north - (static_cast<double>(rows) - 0.5) * cell, cell};
    raster.crs_wkt = crs;
    for (Index j = rows - 1; j >= 0; --j)
        raster.values.insert(raster.values.end(), array.data(j, 0), array.data(j, 0) + columns);
    aside([&] { write_geotiff(file, raster, unit, description); });
}

}  // namespace

void bind_folder(py::module_& module) {
    module.def("frame_times", [](const std::string& dir) { return aside([&] { return frame_times(dir); }); });
    module.def("particle_times", [](const std::string& dir) { return aside([&] { return particle_times(dir); }); });
    module.def("grid_frame", &grid_frame);
    module.def("particle_frame", &particle_frame);
    module.def("crs_in", &crs_in);
    module.def("rasters_in", &rasters_in);
    module.def("compared", &compared);
    module.def("save_raster", &save_raster);
}

}  // namespace frana
