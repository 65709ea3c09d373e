// Surveys as a GIS has them: what is read, and what is refused with which sentence.
#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "catch.h"
#include "compare/overlap.h"
#include "fresh_folder.h"
#include "io/gdal_reader.h"
#include "io_gdal_make.h"
#include "run/folder/comparison.h"

using namespace frana;
namespace fs = std::filesystem;

namespace {

/// 400 x 300 m of UTM 32 N, 10 m pixels.
const GridGeometry terrain{40, 30, 600005.0, 5100005.0, 10.0};
const std::array<double, 4> extent = terrain.pixel_extent();

std::string ring(double x0, double y0, double x1, double y1) {
    return fmt::format("[[{0},{1}],[{2},{1}],[{2},{3}],[{0},{3}],[{0},{1}]]", x0, y0, x1, y1);
}

std::string collection(const std::vector<std::string>& geometries, const std::string& crs) {
    std::string features;
    for (const std::string& geometry : geometries)
        features += fmt::format(R"({}{{"type":"Feature","properties":{{}},"geometry":{}}})",
                                features.empty() ? "" : ",", geometry);
    const std::string member =
        crs.empty() ? "" : fmt::format(R"("crs":{{"type":"name","properties":{{"name":"{}"}}}},)", crs);
    return fmt::format(R"({{"type":"FeatureCollection",{}"features":[{}]}})", member, features);
}

std::string polygon(const std::string& rings) { return R"({"type":"Polygon","coordinates":[)" + rings + "]}"; }

const char* const utm = "urn:ogc:def:crs:EPSG::32632";

class Files {
public:
    fs::path text(const std::string& name, const std::string& content) const {
        write_text(folder_.path() / name, content);
        return folder_.path() / name;
    }
    fs::path operator/(const std::string& name) const { return folder_.path() / name; }

private:
    FreshFolder folder_;
};

Polygons read(const fs::path& file, const std::string& wkt, std::vector<std::string>& log) {
    return GdalReader().read_survey(file, extent, wkt, log);
}

std::string refusal(const fs::path& file) {
    return user_error([&] {
        std::vector<std::string> log;
        read(file, wkt_of("EPSG:32632"), log);
    });
}

/// One sentence in the house's form: what was found, what is expected, what to do.
bool is_one_sentence(const std::string& message) {
    return message.find('\n') == std::string::npos && contains(message, "; expected ") &&
           message.rfind(';') > message.find("; expected ") + 2;
}

/// 100 x 80 m pixels above 0 in the middle, with a hole of one pixel.
RasterSpec mask_spec() {
    RasterSpec spec;
    spec.columns = 20;
    spec.rows = 20;
    spec.transform = {600100.0, 10.0, 0.0, 5100250.0, 0.0, -10.0};
    spec.type = GDT_Byte;
    spec.value = [](int column, int row) {
        const bool hole = column == 8 && row == 8;
        return column >= 5 && column < 15 && row >= 5 && row < 13 && !hole ? 1.0 : 0.0;
    };
    return spec;
}

}  // namespace

TEST_CASE("A survey in degrees has the area on the map that it had before", "[survey]") {
    const Files files;
    // corners brought to longitude and latitude by PROJ itself
    OGRSpatialReference map, degrees;
    map.importFromEPSG(32632);
    degrees.importFromEPSG(4326);
    degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> back(OGRCreateCoordinateTransformation(&map, &degrees));
    std::vector<double> x = {600100, 600200, 600200, 600100}, y = {5100050, 5100050, 5100150, 5100150};
    REQUIRE(back->Transform(4, x.data(), y.data()));
    std::string corners;
    for (const std::size_t k : {0, 1, 2, 3, 0})
        corners += fmt::format("{}[{:.13f},{:.13f}]", corners.empty() ? "" : ",", x[k], y[k]);
    const fs::path file = files.text("degrees.geojson", collection({polygon("[" + corners + "]")}, ""));
    std::vector<std::string> log;
    const Polygons survey = read(file, wkt_of("EPSG:32632"), log);
    CHECK(any_contains(log, "reprojected from EPSG:4326"));
    // 13 digits of a degree are 1e-8 m; times four sides of 100 m
    CHECK(area_of(rings_of(survey)) == Approx(1e4).margin(4e-6));
    for (const Vec2& v : survey.parts.at(0).rings.at(0)) {
        CHECK(std::min(std::abs(v.x() - 600100), std::abs(v.x() - 600200)) < 1e-6);
        CHECK(std::min(std::abs(v.y() - 5100050), std::abs(v.y() - 5100150)) < 1e-6);
    }
}

