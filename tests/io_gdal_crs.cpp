// Coordinate systems that a run cannot use are refused with a line that works.
#include <algorithm>
#include <cmath>
#include <utility>

#include "fresh_folder.h"
#include "io/gdal_crs.h"
#include "io/gdal_reader.h"
#include "io_gdal_make.h"
#include "shared_data.h"

#include "catch.h"

using namespace frana;

namespace {

Raster read(const std::filesystem::path& file) {
    std::vector<std::string> log;
    return GdalReader().read_dem(file, {}, log);
}

double range(const Raster& dem, bool high) {
    double best = high ? -1e300 : 1e300;
    for (const double z : dem.values)
        if (!std::isnan(z)) best = high ? std::max(best, z) : std::min(best, z);
    return best;
}

/// 60 by 60 pixels of degrees around a place, 500 m to 559 m high.
RasterSpec degrees_at(double lon, double lat) {
    RasterSpec spec;
    spec.crs = "EPSG:4326";
    spec.columns = spec.rows = 60;
    spec.transform = {lon - 0.006, 0.0002, 0.0, lat + 0.006, 0.0, -0.0002};
    spec.value = [](int column, int) { return 500.0 + column; };
    return spec;
}

}  // namespace

TEST_CASE("Degrees are refused with a gdalwarp to the UTM zone of the place, and it works", "[gdal]") {
    struct Place {
        double lon, lat;
        const char* code;
    };
    const Place places[] = {{7.27, 61.97, "EPSG:32632"},
                            {-84.2, 36.6, "EPSG:32616"},
                            {-70.1, -33.4, "EPSG:32719"},
                            {174.8, -36.9, "EPSG:32760"},
                            {-179.5, 10.0, "EPSG:32601"}};
    for (const Place& place : places) {
        const FreshFolder folder;
        make_raster(folder.path() / "dem.tif", degrees_at(place.lon, place.lat));
        const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
        INFO(message);
        CHECK(contains(message, "degrees"));
        CHECK(contains(message, std::string("gdalwarp -t_srs ") + place.code + " "));
        run_gdal_line(cure_in(message));
        const Raster dem = read(folder.path() / "dem_utm.tif");
        CHECK(contains(dem.crs_wkt, "WGS 84 / UTM zone"));
        CHECK(range(dem, false) >= 499.5);  // corners are nodata, not 0 m; one-sided kernels at the rim of a slope
        CHECK(range(dem, true) <= 559.5);   // of 1 m a pixel stay within half a pixel
    }
}

TEST_CASE("Feet on the map are refused, US survey feet and international feet alike", "[gdal]") {
    for (const char* crs : {"EPSG:2263", "EPSG:2222"}) {  // New York (ftUS), Arizona East (ft)
        const FreshFolder folder;
        RasterSpec spec;
        spec.crs = crs;
        spec.columns = spec.rows = 40;
        spec.transform = {980000.0, 30.0, 0.0, 200000.0, 0.0, -30.0};
        spec.value = [](int column, int row) { return 100.0 + column + row; };
        make_raster(folder.path() / "dem.tif", spec);
        const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
        INFO(message);
        CHECK(contains(message, "foot"));
        run_gdal_line(cure_in(message));
        const Raster dem = read(folder.path() / "dem_utm.tif");
        CHECK(dem.geometry.cell == Approx(30.0 * 0.3048).epsilon(0.01));  // scale of the two map projections
        CHECK(range(dem, true) == Approx(178.0).margin(2.0));             // the corner pixel rises by 2 m
    }
}

TEST_CASE("Elevations declared in feet are refused and cured, with or without metres on the map", "[gdal]") {
    struct Kind {
        const char* crs;
        const char* unit;
        double metres;
    };
    const Kind kinds[] = {{"EPSG:32618+6360", "", 1200.0 / 3937.0},  // NAVD88 height (ftUS)
                          {"EPSG:2263+6360", "", 1200.0 / 3937.0},
                          {"EPSG:32618", "ft", 0.3048}};
    for (const Kind& kind : kinds) {
        INFO(kind.crs << " " << kind.unit);
        const FreshFolder folder;
        RasterSpec spec;
        spec.crs = kind.crs;
        spec.unit = kind.unit;
        spec.nodata = -9999.0;
        spec.columns = spec.rows = 40;
        spec.transform = {580000.0, 30.0, 0.0, 200000.0, 0.0, -30.0};
        spec.value = [](int column, int row) { return row < 5 ? -9999.0 : 1000.0 + column; };
        make_raster(folder.path() / "dem.tif", spec);
        const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
        INFO(message);
        const std::string line = cure_in(message);
        run_gdal_line(line);
        const Raster dem = read(line.substr(line.rfind(' ') + 1));
        CHECK(range(dem, false) == Approx(1000.0 * kind.metres).margin(0.2));  // half a pixel of 1 ft, as above
        CHECK(range(dem, true) == Approx(1039.0 * kind.metres).margin(0.2));
    }
}

