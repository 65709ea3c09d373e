// Releases that enter later, by the program: record, report, table, resume.
#include <nlohmann/json.hpp>

#include "catch.h"
#include "io/gdal_writer.h"
#include "observe/table.h"
#include "plane_case.h"
#include "read_layer.h"
#include "read_raster.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const char* const kBed = "[material.bed]\nlaw = \"voellmy\"\nmu = 0.05\nxi = 400\n[output]\nevery = 2\n";

std::string release(const std::string& name, const std::string& rest) {
    return "[[release]]\noutline = \"" + name + "\"\ndepth = 1.5\n" + rest;
}

std::string rectangle_text(double x0, double y0, double x1, double y1) {
    return fmt::format(R"({{"type": "Feature", "properties": {{}}, "geometry": {{"type": "Polygon", "coordinates":
                       [[[{0}, {1}], [{2}, {1}], [{2}, {3}], [{0}, {3}], [{0}, {1}]]]}}}})",
                       x0, y0, x1, y1);
}

/// Down the plane from the release of the plane case lies another, which is hit, and beside it one with a time, and one that
/// nothing reaches.
struct Releases : PlaneCase {
    Releases() {
        write_text(folder() / "below.geojson", rectangle_text(70, 30, 90, 70));
        write_text(folder() / "timed.geojson", rectangle_text(100, 40, 120, 60));
        write_text(folder() / "never.geojson", rectangle_text(10, 80, 15, 85));
        write_text(file(), "[terrain]\ndem = \"dem.asc\"\n" + release("release.geojson", "") +
                               release("below.geojson", "when_hit = true\n") + release("timed.geojson", "at = 3.3\n") +
                               release("never.geojson", "when_hit = true\n") + "[time]\nend = 9\n" + kBed);
    }
};

Json record_of(const fs::path& run_dir) { return Json::parse(text_of(run_dir / "run.json")); }

}  // namespace

TEST_CASE("The record, the report and the table tell when late releases entered, and how much", "[program][late]") {
    const Releases plane;
    const Outcome check = plane.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("enters when the flow reaches it") && Contains("enters at 3.3 s"));
    const Outcome particles = plane.frana("particles CASE --out " + (plane.folder() / "p.csv").string());
    CHECK(particles.code == 0);
    const std::string rows = text_of(plane.folder() / "p.csv");
    const auto written = std::count(rows.begin(), rows.end(), '\n') - 1;
    CHECK_THAT(particles.out, Contains(fmt::format("\n{} of ", written)) &&
                                  Contains("p.csv, those at the start; the ") &&
                                  Contains("that enter later are not in it\n"));
    const fs::path dir = plane.folder() / "out";
    CHECK(plane.frana("run CASE --quiet --out " + dir.string()).code == 0);
    const Json json = record_of(dir), late = json["late_releases"];
    REQUIRE(late.size() == 3);
    CHECK(late[0]["name"] == "release.1 (below.geojson)");
    CHECK(late[0]["when_hit"] == true);
    CHECK(late[0]["at"].is_null());
    CHECK(late[0]["volume"].get<double>() == Approx(1200.0).epsilon(1e-12));
    const double hit = late[0]["entered"].get<double>();
    CHECK(hit > 0.5);
    CHECK(late[1]["at"] == 3.3);
    CHECK(late[1]["entered"] == 3.3);
    CHECK(late[2]["entered"].is_null());
    CHECK(json["release_volume"].get<double>() == Approx(1800.0).epsilon(1e-12));
    CHECK(json["budgets"]["mass"]["came_in"].get<double>() == Approx(1000.0 * 1800.0).epsilon(1e-12));
    CHECK(std::abs(json["budgets"]["mass"]["relative_error"].get<double>()) < 1e-13);
    const Table table = read_table(dir / "history.csv");
    const std::vector<double> t = table.column("t"), in = table.column("mass_in");
    for (std::size_t n = 0; n < t.size(); ++n) {
        const double came = (t[n] >= hit ? 1.2e6 : 0.0) + (t[n] >= 3.3 ? 6e5 : 0.0);
        CHECK(in[n] == Approx(came).epsilon(1e-12));
    }
    const std::string report = text_of(dir / "report.md");
    for (const char* text :
         {"| entered later: release.1 (below.geojson) | 1200 m3 at t = ", ", when the flow reached it |",
          "| entered later: release.2 (timed.geojson) | 600 m3 at t = 3.3 s |",
          "37.5 m3 did not: the flow did not reach it",
          "release.3 (never.geojson): its 37.5 m3 did not enter: no flow deeper than 0.1 m"})
        CHECK_THAT(report, Contains(text));
}

