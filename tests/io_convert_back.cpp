// 3D points back onto a run's grid: the rasters, read by GDAL, and a case that goes on from them.
#include <gdal_priv.h>

#include <algorithm>
#include <memory>

#include "convert_run.h"
#include "io/hdf5_points.h"

using Catch::Contains;
using namespace convert_run;

namespace {

/// Pixels of a raster, and their area.
struct Pixels {
    Numbers values;
    double area = 0.0;
};

Pixels pixels_of(const fs::path& file) {
    GDALAllRegister();
    const std::unique_ptr<GDALDataset> raster(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER));
    REQUIRE(raster);
    const int nx = raster->GetRasterXSize(), ny = raster->GetRasterYSize();
    Pixels pixels;
    pixels.values.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny));
    REQUIRE(raster->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, nx, ny, pixels.values.data(), nx, ny, GDT_Float64, 0, 0,
                                               nullptr) == CE_None);
    double transform[6];
    REQUIRE(raster->GetGeoTransform(transform) == CE_None);
    pixels.area = std::abs(transform[1] * transform[5]);
    return pixels;
}

/// Three points as another program might leave them.
void write_foreign(const fs::path& file, const Numbers& mass, bool velocity = true) {
    const Numbers position{22, 32, 99, 23, 33, 101, 500, 500, 90}, speed{1, 0, -5, 3, 2, 4, 9, 9, 9}, volume{2, 2, 2};
    frana::PointTable table;
    table.count = 3;
    table.columns = {{"position", "m", {"x", "y", "z"}, position.data()},
                     {"mass", "kg", {"mass"}, mass.data()},
                     {"volume", "m3", {"volume"}, volume.data()}};
    if (velocity) table.columns.push_back({"velocity", "m/s", {"vx", "vy", "vz"}, speed.data()});
    frana::write_points_hdf5(file, table);
}

}  // namespace

TEST_CASE("Points of a run come back as rasters of its volume and momentum, and a case goes on from them",
          "[convert]") {
    const fs::path points = convert("there.h5");
    const Outcome back = finished_run().frana("convert out --points there.h5 --back back");
    INFO(back.err);
    REQUIRE(back.code == 0);
    CHECK_THAT(back.out, Contains("mass [kg]") && Contains("back/velocity_y.tif") && !Contains("left out"));
    const Pixels depth = pixels_of(finished_run().folder() / "back/depth.tif");
    const Pixels u = pixels_of(finished_run().folder() / "back/velocity_x.tif");
    const Numbers mass = hdf5_numbers(points, "mass"), velocity = hdf5_numbers(points, "velocity");
    double of_points = 0.0, moved = 0.0, of_pixels = 0.0;
    for (std::size_t k = 0; k < mass.size(); ++k) {
        of_points += mass[k] * velocity[3 * k];
        moved += mass[k] * std::abs(velocity[3 * k]);
    }
    for (std::size_t k = 0; k < u.values.size(); ++k) of_pixels += 1300.0 * depth.area * depth.values[k] * u.values[k];
    CHECK(moved > 0.0);
    // GeoTIFFs hold float32: 6e-8 each.
    CHECK(depth.area * sum(depth.values) == Approx(sum(hdf5_numbers(points, "volume"))).epsilon(1e-7));
    CHECK(std::abs(of_pixels - of_points) < 2e-7 * moved);

    frana::write_text(
        finished_run().folder() / "on.toml",
        "[terrain]\ndem = \"dem.asc\"\n[[release]]\nmask = \"back/depth.tif\"\ndepth = \"back/depth.tif\"\n"
        "velocity = [\"back/velocity_x.tif\", \"back/velocity_y.tif\"]\n[material]\ndensity = 1300\n"
        "[time]\nend = 0.5\n");
    const Outcome on = finished_run().frana("check on.toml");
    INFO(on.err);
    CHECK(on.code == 0);
    CHECK_THAT(on.out, Contains("volume 1800 m3 from raster or polygon"));
}

TEST_CASE("Points of another program are binned; what stands beyond the terrain is told apart", "[convert]") {
    write_foreign(finished_run().folder() / "foreign.h5", {100, 300, 50});
    const Outcome back = finished_run().frana("convert out --points foreign.h5 --back foreign");
    CHECK(back.code == 0);
    // Two points in one pixel: (100 * 1 + 300 * 3) / 400 = 2.5 m/s and 1.5 m/s, 4 m3 on 25 m2. Given up: half of
    // 100 * 26 + 300 * 29, less half of 400 * 8.5.
    CHECK_THAT(back.out, Contains("2 points on 1 pixels; 3950 J of motion") &&
                             Contains("1 points, 50 kg, stand beyond the terrain and are left out"));
    const Pixels depth = pixels_of(finished_run().folder() / "foreign/depth.tif");
    const Pixels v = pixels_of(finished_run().folder() / "foreign/velocity_y.tif");
    CHECK(*std::max_element(depth.values.begin(), depth.values.end()) == Approx(0.16).epsilon(1e-7));
    CHECK(sum(depth.values) == Approx(0.16).epsilon(1e-7));
    CHECK(sum(v.values) == Approx(1.5).epsilon(1e-7));
    CHECK(sum(pixels_of(finished_run().folder() / "foreign/velocity_x.tif").values) == Approx(2.5).epsilon(1e-7));
}

TEST_CASE("Points as a table are not read back, and the sentence says which are", "[convert]") {
    convert("table.csv");
    const Outcome back = finished_run().frana("convert out --points table.csv --back none");
    CHECK(back.code == 2);
    CHECK_THAT(back.err, Contains("table.csv: found a file that is not HDF5") && Contains("ends in .h5") &&
                             !Contains("signature"));
}

TEST_CASE("Points that are none, and half a command line, are refused with a sentence", "[convert]") {
    const fs::path folder = finished_run().folder();
    CHECK_THAT(refused("out --points absent.h5 --back none").err, Contains("absent.h5: cannot be read: "));
    frana::write_text(folder / "text.h5", "no points");
    CHECK_THAT(refused("out --points text.h5 --back none").err, Contains("text.h5: found a file that is not HDF5"));
    write_foreign(folder / "still.h5", {1, 1, 1}, false);
    CHECK(refused("out --points still.h5 --back none").err ==
          "still.h5: has no velocity of 3 per point; expected position (N, 3), velocity (N, 3), mass (N) and volume "
          "(N), as "
          "frana convert writes them; write these\n");
    write_foreign(folder / "light.h5", {1, 1, -2});
    CHECK(refused("out --points light.h5 --back none").err ==
          "light.h5: point 2 has mass -2 and volume 2; expected finite numbers for each of its points, mass and volume "
          "above "
          "0; write them so\n");
    CHECK_THAT(refused("still --points light.h5 --back none").err,
               Contains("still: holds neither terrain.vti nor run.h5"));
    CHECK(refused("out --time 1 --out a.h5").err ==
          "command line: found no --spacing; expected --time, --spacing and --out, or --points and --back for the way "
          "from "
          "3D; see `frana convert --help`\n");
    CHECK_THAT(refused("out --back none").err, Contains("found no --points; expected"));
    CHECK_THAT(refused("out --time 1 --points light.h5 --back none").err, Contains("found both ways at once"));
    CHECK_FALSE(fs::exists(folder / "none"));
}
