// Depths, masks and surfaces on a terrain's grid; and real data beside GDAL's own answers.
#include <cmath>
#include <random>

#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io/gdal_support.h"
#include "io/gdal_writer.h"
#include "io_gdal_make.h"
#include "shared_data.h"

#include "catch.h"

using namespace frana;

namespace {

std::string wkt_of(int code) {
    OGRSpatialReference crs;
    crs.importFromEPSG(code);
    char* text = nullptr;
    crs.exportToWkt(&text);
    std::string wkt(text);
    CPLFree(text);
    return wkt;
}

/// A hump of depth on 10 m pixels, zero around; 80 m by 60 m.
RasterSpec hump() {
    RasterSpec spec;
    spec.value = [](int column, int row) {
        return column >= 3 && column <= 5 && row >= 2 && row <= 4 ? 1.0 + column - 0.5 * row : 0.0;
    };
    return spec;
}

double volume(const Raster& depth) {
    double sum = 0.0;
    for (const double h : depth.values)
        if (!std::isnan(h)) sum += h * depth.geometry.cell * depth.geometry.cell;
    return sum;
}

}  // namespace

TEST_CASE("A field is read in its own pixels, cut to those that touch the extent", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "depth.tif", hump());
    std::vector<std::string> log;
    const Raster out =
        GdalReader().read_raster(folder.path() / "depth.tif", {500031, 6000000, 500055, 6000035}, wkt_of(32632), log);
    CHECK(out.geometry == GridGeometry{3, 4, 500035.0, 6000005.0, 10.0});
    CHECK(out.at(0, 1) == hump().value(3, 4));
    CHECK(out.at(2, 3) == hump().value(5, 2));
    const double far = 1e300;
    CHECK(GdalReader().read_raster(folder.path() / "depth.tif", {-far, -far, far, far}, "", log).geometry.size() == 48);
    CHECK(contains(user_error([&] {
                       GdalReader().read_raster(folder.path() / "depth.tif", {0, 0, 10, 10}, wkt_of(32632), log);
                   }),
                   "does not touch [0, 0, 10, 10]"));
}

TEST_CASE("The unit that a raster declares for its numbers is told", "[gdal]") {
    const FreshFolder folder;
    const Raster speeds = Raster::filled({3, 2, 0.0, 0.0, 5.0}, 36.0);
    write_geotiff(folder.path() / "v.tif", speeds, "km/h", "speeds");
    CHECK(GdalReader().unit_of(folder.path() / "v.tif") == "km/h");
}

TEST_CASE("A field beside the extent has nothing above 0 there, and is refused where it is read", "[gdal]") {
    const FreshFolder folder;
    const auto file = folder.path() / "depth.tif";
    make_raster(file, hump());
    const GdalReader reader;
    CHECK(reader.extent_above_zero(file, {500000, 6000000, 500080, 6000060}, wkt_of(32632)).has_value());
    CHECK_FALSE(reader.extent_above_zero(file, {500080, 6000000, 500180, 6000060}, wkt_of(32632)).has_value());
    CHECK_FALSE(reader.extent_above_zero(file, {500000, 6000060, 500080, 6000160}, wkt_of(32632)).has_value());
}

TEST_CASE("A field of pixels that are not square is refused with a gdalwarp that makes them so", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = hump();
    spec.transform[1] = 8.0;
    make_raster(folder.path() / "depth.tif", spec);
    std::vector<std::string> log;
    const auto read = [&](const char* name) {
        return GdalReader().read_raster(folder.path() / name, {500000, 6000000, 500064, 6000060}, "", log);
    };
    run_gdal_line(cure_in(user_error([&] { read("depth.tif"); })));
    CHECK(read("depth_square.tif").geometry.cell == 8.0);
}