TEST_CASE("Depths declared in feet or centimetres are refused and cured, by whatever name", "[gdal]") {
    struct Kind {
        const char* crs;
        const char* unit;
        double metres;  ///< 0: is accepted
    };
    const Kind kinds[] = {{"EPSG:32632", "ft", 0.3048},
                          {"EPSG:32632", "cm", 0.01},
                          {"EPSG:32632", "", 0.0},
                          {"EPSG:32632", "m", 0.0},
                          {"EPSG:32632", "Metres (EGM2008)", 0.0},
                          {"EPSG:32632", "m a.s.l.", 0.0},
                          {"EPSG:32632", "unknown", 0.0},
                          {"EPSG:32632", "US feet", 1200.0 / 3937.0},
                          {"EPSG:32632", "USft", 1200.0 / 3937.0},
                          {"EPSG:32632", "us_ft", 1200.0 / 3937.0},
                          {"EPSG:32632", "foot (international)", 0.3048},
                          {"EPSG:32632", "yd", 0.9144},
                          {"EPSG:32632", "decimetre", 0.1},
                          {"EPSG:32632", "centimeters", 0.01},
                          {"", "Feet", 0.3048},
                          {"EPSG:32618+6360", "", 1200.0 / 3937.0}};
    for (const Kind& kind : kinds) {
        INFO(kind.crs << " " << kind.unit);
        const FreshFolder folder;
        RasterSpec spec;
        spec.crs = kind.crs;
        spec.unit = kind.unit;
        spec.value = [](int column, int) { return 5.0 + column; };
        const auto file = folder.path() / "depth.tif";
        make_raster(file, spec);
        if (kind.metres == 0.0) {
            CHECK_NOTHROW(GdalReader().require_metres(file));
            continue;
        }
        const std::string message = user_error([&] { GdalReader().require_metres(file); });
        INFO(message);
        CHECK(contains(message, "depth.tif: its values are declared in "));
        CHECK(contains(message, "; expected metres; run: gdalbuildvrt "));
        const std::string line = cure_in(message);
        run_gdal_line(line);
        const std::filesystem::path cured = line.substr(line.rfind(' ') + 1);
        CHECK_NOTHROW(GdalReader().require_metres(cured));
        CHECK(range(read(cured), true) == Approx(12.0 * kind.metres).epsilon(1e-6));
    }
}

TEST_CASE("A unit that is no known length is refused, for depths and elevations alike", "[gdal]") {
    for (const char* unit : {"Pa", "cubit", "m/s", "m 1e-2"}) {
        CAPTURE(unit);
        const FreshFolder folder;
        RasterSpec spec;
        spec.unit = unit;
        spec.value = [](int column, int) { return 5.0 + column; };
        const auto file = folder.path() / "depth.tif";
        make_raster(file, spec);
        const std::string declared = std::string(" are declared in \"") + unit + "\", which is no length that is known";
        CHECK(contains(user_error([&] { GdalReader().require_metres(file); }), "its values" + declared));
        const std::string message = user_error([&] { read(file); });
        CHECK(contains(message, "its elevations" + declared));
        const std::string line = cure_in(message);  // for a unit of 0.5 m
        run_gdal_line(line);
        CHECK(range(read(line.substr(line.rfind(' ') + 1)), true) == Approx(6.0).epsilon(1e-6));
    }
}

TEST_CASE("Elevations that the band and the CRS declare in different units are refused", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.crs = "EPSG:32632+5773";
    spec.unit = "ft";
    spec.value = [](int column, int) { return 1000.0 + column; };
    make_raster(folder.path() / "dem.tif", spec);
    const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
    CHECK(contains(message, "its elevations are declared in \"ft\" by the band and in \"metre\" by the CRS"));
    const std::string metres = message.substr(0, message.find("; where ft is true"));
    CHECK(contains(metres, "where metre is true run: gdalbuildvrt "));
    for (const auto& [line, factor] : {std::pair{cure_in(metres), 1.0}, std::pair{cure_in(message), 0.3048}}) {
        run_gdal_line(line);
        CHECK(range(read(line.substr(line.rfind(' ') + 1)), true) == Approx(1007.0 * factor).epsilon(1e-6));
        std::filesystem::remove(line.substr(line.rfind(' ') + 1));
    }
}

TEST_CASE("The cure of feet knows the scale and the offset of stored numbers", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.type = GDT_Int16;
    spec.unit = "ft";
    spec.scale = 0.5, spec.offset = 4000.0, spec.nodata = -9999.0;
    spec.value = [](int column, int row) { return row == 0 ? -9999.0 : 100.0 + column; };
    make_raster(folder.path() / "dem.tif", spec);
    const std::string line = cure_in(user_error([&] { read(folder.path() / "dem.tif"); }));
    run_gdal_line(line);
    const Raster dem = read(line.substr(line.rfind(' ') + 1));
    CHECK(range(dem, false) == Approx(0.3048 * 4050.0).epsilon(1e-6));  // float32
    CHECK(range(dem, true) == Approx(0.3048 * 4053.5).epsilon(1e-6));
    CHECK(std::count_if(dem.values.begin(), dem.values.end(), [](double z) { return std::isnan(z); }) == 8);
}