TEST_CASE("Holes and parts of a survey remain, and overlapping polygons count once", "[survey]") {
    const Files files;
    std::vector<std::string> log;
    const fs::path file = files.text(
        "parts.geojson",
        collection({polygon(ring(600000, 5100000, 600100, 5100100) + "," + ring(600030, 5100030, 600070, 5100070)),
                    polygon(ring(600200, 5100000, 600220, 5100020))},
                   utm));
    const Polygons survey = read(file, wkt_of("EPSG:32632"), log);
    REQUIRE(survey.parts.size() == 2);
    CHECK(survey.parts[0].rings.size() == 2);
    CHECK(area_of(rings_of(survey)) == Approx(8400 + 400).epsilon(1e-12));
    CHECK(log.empty());

    const fs::path twice = files.text("twice.geojson", collection({polygon(ring(600000, 5100000, 600100, 5100100)),
                                                                   polygon(ring(600050, 5100000, 600150, 5100100))},
                                                                  utm));
    CHECK(area_of(rings_of(read(twice, wkt_of("EPSG:32632"), log))) == Approx(15000).epsilon(1e-12));
    CHECK(any_contains(log, "overlap by 5000 m2"));

    // A side that two polygons share is no outline: however a surveyor cuts the whole, its outline is that of the whole.
    std::vector<std::string> strips;
    for (int n = 0; n < 10; ++n) strips.push_back(polygon(ring(600000 + 10 * n, 5100000, 600010 + 10 * n, 5100100)));
    const Polygons whole = read(files.text("strips.geojson", collection(strips, utm)), wkt_of("EPSG:32632"), log);
    CHECK(any_contains(log, "10 polygons, some of which share sides, become 1"));
    double length = 0.0;
    for (const auto& outline : rings_of(whole))
        for (std::size_t k = 0; k < outline.size(); ++k)
            length += (outline[(k + 1) % outline.size()] - outline[k]).norm();
    CHECK(length == Approx(400.0).epsilon(1e-9));
}

TEST_CASE("A raster above 0 is a survey too, hole and all, in its own CRS or another", "[survey]") {
    const Files files;
    make_raster(files / "mask.tif", mask_spec());
    std::vector<std::string> log;
    const Polygons survey = read(files / "mask.tif", wkt_of("EPSG:32632"), log);
    REQUIRE(survey.parts.size() == 1);
    CHECK(survey.parts[0].rings.size() == 2);
    CHECK(area_of(rings_of(survey)) == Approx(80 * 100 - 100).epsilon(1e-12));

    // UTM 33 of the same place: PROJ brings the corners back, and scale on the map differs by the factor of areas
    const std::string utm33 = wkt_of("EPSG:32633");
    const Polygons elsewhere = [&] {
        OGRSpatialReference from, to;
        from.importFromEPSG(32632);
        to.importFromEPSG(32633);
        const std::unique_ptr<OGRCoordinateTransformation> forth(OGRCreateCoordinateTransformation(&from, &to));
        std::array<double, 4> there{};
        REQUIRE(forth->TransformBounds(extent[0], extent[1], extent[2], extent[3], &there[0], &there[1], &there[2],
                                       &there[3], 5));
        return GdalReader().read_survey(files / "mask.tif", there, utm33, log);
    }();
    CHECK(any_contains(log, "to EPSG:32633"));
    // k = 0.9996 (1 + (E - 500 km)^2 / (2 R^2)) is 0.99972 at E = 600 km in zone 32 and about 1.0013 at 136 km in
    // zone 33: areas grow by their ratio squared, 1.003
    CHECK(area_of(rings_of(elsewhere)) == Approx(7900.0 * 1.003).epsilon(1e-3));
}

TEST_CASE("A survey that reaches outside the terrain remains whole", "[survey]") {
    const Files files;
    std::vector<std::string> log;
    const fs::path file =
        files.text("wide.geojson", collection({polygon(ring(599900, 5099900, 600100, 5100100))}, utm));
    const Polygons survey = read(file, wkt_of("EPSG:32632"), log);
    const Overlap areas = overlap(Raster::filled(terrain, 1.0), 0.1, rings_of(survey));
    CHECK(areas.hit == Approx(1e4).epsilon(1e-12));
    CHECK(areas.missed_outside == Approx(3e4).epsilon(1e-12));
}