TEST_CASE("A GIS gets the outlines of all releases, with what entered and when", "[program][late][gis]") {
    const Releases plane;
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --out " + dir.string()).code == 0);
    const Json json = record_of(dir);
    CHECK(json["release_volume_later"].get<double>() == Approx(1800.0).epsilon(1e-12));
    CHECK_THAT(text_of(dir / "report.md"), Contains("| release volume at the start | 1800 m3 |") &&
                                               Contains("| release volume, with what entered later | 3600 m3 |"));
    const Layer layer(dir / "results.gpkg", "release");
    std::vector<OGRFeatureUniquePtr> outlines;
    for (OGRFeatureUniquePtr& feature : layer.get()) outlines.push_back(std::move(feature));
    REQUIRE(outlines.size() == 4);
    const double areas[] = {1200.0, 800.0, 400.0, 25.0}, volumes[] = {1800.0, 1200.0, 600.0, 37.5};
    for (int n = 0; n < 4; ++n) {
        OGRFeature& outline = *outlines[static_cast<std::size_t>(n)];
        CAPTURE(n);
        CHECK(outline.GetFieldAsInteger("release") == n);
        CHECK(outline.GetGeometryRef()->toPolygon()->get_Area() == Approx(areas[n]).epsilon(1e-12));
        CHECK(outline.GetFieldAsDouble("area_m2") == Approx(areas[n]).epsilon(1e-12));
        CHECK(outline.GetFieldAsDouble("volume_m3") == Approx(volumes[n]).epsilon(1e-12));
        const int entered = outline.GetFieldIndex("entered_s");
        CHECK((outline.IsFieldSetAndNotNull(entered) != 0) == (n != 3));
    }
    CHECK(outlines[0]->GetFieldAsDouble("entered_s") == 0.0);
    CHECK(outlines[1]->GetFieldAsDouble("entered_s") == json["late_releases"][0]["entered"].get<double>());
    CHECK(outlines[2]->GetFieldAsDouble("entered_s") == 3.3);
}

TEST_CASE("A release of several polygons is one row of a GIS, with the volume and the area of all",
          "[program][late][gis]") {
    const Releases plane;
    write_text(plane.folder() / "timed.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [
                  [[[100, 40], [110, 40], [110, 60], [100, 60], [100, 40]]],
                  [[[112, 40], [120, 40], [120, 60], [112, 60], [112, 40]]]]}})");
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --out " + dir.string()).code == 0);
    const Layer layer(dir / "results.gpkg", "release");
    std::vector<OGRFeatureUniquePtr> rows;
    for (OGRFeatureUniquePtr& feature : layer.get()) rows.push_back(std::move(feature));
    REQUIRE(rows.size() == 4);
    const int parts[] = {1, 1, 2, 1};
    const double areas[] = {1200.0, 800.0, 360.0, 25.0};
    for (int n = 0; n < 4; ++n) {
        OGRFeature& row = *rows[static_cast<std::size_t>(n)];
        CAPTURE(n);
        CHECK(row.GetFieldAsInteger("release") == n);
        CHECK(row.GetGeometryRef()->toMultiPolygon()->getNumGeometries() == parts[n]);
        CHECK(row.GetFieldAsDouble("area_m2") == Approx(areas[n]).epsilon(1e-12));
        CHECK(row.GetFieldAsDouble("volume_m3") == Approx(1.5 * areas[n]).epsilon(1e-12));
    }
}

