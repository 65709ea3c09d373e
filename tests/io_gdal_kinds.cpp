// One elevation model, stored in every common way, must read the same.
#include <sys/stat.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io_gdal_make.h"

#include "catch.h"

using namespace frana;

namespace {

/// No two pixels alike, no symmetry: any flip or shift shows. Whole numbers, so that int16 holds them.
double stored(int column, int row) { return 100.0 + 7.0 * column - 13.0 * row + column * row; }

Raster dem_of(const std::filesystem::path& file, const DemRequest& request = {}) {
    std::vector<std::string> log;
    return GdalReader().read_dem(file, request, log);
}

/// Node (i, j) of a north-up file of `rows` rows must hold the pixel (i, rows - 1 - j).
void check_values(const Raster& dem, const RasterSpec& spec, bool south_up = false) {
    REQUIRE(dem.geometry.nx == spec.columns);
    REQUIRE(dem.geometry.ny == spec.rows);
    CHECK(dem.geometry.cell == 10.0);
    CHECK(dem.geometry.x0 == 500005.0);
    CHECK(dem.geometry.y0 == 6000005.0);
    for (int j = 0; j < spec.rows; ++j)
        for (int i = 0; i < spec.columns; ++i) {
            const int row = south_up ? j : spec.rows - 1 - j;
            if (dem.at(i, j) != stored(i, row)) FAIL("node " << i << " " << j << " holds " << dem.at(i, j));
        }
}

}  // namespace

TEST_CASE("GeoTIFFs plain, tiled, compressed, BigTIFF and cloud-optimised hold the same terrain", "[gdal]") {
    struct Kind {
        const char* driver;
        std::vector<std::string> options;
    };
    const Kind kinds[] = {{"GTiff", {}},
                          {"GTiff", {"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"}},
                          {"GTiff", {"COMPRESS=DEFLATE", "PREDICTOR=3"}},
                          {"GTiff", {"COMPRESS=LZW", "TILED=YES"}},
                          {"GTiff", {"BIGTIFF=YES"}},
                          {"COG", {"COMPRESS=DEFLATE"}}};
    const FreshFolder folder;
    for (const Kind& kind : kinds) {
        INFO(kind.driver << " " << (kind.options.empty() ? "" : kind.options.front()));
        RasterSpec spec;
        spec.columns = 40;
        spec.rows = 6;
        spec.driver = kind.driver;
        spec.options = kind.options;
        spec.value = stored;
        make_raster(folder.path() / "dem.tif", spec);
        const Raster dem = dem_of(folder.path() / "dem.tif");
        check_values(dem, spec);
        CHECK(contains(dem.crs_wkt, "PROJCRS[\"WGS 84 / UTM zone 32N\""));
    }
}

TEST_CASE("Elevations from int16 to float64 keep their values", "[gdal]") {
    const FreshFolder folder;
    for (const GDALDataType type : {GDT_Int16, GDT_UInt16, GDT_Int32, GDT_UInt32, GDT_Float32, GDT_Float64}) {
        INFO(GDALGetDataTypeName(type));
        RasterSpec spec;
        spec.type = type;
        spec.value = stored;
        make_raster(folder.path() / "dem.tif", spec);
        check_values(dem_of(folder.path() / "dem.tif"), spec);
    }
}

TEST_CASE("An ESRI ASCII grid reads like the GeoTIFF of the same terrain", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.driver = "AAIGrid";
    spec.value = stored;
    spec.nodata = -9999.0;
    make_raster(folder.path() / "dem.asc", spec);
    check_values(dem_of(folder.path() / "dem.asc"), spec);

    std::ofstream(folder.path() / "by_hand.asc") << "ncols 3\nnrows 2\nxllcenter 10\nyllcenter 20\ncellsize 4\n"
                                                    "NODATA_value -1\n1 2 3\n4 -1 6\n";
    const Raster dem = dem_of(folder.path() / "by_hand.asc");
    CHECK(dem.geometry == GridGeometry{3, 2, 10.0, 20.0, 4.0});
    CHECK(dem.at(0, 0) == 4.0);
    CHECK(dem.at(2, 1) == 3.0);
    CHECK(std::isnan(dem.at(1, 0)));
    CHECK(dem.crs_wkt.empty());
}