TEST_CASE("A depth on coarser, equal or shifted cells conserves its volume, and is nowhere negative", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec = hump();
    spec.rows = 9;  // dry pixels all around, so that no cell at the rim is cut off with material in it
    make_raster(folder.path() / "depth.tif", spec);
    std::vector<std::string> log;
    const double exact = 100.0 * (3 * (4 + 5 + 6) - 0.5 * 3 * (2 + 3 + 4));
    for (const double cell : {10.0, 13.0, 20.0, 3.0, 2.0})
        for (const double shift : {0.0, 1.7}) {
            INFO("cell " << cell << " shifted by " << shift);
            const Index n = Index(200.0 / cell);
            const GridGeometry grid{n, n, 499950.0 + shift, 5999950.0 + shift, cell};
            const Raster out = GdalReader().read_onto(folder.path() / "depth.tif", grid, "", log);
            CHECK(any_contains(log, "no data beyond"));
            if (cell >= 10.0)
                CHECK(volume(out) == Approx(exact).epsilon(1e-12));
            else
                CHECK(volume(out) == Approx(exact).epsilon(0.06));  // interpolation meets heights, not volumes
            for (const double h : out.values)
                if (h < 0.0) FAIL("negative depth " << h);
        }
    const Raster same = GdalReader().read_onto(folder.path() / "depth.tif", {8, 6, 500005.0, 6000005.0, 10.0}, "", log);
    CHECK(same.at(4, 2) == hump().value(4, 3));
    CHECK(volume(same) == exact);
}

TEST_CASE("A pre-failure surface and a terrain resample alike, so equal surfaces give no depth", "[gdal]") {
    const FreshFolder folder;
    std::mt19937 random(3);
    std::vector<double> heights(48);
    for (double& z : heights) z = 500.0 + double(random() % 1000) / 50.0;
    RasterSpec spec;
    spec.value = [&](int column, int row) { return heights[std::size_t(row * 8 + column)]; };
    make_raster(folder.path() / "dem.tif", spec);
    std::vector<std::string> log;
    for (const double cell : {2.5, 7.0, 20.0}) {
        const Raster bed = GdalReader().read_dem(folder.path() / "dem.tif", {{}, cell}, log);
        const Raster top = GdalReader().read_onto(folder.path() / "dem.tif", bed.geometry, bed.crs_wkt, log);
        CHECK(top.values == bed.values);
    }
}

TEST_CASE("Nodes that a field does not cover have no data, and the log says so", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "depth.tif", hump());
    std::vector<std::string> log;
    const Raster out =
        GdalReader().read_onto(folder.path() / "depth.tif", {20, 20, 499955.0, 5999955.0, 10.0}, "", log);
    CHECK(std::isnan(out.at(0, 0)));
    CHECK(std::isnan(out.at(4, 10)));
    CHECK(out.at(5, 5) == 0.0);
    CHECK(any_contains(log, "no data beyond"));
}

TEST_CASE("A field in degrees or another zone lands where the terrain has it", "[gdal]") {
    const FreshFolder folder;
    // Height = easting in zone 32 less 409000, stored on degrees: the answer is known at any node.
    OGRSpatialReference degrees, utm;
    degrees.importFromEPSG(4326);
    utm.importFromEPSG(32632);
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const gdal::Transformation forth(OGRCreateCoordinateTransformation(&degrees, &utm));
    RasterSpec spec;
    spec.crs = "EPSG:4326";
    spec.columns = spec.rows = 200;
    spec.type = GDT_Float64;
    spec.transform = {7.25, 2e-4, 0.0, 61.98, 0.0, -1e-4};
    spec.value = [&](int column, int row) {
        double x = 7.25 + (column + 0.5) * 2e-4, y = 61.98 - (row + 0.5) * 1e-4;
        forth->Transform(1, &x, &y);
        return x - 409000.0;
    };
    make_raster(folder.path() / "field.tif", spec);
    const GridGeometry grid{40, 30, 409005.0, 6871505.0, 10.0};
    std::vector<std::string> log;
    const Raster onto = GdalReader().read_onto(folder.path() / "field.tif", grid, wkt_of(32632), log);
    CHECK(any_contains(log, "reprojected from EPSG:4326"));
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i)
            if (!(std::abs(onto.at(i, j) - (grid.x(i) - 409000.0)) < 0.01))  // bilinear on a field all but linear
                FAIL("node " << i << " " << j << ": " << onto.at(i, j));
    const Raster own = GdalReader().read_raster(folder.path() / "field.tif", grid.pixel_extent(), wkt_of(32632), log);
    CHECK(own.geometry.cell == Approx(10.8).margin(0.2));  // 10.5 m by 11.1 m
    CHECK(own.at(7, 9) == Approx(own.geometry.x(7) - 409000.0).margin(0.01));
}

