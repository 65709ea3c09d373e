// Windows and spacings of an elevation model.
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>

#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io_gdal_make.h"
#include "observe/profiles.h"
#include "scene/case_file.h"
#include "terrain/places.h"

#include "catch.h"

using namespace frana;

namespace {

constexpr int columns = 40, rows = 30;
constexpr double left = 500000.0, bottom = 6000000.0, pixel = 5.0;

/// A plane in map coordinates: exact under every resampling that is worth its name.
double plane(double x, double y) { return 800.0 + 0.4 * (x - left) - 0.25 * (y - bottom); }

RasterSpec plane_spec(double dx = pixel, double dy = pixel) {
    RasterSpec spec;
    spec.columns = columns;
    spec.rows = rows;
    spec.type = GDT_Float64;
    spec.transform = {left, dx, 0.0, bottom + rows * dy, 0.0, -dy};
    spec.value = [=](int column, int row) {
        return plane(left + (column + 0.5) * dx, bottom + (rows - row - 0.5) * dy);
    };
    return spec;
}

struct Read {
    Raster dem;
    std::vector<std::string> log;
};

Read read(const std::filesystem::path& file, std::optional<std::array<double, 4>> window, std::optional<double> cell) {
    Read out;
    out.dem = GdalReader().read_dem(file, {window, cell}, out.log);
    return out;
}

/// Largest distance from the plane, NaN when a node is NaN.
double off_plane(const Raster& dem) {
    double worst = 0.0;
    for (Index j = 0; j < dem.geometry.ny; ++j)
        for (Index i = 0; i < dem.geometry.nx; ++i) {
            const double error = std::abs(dem.at(i, j) - plane(dem.geometry.x(i), dem.geometry.y(j)));
            if (!(error <= worst)) worst = error;
        }
    return worst;
}

}  // namespace

TEST_CASE("A window on pixel edges takes exactly its pixels", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "dem.tif", plane_spec());
    const auto out = read(folder.path() / "dem.tif", {{left + 10, bottom + 20, left + 60, bottom + 45}}, pixel);
    CHECK(out.dem.geometry == GridGeometry{10, 5, left + 12.5, bottom + 22.5, pixel});
    CHECK(off_plane(out.dem) < 1e-10);  // doubles near 1000: not touched at all
    CHECK_FALSE(any_contains(out.log, "widened"));
}

TEST_CASE("A window between pixel edges is widened to whole pixels, and the log says so", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "dem.tif", plane_spec());
    const auto out = read(folder.path() / "dem.tif", {{left + 11, bottom + 21, left + 59, bottom + 44}}, {});
    CHECK(out.dem.geometry == GridGeometry{10, 5, left + 12.5, bottom + 22.5, pixel});
    CHECK(off_plane(out.dem) < 1e-10);
    CHECK(any_contains(out.log, "widened to whole pixels: [500010, 6000020, 500060, 6000045]"));
}

TEST_CASE("A window that leaves the raster is refused with both extents", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "dem.tif", plane_spec());
    const auto message = user_error([&] {
        read(folder.path() / "dem.tif", {{left - 10, bottom, left + 60, bottom + 45}}, {});
    });
    CHECK(contains(message, "[499990, 6000000, 500060, 6000045]"));
    CHECK(contains(message, "[500000, 6000000, 500200, 6000150]"));
    CHECK_THROWS_AS(read(folder.path() / "dem.tif", {{left + 60, bottom, left + 10, bottom + 45}}, {}), UserError);
}

TEST_CASE("A plane stays a plane under every cell size and window", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "dem.tif", plane_spec());
    const std::optional<std::array<double, 4>> windows[] = {
        std::nullopt, std::array<double, 4>{left + 13.7, bottom + 20.3, left + 113.7, bottom + 110.3}};
    for (const auto& window : windows)
        for (const double cell : {1.0, 2.5, 3.3, 4.9, 5.1, 7.0, 10.0, 12.5, 20.0}) {
            INFO("cell " << cell << (window ? " in a window" : ""));
            const auto out = read(folder.path() / "dem.tif", window, cell);
            CHECK(out.dem.geometry.cell == cell);
            CHECK(off_plane(out.dem) < 1e-9);  // round-off of weights times elevations near 1000
            CHECK(
                any_contains(out.log, cell < pixel ? "5 m pixels interpolated (cubic) to" : "5 m pixels averaged to"));
        }
}