// The project of QGIS had no place for several polygons as the first row, and the run broke off.
TEST_CASE("A run whose only release is of several polygons ends with all of its files", "[program][late][gis]") {
    const PlaneCase plane;
    write_text(plane.folder() / "release.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [
                  [[[30, 40], [40, 40], [40, 60], [30, 60], [30, 40]]],
                  [[[42, 40], [50, 40], [50, 60], [42, 60], [42, 40]]]]}})");
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --out " + dir.string()).code == 0);
    CHECK(fs::exists(dir / "run.qgz"));
    CHECK(fs::exists(dir / "report.md"));
    CHECK(Layer(dir / "results.gpkg", "release").get().GetFeatureCount() == 1);
}

TEST_CASE("Ground under releases is left out of a comparison with two surveys, under later ones too",
          "[program][late][compare]") {
    const Releases plane;
    const bool by_mask = GENERATE(false, true);
    CAPTURE(by_mask);
    std::string text = text_of(plane.file()) + "[deposition]\nlaw = \"rest\"\n";
    if (by_mask) {
        const std::string outline = "outline = \"timed.geojson\"";
        text.replace(text.find(outline), outline.size(), "mask = \"timed.tif\"");
        write_geotiff(plane.folder() / "timed.tif", Raster::filled({4, 4, 102.5, 42.5, 5.0}, 1.0), "1",
                      "where it lies");
    }
    write_text(plane.file(), text);
    write_text(plane.folder() / "footprint.geojson", rectangle_text(20, 30, 140, 70));
    write_geotiff(plane.folder() / "dod.tif", Raster::filled({30, 20, 2.5, 2.5, 5.0}, -0.5), "m", "after less before");
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane
                .frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --set survey.footprint=footprint.geojson "
                       "--set survey.bed_change=dod.tif --out " +
                       dir.string())
                .code == 0);
    const Raster arrival = raster_in(dir / "rasters" / "arrival_time.tif");
    double released = 0.0;  // below.geojson and timed.geojson entered
    for (Index j = 0; j < 20; ++j)
        for (Index i = 0; i < 30; ++i) {
            const double x = arrival.geometry.x(i), y = arrival.geometry.y(j);
            const bool later = (x > 70 && x < 90 && y > 30 && y < 70) || (x > 100 && x < 120 && y > 40 && y < 60);
            released += later || arrival.at(i, j) == 0.0 ? 25.0 : 0.0;
        }
    const auto in_release = [&] {
        return Json::parse(text_of(dir / "compare.json"))["bed_change"]["surveyed_in_release"]["eroded"].get<double>();
    };
    CHECK(in_release() == Approx(0.5 * released).epsilon(1e-12));
    const std::string again = "compare " + dir.string() + " --survey footprint.geojson --bed-change dod.tif";
    REQUIRE(plane.frana(again).code == 0);
    CHECK(in_release() == Approx(0.5 * released).epsilon(1e-12));
    fs::remove(plane.folder() / (by_mask ? "timed.tif" : "timed.geojson"));
    const Outcome gone = plane.frana(again);
    CHECK(gone.code == 0);
    CHECK_THAT(gone.err, Contains("ground under later releases is compared as well: "));
}

TEST_CASE("A run that is stopped between its late releases goes on with the same bits", "[program][late]") {
    const Releases plane;
    const std::string straight = (plane.folder() / "straight").string(), parts = (plane.folder() / "parts").string();
    const std::string run = "run CASE --quiet --set output.formats=[] ";
    CHECK(plane.frana(run + "--threads 1 --out " + straight).code == 0);
    CHECK(plane.frana(run + "--until 3.1 --threads 2 --out " + parts).code == 0);
    CHECK(record_of(parts)["late_releases"][1]["entered"].is_null());
    CHECK(plane.frana(run + "--resume --threads 2 --out " + parts).code == 0);
    CHECK(text_of(fs::path(parts) / "history.csv") == text_of(fs::path(straight) / "history.csv"));
    CHECK(record_of(parts)["late_releases"] == record_of(straight)["late_releases"]);
}