TEST_CASE("A real elevation model reads as GDAL locates its values", "[gdal]") {
    const auto file = shared_data("ryggfonn_2021/dem.tif");
    if (!file) return;
    std::vector<std::string> log;
    const Raster dem = GdalReader().read_dem(*file, {}, log);
    REQUIRE(dem.geometry.nx == 459);
    REQUIRE(dem.geometry.ny == 633);
    // gdallocationinfo -valonly -geoloc dem.tif X Y
    struct Place {
        double x, y, z;
    };
    const Place places[] = {{408400, 6870086, 819.239990234375},
                            {410690, 6873247, 785.0419921875},
                            {409545.25, 6871666.61, 783.333984375},
                            {410021.77, 6870546.98, 1473.01403808594},
                            {408500.3, 6873100.9, 1180},
                            {410500.9, 6870200.2, 1485.13098144531}};
    for (const Place& place : places) {
        const Index i = Index(std::floor((place.x - 408397.75) / 5.0));
        const Index j = Index(std::floor((place.y - 6870084.11) / 5.0));
        INFO(place.x << " " << place.y);
        CHECK(dem.at(i, j) == Approx(place.z).epsilon(1e-7));  // printed digits of a float32
    }
    const Raster part = GdalReader().read_dem(*file, {{{409000.0, 6870500.0, 409500.0, 6871000.0}}, {}}, log);
    const Index i0 = std::llround((part.geometry.x0 - dem.geometry.x0) / 5.0);
    const Index j0 = std::llround((part.geometry.y0 - dem.geometry.y0) / 5.0);
    for (Index j = 0; j < part.geometry.ny; ++j)
        for (Index i = 0; i < part.geometry.nx; ++i)
            if (part.at(i, j) != dem.at(i0 + i, j0 + j)) FAIL("window pixel " << i << " " << j);
}

namespace {

/// Squares of 30 x 30 pixels of 10 m around 12 degrees east, where zones 32 and 33 have the same scale and 4 degrees
/// between their norths.
constexpr double kEast33 = 267000.0, kNorth33 = 5100000.0;

RasterSpec square_of_zone_33(double within, double around) {
    RasterSpec spec;
    spec.crs = "EPSG:32633";
    spec.columns = spec.rows = 60;
    spec.type = GDT_Float64;
    spec.nodata = -9999.0;
    spec.transform = {kEast33, 10.0, 0.0, kNorth33 + 600.0, 0.0, -10.0};
    spec.value = [=](int column, int row) {
        return column >= 15 && column < 45 && row >= 15 && row < 45 ? within : around;
    };
    return spec;
}

/// The middle of that raster in zone 32.
Vec2 middle_in_zone_32() {
    OGRSpatialReference from, to;
    from.importFromEPSG(32633);
    to.importFromEPSG(32632);
    const gdal::Transformation forth(OGRCreateCoordinateTransformation(&from, &to));
    double x = kEast33 + 300.0, y = kNorth33 + 300.0;
    forth->Transform(1, &x, &y);
    return {std::round(x), std::round(y)};
}

/// Share of a cell of zone 32 that lies in the square, counted on 10 x 10 places: a straight edge to 0.05.
double share_in_square(const GridGeometry& grid, Index i, Index j) {
    static const gdal::Transformation back = [] {
        OGRSpatialReference from, to;
        from.importFromEPSG(32632);
        to.importFromEPSG(32633);
        return gdal::Transformation(OGRCreateCoordinateTransformation(&from, &to));
    }();
    constexpr int kPlaces = 10;
    int inside = 0;
    for (int n = 0; n < kPlaces; ++n)
        for (int m = 0; m < kPlaces; ++m) {
            double x = grid.x(i) + ((m + 0.5) / kPlaces - 0.5) * grid.cell,
                   y = grid.y(j) + ((n + 0.5) / kPlaces - 0.5) * grid.cell;
            back->Transform(1, &x, &y);
            x -= kEast33 + 150.0, y -= kNorth33 + 150.0;
            inside += x >= 0.0 && x < 300.0 && y >= 0.0 && y < 300.0;
        }
    return inside / double(kPlaces * kPlaces);
}

}  // namespace

