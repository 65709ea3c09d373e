// Rain and infiltration from files of a GIS, on the nodes of the terrain.
#include <cmath>
#include <fstream>

#include "catch.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io_gdal_make.h"
#include "scene/build_scene.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

constexpr double kWest = 500000.0, kNorth = 6000200.0;  // of 240 x 200 m

/// A slope of 10 m pixels with a release, and rain in pixels of another size.
class Folder {
public:
    Folder() {
        RasterSpec dem;
        dem.columns = 24, dem.rows = 20, dem.transform = {kWest, 10.0, 0.0, kNorth, 0.0, -10.0};
        dem.value = [](int column, int row) { return 300.0 - 3.0 * column + 0.5 * row; };
        make_raster(at("dem.tif"), dem);
        dem.value = [](int column, int row) { return column > 8 && column < 14 && row > 6 && row < 12 ? 1.0 : 0.0; };
        make_raster(at("mask.tif"), dem);
    }
    fs::path at(const std::string& name) const { return folder_.path() / name; }
    void rain(double pixel, const std::function<double(double x, double y)>& rate, double from = 0.0,
              const std::string& crs = "EPSG:32632") const {
        RasterSpec spec;
        spec.columns = static_cast<int>(std::ceil((240.0 - from) / pixel)),
        spec.rows = static_cast<int>(std::ceil(200.0 / pixel));
        spec.transform = {kWest + from, pixel, 0.0, kNorth, 0.0, -pixel};
        spec.crs = crs, spec.nodata = -9999.0;
        spec.value = [=](int column, int row) {
            return rate(kWest + from + (column + 0.5) * pixel, kNorth - (row + 0.5) * pixel);
        };
        make_raster(at("rain.tif"), spec);
    }
    Scene scene(const std::string& cell = "") const {
        std::ofstream(at("case.toml"))
            << "[terrain]\ndem = \"dem.tif\"\n"
            << cell
            << "[[release]]\nmask = \"mask.tif\"\ndepth = 2\n[time]\nend = 5\n[material]\ndensity = 2650\n"
               "[material.structure]\nlaw = \"drucker_prager\"\ncohesion = 0\nfraction = 0\nfriction_angle_deg = 30\n"
               "young_modulus = 1e6\n[water]\nmodel = \"free\"\nrain = \"rain.tif\"\n";
        return build_scene(CaseFile::read(at("case.toml")), GdalReader());
    }
    std::string refused() const {
        return user_error([&] { scene(); });
    }

private:
    FreshFolder folder_;
};

double volume(const Raster& rate) {
    double sum = 0.0;
    for (const double one : rate.values) sum += one;
    return sum * rate.geometry.cell * rate.geometry.cell;
}

double cloud(double x, double) { return 1e-5 * (1.0 + std::sin((x - kWest) / 40.0)); }

}  // namespace

TEST_CASE("Rain comes from a raster of any pixel, averaged or interpolated onto the terrain", "[gdal][water]") {
    const Folder folder;
    folder.rain(5.0, cloud);
    const Scene fine = folder.scene();
    CHECK(fine.water->rain.geometry == fine.bed.geometry);
    double sum = 0.0;
    for (int i = 0; i < 48; ++i)
        for (int j = 0; j < 40; ++j) sum += 25.0 * static_cast<float>(cloud(kWest + 2.5 + 5.0 * i, 0.0));
    CHECK(volume(fine.water->rain) == Approx(sum).epsilon(1e-12));
    CHECK(any_contains(fine.log, "rain.tif: 5 m pixels averaged to 10 m cells"));
    folder.rain(40.0,
                [](double x, double) { return x - kWest > 100.0 ? 1e-5 : 0.0; });  // a step: nothing below 0 beside it
    const Raster coarse = folder.scene().water->rain;
    const double single = static_cast<double>(1e-5f);  // the file's precision
    CHECK(*std::min_element(coarse.values.begin(), coarse.values.end()) == 0.0);
    CHECK(*std::max_element(coarse.values.begin(), coarse.values.end()) == Approx(single).epsilon(1e-12));
    CHECK(volume(coarse) == Approx(120.0 * 200.0 * single).epsilon(1e-12));
}

TEST_CASE("Rain that does not lie on the terrain, or is none, is refused in one sentence", "[gdal][water]") {
    const Folder folder;
    folder.rain(10.0, cloud, 60.0);
    CHECK(contains(folder.refused(),
                   "rain.tif: found 120 of 480 nodes of the terrain without a number, the first at x 500005, "
                   "y 6000005; expected a raster that covers all of the terrain"));
    folder.rain(10.0, [](double x, double y) { return x < kWest + 10.0 && y > kNorth - 10.0 ? -1e-6 : 1e-6; });
    CHECK(contains(folder.refused(),
                   "rain.tif: found 1 of 480 pixels such as -1e-06, the first at x 500005, y 6000195; expected rates"));
    folder.rain(5.0, [](double x, double y) { return x < kWest + 5.0 && y > kNorth - 5.0 ? -9999.0 : 1e-6; });
    CHECK(contains(folder.refused(), "found 1 of 1920 pixels without a number, the first at x 500002.5, y 6000197.5"));
    folder.rain(10.0, cloud, 500.0 - 1000.0, "EPSG:32633");
    CHECK(contains(folder.refused(), "expected a raster on the terrain in use"));
}