TEST_CASE("A compound CRS in metres is accepted and only its map part is carried on", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.crs = "EPSG:32632+5773";
    make_raster(folder.path() / "dem.tif", spec);
    const Raster dem = read(folder.path() / "dem.tif");
    CHECK(contains(dem.crs_wkt, "PROJCRS[\"WGS 84 / UTM zone 32N\""));
    CHECK_FALSE(contains(dem.crs_wkt, "COMPOUNDCRS"));
    CHECK_FALSE(contains(dem.crs_wkt, "VERTCRS"));
}

TEST_CASE("A raster without a CRS is taken as local metres, and the log says so", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.crs = "";
    make_raster(folder.path() / "dem.tif", spec);
    std::vector<std::string> log;
    CHECK(GdalReader().read_dem(folder.path() / "dem.tif", {}, log).crs_wkt.empty());
    CHECK(any_contains(log, "local metres"));
}

TEST_CASE("A local CRS in feet is refused and cured, one in metres is taken", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.crs = "LOCAL_CS[\"mine\",UNIT[\"foot\",0.3048]]";
    make_raster(folder.path() / "dem.tif", spec);
    const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
    INFO(message);
    CHECK(contains(message, "its local CRS is in foot; expected metres"));
    std::string line = cure_in(message);
    line.erase(std::remove(line.begin(), line.end(), '\''), line.end());  // for a shell alone
    run_gdal_line(line);
    const GridGeometry cured = read(folder.path() / "dem_metres.tif").geometry;
    CHECK(cured.cell == Approx(3.048));
    CHECK(cured.x0 == Approx(500005.0 * 0.3048));
    spec.crs = "LOCAL_CS[\"mine\",UNIT[\"metre\",1]]";
    make_raster(folder.path() / "metres.tif", spec);
    CHECK(read(folder.path() / "metres.tif").geometry.cell == 10.0);
}

TEST_CASE("A real elevation model in degrees is refused with a way out that leads to a terrain", "[gdal]") {
    const auto file = shared_data("small_dems/jacksboro_fault_tennessee.tif");
    if (!file) return;
    const FreshFolder folder;
    const auto copy = folder.path() / "jacksboro.tif";
    std::filesystem::copy_file(*file, copy);
    const std::string message = user_error([&] { read(copy); });
    CHECK(contains(message, "gdalwarp -t_srs EPSG:32616 "));
    run_gdal_line(cure_in(message));
    const Raster dem = read(folder.path() / "jacksboro_utm.tif");
    CHECK(dem.geometry.cell > 70.0);  // 3 arc seconds: 92.5 m north, 74.4 m east at 36.6 degrees
    CHECK(dem.geometry.cell < 95.0);
    CHECK(range(dem, false) > 200.0);  // Tennessee, not a frame of 0 m
}

TEST_CASE("A map whose lengths are not those on the ground is refused and cured: Web Mercator", "[gdal]") {
    const FreshFolder folder;
    RasterSpec spec;
    spec.crs = "EPSG:3857";
    spec.columns = spec.rows = 40;
    // at 61.97 N, 7.27 E
    spec.transform = {809000.0, 20.0, 0.0, 8860000.0, 0.0, -20.0};
    spec.value = [](int column, int) { return 1000.0 + column; };
    make_raster(folder.path() / "dem.tif", spec);
    const std::string message = user_error([&] { read(folder.path() / "dem.tif"); });
    INFO(message);
    CHECK(contains(message, "EPSG:3857"));
    CHECK(contains(message, "in which 1 m on the ground is 2.1"));
    run_gdal_line(cure_in(message));
    const Raster dem = read(folder.path() / "dem_utm.tif");
    CHECK(contains(dem.crs_wkt, "UTM zone 32N"));
    CHECK(dem.geometry.cell == Approx(20.0 / 2.13).epsilon(0.01));  // 1 / cos(61.97 degrees) = 2.128
}

TEST_CASE("The scale of a map is that of its projection", "[gdal]") {
    const auto scale = [](const char* code, double x, double y) {
        const auto found = gdal::map_scale(gdal::crs_from_wkt(wkt_of(code)), {x, y});
        REQUIRE(found);
        return *found;
    };
    // UTM on its central meridian: 0.9996 by definition, alike in all directions; central differences over 200 m are
    // good to their square over the Earth's radius
    for (const double k : scale("EPSG:32632", 500000.0, 6000000.0)) CHECK(k == Approx(0.9996).epsilon(1e-8));
    // Mercator's sphere against the ellipsoid on the equator: 1 along it, a / M = 1 / (1 - e^2) across
    const auto mercator = scale("EPSG:3857", 0.0, 0.0);
    CHECK(mercator[0] == Approx(1.0).epsilon(1e-8));
    CHECK(mercator[1] == Approx(1.0 / (1.0 - 0.00669437999)).epsilon(1e-8));
    // An equal-area map far from its centre: what is drawn out one way is squeezed the other
    const auto equal_area = scale("EPSG:6933", 8000000.0, 6000000.0);
    CHECK(equal_area[0] * equal_area[1] == Approx(1.0).epsilon(1e-6));
    CHECK(equal_area[1] > 1.2);
}