TEST_CASE("Cells of whole pixels hold the plain mean, and the volume under any terrain is conserved", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = plane_spec();
    spec.value = [](int column, int row) { return 1000.0 + (column * 7919 + row * 104729) % 97; };
    make_raster(folder.path() / "dem.tif", spec);
    const auto whole = read(folder.path() / "dem.tif", {}, 10.0);
    const auto& value = spec.value;
    const double mean = 0.25 * (value(4, rows - 1) + value(5, rows - 1) + value(4, rows - 2) + value(5, rows - 2));
    CHECK(whole.dem.at(2, 0) == Approx(mean).epsilon(1e-14));

    double pixels = 0.0;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) pixels += value(column, row) * pixel * pixel;
    for (const double cell : {10.0, 50.0 / 7.0}) {  // 200 m by 150 m are 28 by 21 cells of the latter
        const auto out = read(folder.path() / "dem.tif", {}, cell);
        double sum = 0.0;
        for (const double z : out.dem.values) sum += z * cell * cell;
        CHECK(sum == Approx(pixels).epsilon(1e-12));
    }
}

TEST_CASE("Cubic interpolation is exact for parabolas and passes through the pixels", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = plane_spec();
    const auto bowl = [](double x, double y) {
        return 1e-2 * (x - left) * (x - left) + 2e-2 * (y - bottom) * (x - left);
    };
    spec.value = [=](int column, int row) {
        return bowl(left + (column + 0.5) * pixel, bottom + (rows - row - 0.5) * pixel);
    };
    make_raster(folder.path() / "dem.tif", spec);
    const auto out = read(folder.path() / "dem.tif", {{left + 20, bottom + 20, left + 150, bottom + 120}}, 1.0);
    for (Index j = 0; j < out.dem.geometry.ny; ++j)
        for (Index i = 0; i < out.dem.geometry.nx; ++i)
            if (std::abs(out.dem.at(i, j) - bowl(out.dem.geometry.x(i), out.dem.geometry.y(j))) > 1e-9)
                FAIL("node " << i << " " << j);
}

TEST_CASE("Pixels that are not square become cells of their finer edge, and the log says so", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "dem.tif", plane_spec(5.0, 4.0));
    const auto out = read(folder.path() / "dem.tif", {}, {});
    CHECK(out.dem.geometry.cell == 4.0);
    CHECK(out.dem.geometry.nx == 50);
    CHECK(out.dem.geometry.ny == 30);
    CHECK(off_plane(out.dem) < 1e-9);
    CHECK(any_contains(out.log, "pixels of 5 m by 4 m"));
    const auto coarse = read(folder.path() / "dem.tif", {}, 10.0);
    CHECK(coarse.dem.geometry.ny == 12);
    CHECK(off_plane(coarse.dem) < 1e-9);
}

TEST_CASE("Nodata is never mixed into terrain, coarser or finer", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = plane_spec();
    spec.nodata = -9999.0;
    const auto& terrain = plane_spec().value;
    spec.value = [=](int column, int row) { return column < 13 && row < 11 ? -9999.0 : terrain(column, row); };
    make_raster(folder.path() / "dem.tif", spec);
    for (const double cell : {1.0, 2.5, 4.0, 5.0, 6.0, 10.0, 15.0}) {
        INFO("cell " << cell);
        const auto out = read(folder.path() / "dem.tif", {}, cell);
        Index gaps = 0;
        for (Index j = 0; j < out.dem.geometry.ny; ++j)
            for (Index i = 0; i < out.dem.geometry.nx; ++i) {
                const double z = out.dem.at(i, j);
                const double x = out.dem.geometry.x(i), y = out.dem.geometry.y(j);
                gaps += std::isnan(z);
                const bool deep_inside = x < left + 65 - cell && y > bottom + 95 + cell;
                if (deep_inside && !std::isnan(z)) FAIL("terrain out of nothing at node " << i << " " << j);
                // The plane's slopes move a one-sided mean by less than 0.65 of its reach.
                const double reach = 0.65 * std::max(cell, pixel);
                if (!std::isnan(z) && std::abs(z - plane(x, y)) > reach) FAIL("nodata in node " << i << " " << j);
            }
        // A node is lost when half of it is: the gap of 65 m by 55 m keeps its area to half a cell all
        // around.
        const double area = double(gaps) * cell * cell;
        CHECK(area == Approx(65.0 * 55.0).margin(0.5 * cell * (65.0 + 55.0) + cell * cell));
    }
}

TEST_CASE("A window of nodata alone is refused", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = plane_spec();
    spec.nodata = -9999.0;
    spec.value = [](int column, int) { return column < 20 ? -9999.0 : 5.0; };
    make_raster(folder.path() / "dem.tif", spec);
    CHECK(contains(user_error([&] {
                       read(folder.path() / "dem.tif", {{left, bottom, left + 50, bottom + 50}}, {});
                   }),
                   "holds no data"));
}