TEST_CASE("Surveys that say nothing are refused with a sentence each", "[survey]") {
    const Files files;
    const std::string square = polygon(ring(600000, 5100000, 600100, 5100100));
    const auto check = [&](const fs::path& file, const std::string& found, const std::string& way_out) {
        const std::string message = refusal(file);
        CAPTURE(message);
        CHECK(contains(message, file.string() + ": "));
        CHECK(contains(message, found));
        CHECK(contains(message, way_out));
        CHECK(is_one_sentence(message));
    };
    check(files.text("local.geojson", collection({square}, "")), "has no CRS of its own", "ogr2ogr -a_srs EPSG:32632");
    check(files.text("line.geojson",
                     collection({R"({"type":"LineString","coordinates":[[600000,5100000],[600100,5100100]]})"}, utm)),
          "holds 1 line only", "draw the outline as a polygon");
    check(files.text("empty.geojson", collection({}, utm)), "holds no features", "draw the outline as a polygon");
    check(files.text("away.geojson", collection({polygon(ring(700000, 5100000, 700100, 5100100))}, utm)),
          "does not touch the terrain", "check its coordinates and its CRS");
    check(files / "missing.geojson", "no such file", "correct the name");
    check(files.text("junk.geojson", "this is no GeoJSON"), "cannot be read", "export it again");

    RasterSpec spec = mask_spec();
    spec.crs.clear();
    make_raster(files / "nowhere.tif", spec);
    check(files / "nowhere.tif", "has no CRS", "gdal_translate -a_srs EPSG:32632");
    spec = mask_spec();
    spec.value = [](int, int) { return 0.0; };
    make_raster(files / "zero.tif", spec);
    check(files / "zero.tif", "has no pixel above 0", "gdalinfo");

    // without a CRS of the terrain there is nothing that a survey would have to agree with
    std::vector<std::string> log;
    CHECK(read(files / "local.geojson", "", log).parts.size() == 1);
}

TEST_CASE("The line that a refusal gives makes the survey readable", "[survey]") {
    const Files files;
    RasterSpec spec = mask_spec();
    spec.crs.clear();
    make_raster(files / "nowhere.tif", spec);
    run_gdal_line(cure_in(refusal(files / "nowhere.tif")));
    std::vector<std::string> log;
    CHECK(area_of(rings_of(read(files / "nowhere_crs.tif", wkt_of("EPSG:32632"), log))) == Approx(7900).epsilon(1e-12));
}

TEST_CASE("Scores have digits down to a tenth of a cell, and areas differ by one number everywhere", "[survey]") {
    Comparison c;
    c.cell = 0.002;
    c.trace.runout = 0.31236, c.surveyed_runout = 0.3;
    c.trace.areas.hit = 80.0, c.trace.areas.missed = 20.0;
    CHECK(contains(comparison_section(c), "| runout, simulated [m] | 0.3124 |"));
    CHECK(contains(comparison_section(c), "| runout difference [m] | +0.0124 |"));
    CHECK(contains(comparison_line(c), "runout +0.012 m"));
    CHECK(contains(comparison_section(c), "| area difference [%] | 20.0 |"));
    CHECK(contains(comparison_json(c), "\"area_difference_percent\": 20.0,"));
    c.cell = 2.5;
    CHECK(contains(comparison_section(c), "| runout, simulated [m] | 0.3 |"));
    CHECK(contains(comparison_line(c), "runout +0 m"));
}