TEST_CASE("A mask of another zone covers its area, whatever its number and what is around", "[gdal]") {
    const Vec2 middle = middle_in_zone_32();
    const std::array<double, 4> extent{middle.x() - 250, middle.y() - 250, middle.x() + 250, middle.y() + 250};
    for (const double number : {1.0, 0.25, 255.0})
        for (const double around : {0.0, -9999.0}) {
            CAPTURE(number, around);
            const FreshFolder folder;
            make_raster(folder.path() / "mask.tif", square_of_zone_33(number, around));
            std::vector<std::string> log;
            const Raster mask = GdalReader().read_mask(folder.path() / "mask.tif", extent, wkt_of(32632), log);
            double area = 0.0;
            for (const double value : mask.values) {
                if (!(value > 0.0)) continue;
                CHECK(value == number);
                area += mask.geometry.cell * mask.geometry.cell;
            }
            // 120 pixels along the edge, each by its middle: an error of sqrt(120 / 12) of 900 pixels, of which 3 here.
            CHECK(area == Approx(90000.0).epsilon(0.011));
        }
}

TEST_CASE("A cell needs values on half of it, in another zone as in the file's own", "[gdal]") {
    const FreshFolder folder;
    make_raster(folder.path() / "depth.tif", square_of_zone_33(2.0, -9999.0));
    const Vec2 middle = middle_in_zone_32();
    for (const double cell : {50.0, 10.0, 4.0}) {  // the first is averaged, the others interpolated
        CAPTURE(cell);
        const Index n = Index(400.0 / cell);
        const GridGeometry grid{n, n, middle.x() - 200.0 + 0.5 * cell, middle.y() - 200.0 + 0.5 * cell, cell};
        std::vector<std::string> log;
        const Raster out = GdalReader().read_onto(folder.path() / "depth.tif", grid, wkt_of(32632), log);
        Index known = 0, missing = 0;
        for (Index j = 0; j < n; ++j)
            for (Index i = 0; i < n; ++i) {
                // Interpolated are four pixels around a middle, and it is half of a pixel that they need.
                GridGeometry wide = grid;
                wide.cell = std::max(cell, 10.0);
                wide.x0 = grid.x(i), wide.y0 = grid.y(j);
                const double share = share_in_square(wide, 0, 0);
                if (std::abs(share - 0.5) < 0.1) continue;  // corners, and what whole pixels of the file cut off
                INFO(i << " " << j << " " << share);
                if (share > 0.5) {
                    ++known;
                    CHECK(out.at(i, j) == Approx(2.0).epsilon(1e-12));
                } else {
                    ++missing;
                    CHECK(std::isnan(out.at(i, j)));
                }
            }
        CHECK(known > 20);
        CHECK(missing > 20);
    }
}

TEST_CASE("A field without a CRS beside a terrain that has one is remarked upon", "[gdal][remarks]") {
    const FreshFolder folder;
    RasterSpec spec = hump();
    for (const char* crs : {"", "EPSG:32632"}) {
        spec.crs = crs;
        make_raster(folder.path() / "depth.tif", spec);
        std::vector<std::string> log;
        GdalReader().read_raster(folder.path() / "depth.tif", {500000.0, 6000000.0, 500080.0, 6000060.0}, wkt_of(32632),
                                 log);
        GdalReader().read_onto(folder.path() / "depth.tif", {4, 4, 500005.0, 6000005.0, 10.0}, wkt_of(32632), log);
        const bool said = any_contains(log, "depth.tif: no CRS; coordinates are taken as the terrain's own");
        CHECK(said == spec.crs.empty());
    }
}