TEST_CASE("A small window of a huge raster is read without reading the raster", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.columns = spec.rows = 100000;  // 1e10 pixels: 40 GB as float32; a sparse file holds none of them
    spec.transform = {0.0, 1.0, 0.0, 100000.0, 0.0, -1.0};
    spec.options = {"TILED=YES", "SPARSE_OK=TRUE", "BIGTIFF=YES"};
    GDALAllRegister();
    const auto file = folder.path() / "dem.tif";
    {
        CPLStringList options;
        for (const auto& option : spec.options) options.AddString(option.c_str());
        GDALDataset* made = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
            file.c_str(), spec.columns, spec.rows, 1, GDT_Float32, options.List());
        REQUIRE(made != nullptr);
        made->SetGeoTransform(spec.transform.data());
        float mark = 77.0F;  // column 50500, row 49500: x 50500.5, y 50499.5
        REQUIRE(made->GetRasterBand(1)->RasterIO(GF_Write, 50500, 49500, 1, 1, &mark, 1, 1, GDT_Float32, 0, 0,
                                                 nullptr) == CE_None);
        GDALClose(made);
    }
    const auto start = std::chrono::steady_clock::now();
    const auto fine = read(file, {{50000, 50000, 51000, 51000}}, {});
    const auto coarse = read(file, {{50000, 50000, 51000, 51000}}, 10.0);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    CHECK(fine.dem.geometry.size() == 1000000);
    CHECK(fine.dem.at(500, 499) == 77.0);
    CHECK(coarse.dem.at(50, 49) == Approx(0.77));
    CHECK(seconds < 10.0);  // 0.1 s here; the whole raster would take minutes, if it fitted
    CHECK(contains(user_error([&] { read(file, {}, {}); }), "smaller window or a larger cell"));
}

TEST_CASE("The profile of the case with erosion runs along the floor of its gully", "[gdal][cases]") {
    const std::string folder = FRANA_SOURCE_DIR "/cases/erosion/";
    const Raster dem = read(folder + "data/dem.tif", {}, {}).dem;
    std::ifstream file(folder + "case.toml");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const Polyline line = CaseFile::parse(text, "case.toml").points("profile.0.line");
    const GridGeometry& g = dem.geometry;
    for (const Station& station : stations(line, g.cell)) {
        const Vec2& at = station.point;
        if (at.x() > 900.0) break;  // there the fan begins
        const NodeAt node = nearest_node(g, at);
        Index lowest = node.j;
        for (Index j = node.j - 10; j <= node.j + 10; ++j)
            if (dem.at(node.i, j) < dem.at(node.i, lowest)) lowest = j;
        CAPTURE(at.x(), at.y());
        CHECK(std::abs(g.y(lowest) - at.y()) <= 2.0 * g.cell);  // the floor is wider, and pieces are straight
    }
}

TEST_CASE("Heights that the file only calls feet are remarked upon, unless it declares metres", "[gdal][remarks]") {
    const FreshFolder folder;
    RasterSpec spec = plane_spec();
    make_raster(folder.path() / "dem.tif", spec);
    const std::string dem = (folder.path() / "dem.tif").string(), named = (folder.path() / "named.tif").string();
    run_gdal_line("gdal_translate -mo HEIGHTS=in_feet,NAVD88 -mo NOTE=lifted_aloft " + dem + " " + named);
    CHECK_FALSE(any_contains(read(dem, {}, {}).log, "feet"));
    CHECK_FALSE(any_contains(read(named, {}, {}).log, "feet"));  // a word within a name
    run_gdal_line("gdal_translate -mo HEIGHTS=feet,NAVD88 " + dem + " " + named);
    CHECK(any_contains(read(named, {}, {}).log, "named.tif: found \"HEIGHTS=feet,NAVD88\" in its description"));
    spec.unit = "m";
    make_raster(folder.path() / "dem.tif", spec);
    run_gdal_line("gdal_translate -mo HEIGHTS=feet,NAVD88 " + dem + " " + named);
    CHECK_FALSE(any_contains(read(named, {}, {}).log, "feet"));
}

TEST_CASE("An elevation model with a palette is asked whether it is a picture", "[gdal][remarks]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.type = GDT_Byte;
    make_raster(folder.path() / "dem.tif", spec);
    std::vector<std::string> log;
    GdalReader().read_dem(folder.path() / "dem.tif", {}, log);
    CHECK_FALSE(any_contains(log, "palette"));
    {
        GDALColorTable colours;
        const GDALColorEntry red{255, 0, 0, 255};
        colours.SetColorEntry(1, &red);
        const std::unique_ptr<GDALDataset> dataset(
            GDALDataset::Open((folder.path() / "dem.tif").c_str(), GDAL_OF_RASTER | GDAL_OF_UPDATE));
        REQUIRE(dataset->GetRasterBand(1)->SetColorTable(&colours) == CE_None);
    }
    GdalReader().read_dem(folder.path() / "dem.tif", {}, log);
    CHECK(any_contains(log, "dem.tif: has a palette, its numbers are used; is this a picture rather than a field?"));
}
