#include <hdf5.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "io/hdf5_seeds.h"
#include "particles/export.h"
#include "release_maker.h"
#include "vtk_io/seeds_vtp.h"

using namespace frana;
using namespace release_maker;

namespace {

const std::string kCrs = "PROJCRS[\"WGS 84 / UTM zone 32N\"]";

Raster sloping_bed() {
    Raster bed = flat_bed(61, 51, 2.0, 512345.6, 5123456.7);
    for (Index j = 0; j < 51; ++j)
        for (Index i = 0; i < 61; ++i) bed.at(i, j) = 1000.0 + 0.3 * static_cast<double>(i);
    bed.crs_wkt = kCrs;
    return bed;
}

Made some_particles(const Raster& bed) {
    const Vec2 centre(bed.geometry.x0 + 60.0, bed.geometry.y0 + 50.0);
    Release release = release_of_ring(star(centre, 40.0, 20.0, 5, 0.1), 1.7);
    release.velocity = Vec2(1.5, -0.25);
    return make({release}, bed);
}

std::vector<double> dataset(hid_t file, const char* name, std::vector<hsize_t> shape, const std::string& unit) {
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    REQUIRE(set >= 0);
    const hid_t space = H5Dget_space(set);
    std::vector<hsize_t> found(H5Sget_simple_extent_ndims(space));
    H5Sget_simple_extent_dims(space, found.data(), nullptr);
    CHECK(found == shape);
    std::vector<double> values(H5Sget_simple_extent_npoints(space));
    REQUIRE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
    const hid_t attribute = H5Aopen(set, "unit", H5P_DEFAULT);
    REQUIRE(attribute >= 0);
    const hid_t type = H5Aget_type(attribute);
    std::string text(H5Tget_size(type), ' ');
    H5Aread(attribute, type, text.data());
    CHECK(std::string(text.c_str()) == unit);
    H5Tclose(type);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Dclose(set);
    return values;
}

std::string text_attribute(hid_t object, const char* name) {
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    std::string text(H5Tget_size(type), ' ');
    H5Aread(attribute, type, text.data());
    H5Tclose(type);
    H5Aclose(attribute);
    return text.c_str();
}

}  // namespace