TEST_CASE("A surveyed deposit conserves its volume beyond the terrain, on the run's pixels", "[survey]") {
    const Files files;
    RasterSpec spec;
    spec.columns = 20;
    spec.rows = 20;
    spec.transform = {599900.0, 10.0, 0.0, 5100100.0, 0.0, -10.0};
    spec.value = [](int, int) { return 1.5; };
    make_raster(files / "deposit.tif", spec);
    std::vector<std::string> log;
    const Raster deposit = GdalReader().read_deposit(files / "deposit.tif", terrain, wkt_of("EPSG:32632"), log);
    CHECK(deposit.geometry.nx == 50);
    CHECK(deposit.geometry.ny == 40);
    CHECK(deposit.geometry.x0 == terrain.x0 - 100.0);
    double volume = 0.0;
    for (const double h : deposit.values) volume += std::isnan(h) ? 0.0 : h * 100.0;
    CHECK(volume == Approx(400 * 100 * 1.5).epsilon(1e-12));
    spec.unit = "ft";
    make_raster(files / "feet.tif", spec);
    CHECK(
        contains(user_error([&] { GdalReader().read_deposit(files / "feet.tif", terrain, wkt_of("EPSG:32632"), log); }),
                 "its values are declared in ft; expected metres"));
    spec.unit.clear();
    spec.crs.clear();
    make_raster(files / "nowhere.tif", spec);
    spec.crs = "EPSG:32632";
    spec.transform[0] += 2000.0;
    make_raster(files / "beside.tif", spec);
    CHECK(contains(
        user_error([&] { GdalReader().read_deposit(files / "beside.tif", terrain, wkt_of("EPSG:32632"), log); }),
        "does not touch the terrain's"));
    const std::string message =
        user_error([&] { GdalReader().read_deposit(files / "nowhere.tif", terrain, wkt_of("EPSG:32632"), log); });
    CHECK(contains(message, "has no CRS"));
    CHECK(is_one_sentence(message));
}

// Beyond the area of its CRS a raster lay 190 m elsewhere as a footprint than as a deposit, which GDAL warps.
TEST_CASE("Footprint and deposit of a raster lie at one place, also beyond the area of their CRS", "[survey]") {
    const Files files;
    RasterSpec spec;
    spec.columns = 40;
    spec.rows = 20;
    spec.transform = {2898030.0, 10.0, 0.0, 1241080.0, 0.0, -10.0};  // of Switzerland, at Innsbruck
    spec.crs = "EPSG:2056";
    spec.value = [](int, int) { return 1.0; };
    make_raster(files / "swiss.tif", spec);
    const GridGeometry grid{100, 80, 679700.0, 5235700.0, 10.0};
    const std::string utm32 = wkt_of("EPSG:32632");
    std::vector<std::string> log;
    const Polygons footprint = GdalReader().read_survey(files / "swiss.tif", grid.pixel_extent(), utm32, log);
    REQUIRE(footprint.parts.size() == 1);
    const auto& ring = footprint.parts[0].rings[0];
    double low = 1e9, high = -1e9, south = 1e9, north = -1e9;
    for (const Vec2& corner : ring) {
        low = std::min(low, corner.x()), high = std::max(high, corner.x());
        south = std::min(south, corner.y()), north = std::max(north, corner.y());
    }
    const Raster deposit = GdalReader().read_deposit(files / "swiss.tif", grid, utm32, log);
    Vec2 middle(0, 0);
    double count = 0.0;
    for (Index j = 0; j < deposit.geometry.ny; ++j)
        for (Index i = 0; i < deposit.geometry.nx; ++i)
            if (deposit.at(i, j) > 0.5) middle += Vec2(deposit.geometry.x(i), deposit.geometry.y(j)), count += 1.0;
    REQUIRE(count > 0.0);
    middle /= count;
    CHECK(std::abs(middle.x() - 0.5 * (low + high)) < grid.cell);
    CHECK(std::abs(middle.y() - 0.5 * (south + north)) < grid.cell);
}

TEST_CASE("A deposit is what lies at the end without free water, and that the rest counts it is said", "[survey]") {
    const GridGeometry grid{30, 20, 0.0, 0.0, 5.0};
    const Raster depth = Raster::filled(grid, 3.0);
    Raster water = Raster::filled(grid, 2.0);
    water.at(3, 3) = Raster::nodata, water.at(4, 4) = 3.0, water.at(5, 5) = 3.0 + 1e-15;
    std::vector<ProductRaster> rasters = {{"peak_depth", "m", "", depth}, {"final_depth", "m", "", depth}};
    CHECK(solids_at_end(rasters)->at(4, 4) == 3.0);
    Survey survey;
    survey.footprint.parts = {Polygon{{{{10, 10}, {60, 10}, {60, 60}, {10, 60}}}}};
    survey.deposit = Raster::filled(grid, 1.0);
    rasters.push_back({"final_water_depth", "m", "", water});
    const Raster solids = solids_at_end(rasters).value();
    CHECK((solids.at(0, 0) == 1.0 && solids.at(3, 3) == 3.0 && solids.at(4, 4) == 0.0 && solids.at(5, 5) == 0.0));
    const Comparison found = compare_rasters(rasters, nullptr, 0.1, survey);
    CHECK(found.deposit->simulated_volume == Approx(25.0 * (597 + 3)).epsilon(1e-12));
    CHECK(found.remarks.back().find("free water counts among everything ever covered") == 0);
    CHECK_FALSE(solids_at_end({}).has_value());
}