TEST_CASE("A south-up raster is not turned over", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.transform = {500000.0, 10.0, 0.0, 6000000.0, 0.0, 10.0};
    spec.value = stored;
    make_raster(folder.path() / "dem.tif", spec);
    check_values(dem_of(folder.path() / "dem.tif"), spec, true);
    DemRequest part;
    part.window = {{500020.0, 6000010.0, 500050.0, 6000030.0}};
    const Raster dem = dem_of(folder.path() / "dem.tif", part);
    CHECK(dem.geometry == GridGeometry{3, 2, 500025.0, 6000015.0, 10.0});
    CHECK(dem.at(0, 0) == stored(2, 1));
    CHECK(dem.at(2, 1) == stored(4, 2));
}

TEST_CASE("Scale and offset are applied to data and not to nodata", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.type = GDT_Int16;
    spec.scale = 0.1;
    spec.offset = 1000.0;
    spec.nodata = -32768.0;
    spec.value = [](int column, int row) { return column == 3 && row == 1 ? -32768.0 : stored(column, row); };
    make_raster(folder.path() / "dem.tif", spec);
    std::vector<std::string> log;
    const Raster dem = GdalReader().read_dem(folder.path() / "dem.tif", {}, log);
    CHECK(dem.at(2, 0) == Approx(1000.0 + 0.1 * stored(2, 5)).epsilon(1e-15));
    CHECK(std::isnan(dem.at(3, 4)));
    CHECK(any_contains(log, "0.1 + 1000"));
}

TEST_CASE("Nodata as value, NaN, mask band or alpha band becomes NaN, and only that", "[gdal]") {
    const FreshFolder folder;
    const auto gap = [](int column, int row) { return (column == 2 && row == 1) || (column == 7 && row == 5); };
    const auto with = [&](double nodata) {
        return [=](int column, int row) { return gap(column, row) ? nodata : stored(column, row); };
    };
    std::vector<RasterSpec> specs(6);
    specs[0].nodata = -9999.0, specs[0].value = with(-9999.0);
    specs[1].nodata = std::nan(""), specs[1].value = with(std::nan(""));
    specs[2].value = with(std::nan(""));  // not declared, but NaN says it by itself
    specs[3].value = with(0.0), specs[3].valid = [=](int c, int r) { return !gap(c, r); };
    specs[4] = specs[3], specs[4].alpha = true, specs[4].bands = 2;
    specs[5].nodata = -3.4028234663852886e38, specs[5].value = with(-3.4028234663852886e38);
    for (std::size_t k = 0; k < specs.size(); ++k) {
        INFO("kind " << k);
        make_raster(folder.path() / "dem.tif", specs[k]);
        const Raster dem = dem_of(folder.path() / "dem.tif");
        for (int j = 0; j < 6; ++j)
            for (int i = 0; i < 8; ++i) {
                INFO("node " << i << " " << j);
                if (gap(i, 5 - j))
                    CHECK(std::isnan(dem.at(i, j)));
                else
                    CHECK(dem.at(i, j) == stored(i, 5 - j));
            }
    }
}

TEST_CASE("A mask band and a nodata value in one file both count", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.nodata = -9999.0;
    spec.value = [](int column, int row) { return column == 0 ? -9999.0 : stored(column, row); };
    spec.valid = [](int, int row) { return row != 0; };
    make_raster(folder.path() / "dem.tif", spec);
    const Raster dem = dem_of(folder.path() / "dem.tif");
    CHECK(std::isnan(dem.at(0, 2)));
    CHECK(std::isnan(dem.at(4, 5)));
    CHECK(dem.at(4, 2) == stored(4, 3));
}

TEST_CASE("Undeclared nodata is refused with its pixel and a gdal_translate that cures it", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "dem.tif";
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {-9999.0, -32768.0, -3.4028234663852886e38, 1e20, infinity, -infinity}) {
        INFO(bad);
        std::filesystem::remove_all(folder.path() / "dem_nodata.tif");
        RasterSpec spec;
        spec.value = [=](int column, int row) { return column == 5 && row == 4 ? bad : stored(column, row); };
        make_raster(file, spec);
        const std::string message = user_error([&] { dem_of(file); });
        INFO(message);
        CHECK(contains(message, "pixel 5 4"));
        CHECK(contains(message, "500055 6000015"));
        run_gdal_line(cure_in(message));
        const Raster cured = dem_of(folder.path() / "dem_nodata.tif");
        CHECK(std::isnan(cured.at(5, 1)));
        CHECK(cured.at(4, 1) == stored(4, 4));
    }
}

TEST_CASE("The first of several bands is used, and the log says so", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.bands = 3;
    spec.value = stored;
    make_raster(folder.path() / "dem.tif", spec);
    std::vector<std::string> log;
    check_values(GdalReader().read_dem(folder.path() / "dem.tif", {}, log), spec);
    CHECK(any_contains(log, "3 bands, the first is used"));
}