TEST_CASE("HDF5 gives back every particle bit by bit, with units", "[particles]") {
    const FreshFolder folder;
    const Raster bed = sloping_bed();
    const Made made = some_particles(bed);
    const SeedsExport data = make_seeds_export(made.seeds, 1300.0, bed);
    write_seeds_hdf5(folder.path() / "seeds.h5", data);

    const hid_t file = H5Fopen((folder.path() / "seeds.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    REQUIRE(file >= 0);
    const auto n = static_cast<hsize_t>(made.seeds.count());
    const auto position = dataset(file, "position", {n, 2}, "m");
    const auto velocity = dataset(file, "velocity", {n, 2}, "m/s");
    const auto mass = dataset(file, "mass", {n}, "kg");
    const auto id = dataset(file, "id", {n}, "1");
    CHECK(dataset(file, "volume", {n}, "m3") == made.seeds.volume);
    CHECK(dataset(file, "depth", {n}, "m") == made.seeds.depth);
    CHECK(dataset(file, "size", {n}, "m") == made.seeds.size);
    CHECK(dataset(file, "elevation", {n}, "m") == data.elevation);
    for (std::size_t p = 0; p < n; ++p) {
        CHECK(position[2 * p] == made.seeds.x[p]);
        CHECK(position[2 * p + 1] == made.seeds.y[p]);
        CHECK(velocity[2 * p] == 1.5);
        CHECK(velocity[2 * p + 1] == -0.25);
        CHECK(mass[p] == 1300.0 * made.seeds.volume[p]);
        CHECK(id[p] == static_cast<double>(p));
    }
    CHECK(text_attribute(file, "crs_wkt") == kCrs);
    double density = 0.0;
    const hid_t attribute = H5Aopen(file, "density", H5P_DEFAULT);
    H5Aread(attribute, H5T_NATIVE_DOUBLE, &density);
    CHECK(density == 1300.0);
    H5Aclose(attribute);
    H5Fclose(file);
}

TEST_CASE("VTP holds a vertex cell per particle on the free surface, with units", "[particles]") {
    const FreshFolder folder;
    const Raster bed = sloping_bed();
    const Made made = some_particles(bed);
    const SeedsExport data = make_seeds_export(made.seeds, 1300.0, bed);
    write_seeds_vtp(folder.path() / "seeds.vtp", data);

    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName((folder.path() / "seeds.vtp").c_str());
    reader->Update();
    vtkPolyData* cloud = reader->GetOutput();
    const vtkIdType n = made.seeds.count();
    REQUIRE(cloud->GetNumberOfPoints() == n);
    REQUIRE(cloud->GetNumberOfVerts() == n);
    vtkPointData* arrays = cloud->GetPointData();
    vtkDataArray* velocity = arrays->GetArray("velocity");
    REQUIRE(velocity);
    REQUIRE(velocity->GetNumberOfComponents() == 3);
    for (vtkIdType p = 0; p < n; ++p) {
        double at[3];
        cloud->GetPoint(p, at);
        CHECK(at[0] == made.seeds.x[p]);
        CHECK(at[1] == made.seeds.y[p]);
        CHECK(at[2] == data.elevation[p] + made.seeds.depth[p]);
        CHECK(velocity->GetTuple3(p)[0] == 1.5);
        CHECK(velocity->GetTuple3(p)[1] == -0.25);
        CHECK(velocity->GetTuple3(p)[2] == 0.0);
        CHECK(arrays->GetArray("depth")->GetTuple1(p) == made.seeds.depth[p]);
        CHECK(arrays->GetArray("volume")->GetTuple1(p) == made.seeds.volume[p]);
        CHECK(arrays->GetArray("mass")->GetTuple1(p) == 1300.0 * made.seeds.volume[p]);
        CHECK(arrays->GetArray("id")->GetTuple1(p) == static_cast<double>(p));
        CHECK(cloud->GetVerts()->GetCellSize(p) == 1);
    }
    const auto unit = [&](const char* name) {
        auto* text = vtkStringArray::SafeDownCast(cloud->GetFieldData()->GetAbstractArray(name));
        REQUIRE(text);
        return text->GetValue(0);
    };
    CHECK(unit("depth_unit") == "m");
    CHECK(unit("velocity_unit") == "m/s");
    CHECK(unit("mass_unit") == "kg");
    CHECK(unit("volume_unit") == "m3");
    CHECK(unit("id_unit") == "1");
    CHECK(unit("crs_wkt") == kCrs);
    const std::string head = text_of(folder.path() / "seeds.vtp").substr(0, 400);
    CHECK(head.find("vtkLZ4DataCompressor") != std::string::npos);
}

TEST_CASE("JSON is valid and gives back every particle bit by bit", "[particles]") {
    const FreshFolder folder;
    const Raster bed = sloping_bed();
    const Made made = some_particles(bed);
    const SeedsExport data = make_seeds_export(made.seeds, 1300.0, bed);
    write_seeds_json(folder.path() / "seeds.json", data);
    const auto json = nlohmann::json::parse(text_of(folder.path() / "seeds.json"));
    CHECK(json["count"] == made.seeds.count());
    CHECK(json["crs_wkt"] == kCrs);
    CHECK(json["units"]["mass"] == "kg");
    CHECK(json["volume"].get<std::vector<double>>() == made.seeds.volume);
    CHECK(json["elevation"].get<std::vector<double>>() == data.elevation);
    for (std::size_t p = 0; p < made.seeds.x.size(); ++p) {
        CHECK(json["position"][p][0].get<double>() == made.seeds.x[p]);
        CHECK(json["position"][p][1].get<double>() == made.seeds.y[p]);
        CHECK(json["velocity"][p] == std::vector<double>{1.5, -0.25});
        CHECK(json["mass"][p].get<double>() == 1300.0 * made.seeds.volume[p]);
        CHECK(json["id"][p] == p);
    }
}

TEST_CASE("Particles cannot be written into a folder that is not there, and the file is named", "[particles]") {
    const FreshFolder folder;
    const Raster bed = sloping_bed();
    const Made made = some_particles(bed);
    const SeedsExport data = make_seeds_export(made.seeds, 1300.0, bed);
    const auto nowhere = folder.path() / "absent";
    CHECK_THROWS_WITH(write_seeds_hdf5(nowhere / "a.h5", data), Catch::Contains("absent/a.h5: cannot be written"));
    CHECK_THROWS_WITH(write_seeds_vtp(nowhere / "a.vtp", data), Catch::Contains("absent/a.vtp: cannot be written"));
    CHECK_THROWS_WITH(write_seeds_json(nowhere / "a.json", data), Catch::Contains("absent/a.json: cannot be written"));
    CHECK_THROWS_WITH(write_seeds_csv(nowhere / "a.csv", data), Catch::Contains("absent/a.csv: cannot be written"));
}