TEST_CASE("A raster of depths whose films count too is told, with the footprint of its run", "[survey]") {
    const Files files;
    RasterSpec spec;
    spec.columns = 40, spec.rows = 30;
    spec.transform = {600000.0, 10.0, 0.0, 5100300.0, 0.0, -10.0};
    const auto said = [&](const std::string& name) {
        fs::create_directories((files / name).parent_path());
        make_raster(files / name, spec);
        std::vector<std::string> log;
        read(files / name, wkt_of("EPSG:32632"), log);
        return log;
    };
    spec.value = [](int column, int) { return column < 30 ? 2.0 : column < 35 ? 0.05 : 0.0; };
    CHECK_FALSE(any_contains(said("classes.tif"), "found values"));
    spec.value = [](int column, int row) {
        return column < 30 ? 0.5 + 0.01 * row : column < 35 ? 1e-3 * (row + 1) : 0.0;
    };
    const std::string told = "found values from 0.001 to 0.79 above 0, 14.3 % of them below 0.1, and all of them count";
    CHECK(any_contains(said("depth.tif"), told));
    CHECK(any_contains(said("depth.tif"), "set thin ones to 0"));
    files.text("footprint.geojson", "{}");
    CHECK(any_contains(said("rasters/peak_depth.tif"), told));
    CHECK(any_contains(said("rasters/peak_depth.tif"), (files / "footprint.geojson").string() + " instead"));
    spec.value = [](int column, int row) { return column < 30 ? 0.5 + 0.01 * row : 0.0; };
    CHECK_FALSE(any_contains(said("thick.tif"), "found values"));
}

TEST_CASE("Elevations are no surveyed footprint", "[survey]") {
    const Files files;
    RasterSpec spec;
    spec.columns = 40, spec.rows = 30;
    spec.transform = {600000.0, 10.0, 0.0, 5100300.0, 0.0, -10.0};
    spec.value = [](int column, int row) { return 300.0 - column - row; };
    make_raster(files / "dem.tif", spec);
    CHECK(contains(refusal(files / "dem.tif"),
                   "found values of up to 300, on 100 % of the pixels more than 100; expected "
                   "a surveyed extent, above 0 where the flow was, not elevations"));
    spec.value = [](int column, int row) { return 80.0 - column - 0.5 * row; };
    make_raster(files / "low.tif", spec);
    std::vector<std::string> log;
    read(files / "low.tif", wkt_of("EPSG:32632"), log);
    CHECK(any_contains(log, "low.tif: found values above 0, up to 80, in all of its pixels"));
    log.clear();
    spec.value = [](int column, int) { return column < 30 ? 1.0 : 2.0; };  // classes, of which none is 0
    make_raster(files / "class.tif", spec);
    read(files / "class.tif", wkt_of("EPSG:32632"), log);
    CHECK(any_contains(log, "class.tif: found values above 0, up to 2, in all of its pixels"));
    log.clear();
    spec.value = [](int column, int) { return column < 30 ? 255.0 : 0.0; };  // a mask of a byte
    make_raster(files / "mask.tif", spec);
    read(files / "mask.tif", wkt_of("EPSG:32632"), log);
    spec.value = [](int column, int row) { return column < 30 ? 0.1 * row : 0.0; };  // depths
    make_raster(files / "depth.tif", spec);
    read(files / "depth.tif", wkt_of("EPSG:32632"), log);
    spec.nodata = -9999.0;  // as a run writes its pressures: nothing where the flow never came
    spec.value = [](int column, int row) { return column < 30 ? 1000.0 * (row + 1) : -9999.0; };
    make_raster(files / "pressure.tif", spec);
    read(files / "pressure.tif", wkt_of("EPSG:32632"), log);
    CHECK_FALSE(any_contains(log, "elevations"));
}