TEST_CASE("A word in a raster of numbers in words is refused with its line, and never taken for 0", "[gdal]") {
    const FreshFolder folder;
    const auto file = [&](const char* name, const std::string& text) {
        std::ofstream(folder.path() / name) << text;
        return folder.path() / name;
    };
    const std::string arc = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 4\nNODATA_value -9999\n";
    const std::string grass = "north: 2\nsouth: 0\neast: 3\nwest: 0\nrows: 2\ncols: 3\nnull: *\n";
    const auto refused = [&](const std::filesystem::path& of) { return user_error([&] { dem_of(of); }); };
    CHECK(contains(refused(file("a.asc", arc + "1 2 3\n4 water 6\n")),
                   "a.asc:8: found \"water\"; expected numbers only; put a number there"));
    CHECK(contains(refused(file("b.asc", arc + "1 2 3\n4 1.2.3 6\n")), "b.asc:8: found \"1.2.3\""));
    CHECK(contains(refused(file("c.asc", arc + "1 2 3\n4 12O 6\n")), "c.asc:8: found \"12O\""));
    CHECK(contains(refused(file("d.asc", grass + "1 2 3\n4 * none\n")), "d.asc:9: found \"none\""));
    std::string points = "x,y,z\n";
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 20; ++column)
            points += fmt::format("{},{},{}\n", column, row, row == 15 && column == 3 ? "?" : "7");
    CHECK(contains(refused(file("e.xyz", points)), "e.xyz:305: found \"?\""));
    const Raster dem = dem_of(file("good.asc", arc + "+1 2,5 -3e-2\r\n-9999 nan .5\n"));
    CHECK(dem.at(0, 1) == 1.0);
    CHECK(dem.at(1, 1) == 2.5);
    CHECK(dem.at(2, 1) == Approx(-0.03));
    CHECK(std::isnan(dem.at(0, 0)));
    CHECK(std::isnan(dem.at(1, 0)));
    CHECK(dem.at(2, 0) == 0.5);
}

TEST_CASE("A file that is missing, no raster, cut off or without georeference is refused in one sentence", "[gdal]") {
    const FreshFolder folder;
    const auto refused = [&](const char* name) {
        std::string message;
        const std::string noise = heard_on_stderr([&] { message = user_error([&] { dem_of(folder.path() / name); }); });
        CHECK(noise == "");
        CHECK_FALSE(contains(message, "\n"));
        CHECK(contains(message, name));
        return message;
    };
    CHECK(contains(refused("nowhere.tif"), "no such file"));
    REQUIRE(::mkfifo((folder.path() / "pipe.tif").c_str(), 0666) == 0);
    CHECK(contains(refused("pipe.tif"), "a pipe or a device"));
    std::ofstream(folder.path() / "text.tif") << "this is a letter\n";
    CHECK(contains(refused("text.tif"), "expected a raster"));

    RasterSpec spec;
    spec.columns = spec.rows = 200;
    spec.value = stored;
    make_raster(folder.path() / "cut.tif", spec);
    std::filesystem::resize_file(folder.path() / "cut.tif", 90000);
    CHECK(contains(refused("cut.tif"), "damaged or incomplete"));
    std::ofstream(folder.path() / "cut.asc") << "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 4\n1 2 3\n4";
    CHECK(contains(refused("cut.asc"), "damaged or incomplete"));

    RasterSpec bare;
    bare.crs = "";
    bare.transform = {};
    make_raster(folder.path() / "bare.tif", bare);
    CHECK(contains(refused("bare.tif"), "gdal_translate -a_ullr"));
}

TEST_CASE("A rotated raster is refused, and the gdalwarp in the message makes it readable", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.transform = {500000.0, 8.0, 6.0, 6000060.0, 6.0, -8.0};
    spec.columns = spec.rows = 30;
    spec.value = [](int, int) { return 321.0; };
    make_raster(folder.path() / "dem.tif", spec);
    const std::string message = user_error([&] { dem_of(folder.path() / "dem.tif"); });
    CHECK(contains(message, "rotated"));
    run_gdal_line(cure_in(message));
    const Raster dem = dem_of(folder.path() / "dem_north_up.tif");
    Index valid = 0;
    for (const double z : dem.values)
        if (!std::isnan(z)) {
            ++valid;
            CHECK(z == Approx(321.0).epsilon(1e-6));
        }
    CHECK(valid > 500);  // of 900 pixels of 100 m2, now about as large and in a larger frame
    CHECK(double(valid) < 0.7 * double(dem.geometry.size()));  // its corners are nodata, not terrain at 0 m
}