TEST_CASE("The bed at the start is that without the releases of the start that stood in it", "[program][late][scar]") {
    const Releases plane;
    write_text(plane.file(), "[terrain]\ndem = \"dem.asc\"\n" + release("release.geojson", "included_in_dem = true\n") +
                                 release("timed.geojson", "at = 0.5\nincluded_in_dem = true\n") + "[time]\nend = 1\n" +
                                 kBed);
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --out " + dir.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Raster start = raster_of(dir, "elevation.tif"), change = raster_of(dir, "bed_change.tif"),
                 dem = raster_in(plane.folder() / "dem.asc");
    CHECK(off_its_change(start, dir) < 1e-4);  // single precision
    const auto deepest = [](const Raster& a, const Raster* less) {
        double most = 0.0;
        for (Index j = 0; j < a.geometry.ny; ++j)
            for (Index i = 0; i < a.geometry.nx; ++i) {
                const double value = a.at(i, j) - (less ? less->at(i, j) : 0.0);
                if (a.geometry.x(i) < 60.0) most = std::min(most, value);  // the first release
            }
        return most;
    };
    REQUIRE(dem.geometry.nx == start.geometry.nx);
    CHECK(deepest(start, &dem) == Approx(-1.5).epsilon(1e-4));
    CHECK(deepest(change, nullptr) == 0.0);
    CHECK(*std::min_element(change.values.begin(), change.values.end()) == Approx(-1.5).epsilon(1e-4));
}

TEST_CASE("A run shows the bed that fell when a release entered that stood in it", "[program][late][scar]") {
    PlaneCase plane;
    write_text(plane.folder() / "below.geojson", rectangle_text(70, 30, 90, 70));
    const auto write = [&](const std::string& more) {
        write_text(plane.file(), "[terrain]\ndem = \"dem.asc\"\n" +
                                     release("below.geojson", "included_in_dem = true\n" + more) + "[time]\nend = 4\n" +
                                     kBed);
    };
    write("at = 2.0\n");
    const Outcome check = plane.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("enters at 2 s, and is cut out of the bed then") &&
                              Contains("release.0: its 1200 m3 are cut out of the bed when it enters"));
    const Outcome particles = plane.frana("particles CASE --out " + (plane.folder() / "p.csv").string());
    CAPTURE(particles.out);
    CHECK_THAT(particles.out, Contains("that enter later are not in it"));
    const fs::path later = plane.folder() / "later", now = plane.folder() / "now";
    REQUIRE(plane.frana("run CASE --quiet --out " + later.string()).code == 0);
    const Json json = record_of(later);
    CHECK(json["late_releases"][0]["included_in_dem"] == true);
    CHECK(std::abs(json["budgets"]["mass"]["relative_error"].get<double>()) < 1e-13);
    CHECK_THAT(text_of(later / "report.md"), Contains("1200 m3 at t = 2 s, cut out of the bed |"));
    write("");
    REQUIRE(plane.frana("run CASE --quiet --set time.end=2 --out " + now.string()).code == 0);
    const Raster at_start = raster_in(later / "rasters" / "elevation.tif"),
                 at_end = raster_in(later / "rasters" / "final_elevation.tif"),
                 change = raster_in(later / "rasters" / "bed_change.tif"),
                 cut = raster_in(now / "rasters" / "elevation.tif"),
                 depth = raster_in(later / "rasters" / "final_depth.tif"),
                 expected = raster_in(now / "rasters" / "final_depth.tif");
    REQUIRE(at_end.values.size() == cut.values.size());
    double fallen = 0.0, most = 0.0;
    for (std::size_t k = 0; k < cut.values.size(); ++k) {
        fallen = std::max(fallen, at_start.values[k] - at_end.values[k]);
        most = std::max(most, std::abs(at_end.values[k] - cut.values[k]));
        const double changed = std::isnan(change.values[k]) ? 0.0 : change.values[k];  // where nothing came
        CHECK(at_start.values[k] + changed == Approx(at_end.values[k]).margin(1e-5));
        if (!std::isnan(depth.values[k]) || !std::isnan(expected.values[k]))
            CHECK(depth.values[k] == Approx(expected.values[k]).margin(1e-5));
    }
    CHECK(fallen == Approx(1.5).epsilon(1e-6));
    CHECK(most < 1e-5);  // rasters are float32, of elevations up to 100 m
}
