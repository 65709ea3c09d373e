// Barriers as polygons for a GIS: attributes of the input, and what the run did to them, read back by GDAL.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "base/constants.h"
#include "catch.h"
#include "io/gdal_features.h"
#include "io/gdal_reader.h"
#include "io_figures_scene.h"
#include "observe/barriers.h"
#include "program.h"
#include "read_layer.h"
#include "read_raster.h"
#include "run/folder/barrier_hits.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_record.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

std::string square(double x, double y, double size, const std::string& properties) {
    const auto p = [](double a, double b) { return "[" + std::to_string(a) + "," + std::to_string(b) + "]"; };
    return R"({"type":"Feature","properties":{)" + properties + R"(},"geometry":{"type":"Polygon","coordinates":[[)" +
           p(x, y) + "," + p(x + size, y) + "," + p(x + size, y + size) + "," + p(x, y + size) + "," + p(x, y) + "]]}}";
}

std::string collection(const std::string& features) {
    return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

/// A slope with a release above three houses: the first below it, the second far to the side, the third below as well.
class Village {
public:
    Village() {
        std::string dem = "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 20; ++row)
            for (int column = 0; column < 30; ++column)
                dem += std::to_string(200.0 - 3.0 * column) + (column < 29 ? " " : "\n");
        write_text(path() / "dem.asc", dem);
        write_text(path() / "release.geojson", collection(square(20, 40, 20, "")));
        write_text(path() / "houses.geojson",
                   collection(square(75, 42, 8, R"("use":"school","persons":120,"value":1.5,"hit_s":9)") + "," +
                              square(130, 5, 8, R"("use":"shed","persons":0)") + "," +
                              square(60, 55, 8, R"("use":"house","value":2)")));
        write_text(path() / "case.toml",
                   "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 3\n"
                   "[material]\ndensity = 1500\nbed.law = \"coulomb\"\nbed.mu = 0.3\n[time]\nend = 6\n[output]\n"
                   "formats = [\"geotiff\"]\n[[barrier]]\nname = \"house\"\noutline = \"houses.geojson\"\nheight = 6\n"
                   "each = true\n");
    }
    const fs::path& path() const { return folder_.path(); }

private:
    FreshFolder folder_;
};

}  // namespace

TEST_CASE("Barriers keep the attributes of their features, with what hit them", "[barriers][results]") {
    const Village village;
    const Outcome run = call_frana(village.path(), "run case.toml --out run --quiet");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Layer layer(village.path() / "run" / "results.gpkg", "barriers");
    REQUIRE(layer.get().GetFeatureCount() == 3);
    const auto type = [&](const char* name) {
        const OGRFeatureDefn& definition = *layer.get().GetLayerDefn();
        const int index = definition.GetFieldIndex(name);
        REQUIRE(index >= 0);
        return definition.GetFieldDefn(index)->GetType();
    };
    CHECK((type("use") == OFTString && type("persons") == OFTInteger64 && type("value") == OFTReal));
    CHECK((type("hit_s") == OFTReal && type("hit_s_input") == OFTInteger64));
    const auto known = [](OGRFeature& f, const char* name) {
        return f.IsFieldSetAndNotNull(f.GetFieldIndex(name)) != 0;
    };
    std::vector<OGRFeatureUniquePtr> houses;
    for (OGRFeatureUniquePtr& feature : layer.get()) houses.push_back(std::move(feature));
    CHECK(std::string(houses[0]->GetFieldAsString("use")) == "school");
    CHECK(houses[0]->GetFieldAsInteger64("persons") == 120);
    CHECK(houses[0]->GetFieldAsInteger64("hit_s_input") == 9);
    CHECK(std::string(houses[0]->GetFieldAsString("barrier")) == "house_1");
    CHECK(std::string(houses[2]->GetFieldAsString("barrier")) == "house_3");
    CHECK(houses[0]->GetGeometryRef()->toPolygon()->get_Area() == Approx(64.0));
    CHECK(std::string(houses[1]->GetFieldAsString("use")) == "shed");
    for (const char* name : {"peak_dynamic_pressure_Pa", "peak_depth_m", "hit_s", "peak_force_N"})
        CHECK_FALSE(known(*houses[1], name));  // never reached
    for (const std::size_t n : {0, 2}) {
        CAPTURE(n);
        CHECK_FALSE(known(*houses[n], "peak_force_N"));  // particles take a barrier for ground
        CHECK(houses[n]->GetFieldAsDouble("peak_depth_m") > 0.1);
        CHECK(houses[n]->GetFieldAsDouble("peak_dynamic_pressure_Pa") > 1500.0);  // 1 m/s
    }
    // The third is 15 m nearer to the release.
    CHECK(houses[2]->GetFieldAsDouble("hit_s") < houses[0]->GetFieldAsDouble("hit_s"));
    CHECK_FALSE(known(*houses[2], "persons"));
}

TEST_CASE("The report has the time of contact of houses that particles reach, and a table has all",
          "[barriers][results]") {
    const Village village;
    REQUIRE(call_frana(village.path(), "run case.toml --out run --quiet").code == 0);
    const std::string report = text_of(village.path() / "run" / "report.md");
    CHECK_THAT(report, Contains("| house_2 | none | - | - |") && Contains("First contact is when the depth at a face"));
    CHECK_THAT(report, !Contains("| house_1 | none") && !Contains("| house_3 | none"));
    const std::string table = text_of(village.path() / "run" / "barriers.csv");
    CHECK_THAT(
        table,
        Contains("barrier,first_contact [s],peak_force [N],peak_force_mean_over [s],peak_dynamic_pressure [Pa]"));
    CHECK_THAT(table, Contains("house_2,,,,,,,0,64,,,,,,,,\n"));
    CHECK(std::count(table.begin(), table.end(), '\n') == 4);
    // What particles do not tell is null in the record, and not a number that could be one.
    const Json record = Json::parse(text_of(village.path() / "run" / "run.json"));
    for (const Json& barrier : record["barriers"])
        for (const char* key : {"peak_force", "peak_force_time", "raw_peak_force", "impulse"})
            CHECK(barrier[key].is_null());
    CHECK(record["barriers"][1]["first_contact"].is_null());
    CHECK(record["barriers"][1]["run_up"].is_null());
    // No particle stands higher above the ground beside a wall than the flow is deep there, two cells up the slope at
    // most.
    const double run_up = record["barriers"][0]["run_up"].get<double>(), foot = 200.0 - 3.0 * 75.0 / 5.0;
    CHECK(run_up > foot);
    CHECK(run_up < foot + 2.0 * 3.0 + record["results"]["max_depth"].get<double>());
}

TEST_CASE("Maps of a run show its barriers, drawn at once or later", "[barriers][results][figures]") {
    if (figures::cannot_draw()) return;
    const Village village;
    const Outcome run =
        call_frana(village.path(), "run case.toml --out run --quiet --set 'output.formats=[\"geotiff\",\"png\"]'");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const fs::path pictures = village.path() / "run" / "figures";
    const auto shown = [&] {
        return figures::count(read_png(pictures / "map_peak_depth.png"), colours::barrier, 3) +
               figures::count(read_png(pictures / "view_peak_depth.png"), colours::barrier, 30);
    };
    const int at_once = shown();
    CHECK(figures::count(read_png(pictures / "map_peak_depth.png"), colours::barrier, 3) > 100);
    CHECK(figures::count(read_png(pictures / "view_peak_depth.png"), colours::barrier, 30) > 50);
    fs::remove_all(pictures);
    REQUIRE(call_frana(village.path(), "figures run --size 1400x1200").code == 0);
    CHECK(shown() == at_once);
    fs::remove(village.path() / "houses.geojson");
    const Outcome without = call_frana(village.path(), "figures run --size 1400x1200");
    CHECK(without.code == 0);
    CHECK_THAT(without.err, Contains("barriers are not shown"));
    CHECK(figures::count(read_png(pictures / "map_peak_depth.png"), colours::barrier, 3) == 0);
}

TEST_CASE("The report has depth and pressure at houses, and a house that was never hit has no picture",
          "[barriers][results]") {
    const Village village;
    const Outcome run =
        call_frana(village.path(), "run case.toml --out run --quiet --set 'output.formats=[\"geotiff\",\"png\"]'");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const fs::path dir = village.path() / "run";
    for (const auto& [name, hit] :
         {std::pair("house_1", true), std::pair("house_2", false), std::pair("house_3", true)})
        CHECK(fs::exists(dir / "figures" / fmt::format("barrier_{}.png", name)) == hit);
    const Layer layer(dir / "results.gpkg", "barriers");
    const OGRFeatureUniquePtr house(layer.get().GetNextFeature());
    const std::string row = fmt::format("| {:.4g} m | {:.4g} kPa | - |", house->GetFieldAsDouble("peak_depth_m"),
                                        1e-3 * house->GetFieldAsDouble("peak_dynamic_pressure_Pa"));
    CHECK_THAT(text_of(dir / "report.md"), Contains("Deepest at it | Dynamic pressure") && Contains(row));
}

TEST_CASE("A house that the flow reaches, but never deep enough for a contact, has neither run-up nor picture",
          "[barriers][results]") {
    const Village village;
    const Outcome run =
        call_frana(village.path(),
                   "run case.toml --out run --quiet --set output.footprint_depth=30 --set barrier.0.height=60 "
                   "--set 'output.formats=[\"geotiff\",\"png\"]'");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const fs::path dir = village.path() / "run";
    const auto no_picture = [&] { return !fs::exists(dir / "figures" / "barrier_house_1.png"); };
    const Json house = Json::parse(text_of(dir / "run.json"))["barriers"][0];
    CHECK(house["first_contact"].is_null());
    CHECK(house["run_up"].is_null());
    CHECK(no_picture());
    CHECK_THAT(text_of(dir / "report.md"), Contains("| house_1 | none |"));
    REQUIRE(call_frana(village.path(), "figures run").code == 0);
    CHECK(no_picture());
}

TEST_CASE("A house with a contact that no particle came near has the surface there as its run-up",
          "[barriers][results]") {
    BarrierHit hit, shallow, wall;
    hit.area = shallow.area = 64.0;
    hit.time = 3.0, hit.surface = 101.5;
    const double run_up = 99.0, unknown = BarrierHit::unknown;
    const auto noted = [&](const BarrierHit& of, double known) {
        std::vector<BarrierSummary> summaries(1);
        summaries[0].run_up = known;
        note_contacts({of}, summaries);
        return summaries[0];
    };
    CHECK(noted(hit, unknown).run_up == 101.5);
    CHECK(noted(hit, run_up).run_up == run_up);  // what particles tell is more exact
    CHECK(noted(hit, unknown).first_contact == 3.0);
    CHECK(std::isnan(noted(shallow, run_up).run_up));
    CHECK(noted(wall, run_up).run_up == run_up);  // of its contact nothing is known
    CHECK(was_hit(noted(hit, unknown)));
    CHECK_FALSE(was_hit(noted(shallow, run_up)));
    CHECK(was_hit(noted(wall, run_up)));
}

TEST_CASE("The chart of a house that nothing went over has no panel for that", "[barriers][results][figures]") {
    if (figures::cannot_draw()) return;
    const Village village;
    REQUIRE(call_frana(village.path(),
                       "run case.toml --out run --quiet --set barrier.0.height=60 --set 'output.formats=[\"png\"]'")
                .code == 0);
    const Json house = Json::parse(text_of(village.path() / "run" / "run.json"))["barriers"][0];
    REQUIRE(house["overtopped_volume"] == 0.0);
    const Pixels chart = read_png(village.path() / "run" / "figures" / "barrier_house_1.png");
    int lines = 0;  // across most of the picture: a panel's upper and lower edge
    bool before = false;
    for (int y = 0; y < chart.height; ++y) {
        int dark = 0;
        for (int x = 0; x < chart.width; ++x) dark += figures::distance(chart.at(x, y), colours::black) < 60;
        const bool line = dark > chart.width / 2;
        lines += line && !before;
        before = line;
    }
    CHECK(lines == 2);
}

TEST_CASE("A row of houses mirrored about the flow's axis is met alike, side by side", "[barriers][results]") {
    const Village village;  // the release lies about y = 50, and so does the terrain
    write_text(village.path() / "houses.geojson",
               collection(square(75, 32, 8, R"("h":5)") + "," + square(75, 60, 8, R"("h":6)")));
    REQUIRE(call_frana(village.path(), "run case.toml --out run --quiet").code == 0);
    const Layer layer(village.path() / "run" / "results.gpkg", "barriers");
    std::vector<OGRFeatureUniquePtr> houses;
    for (OGRFeatureUniquePtr& feature : layer.get()) houses.push_back(std::move(feature));
    REQUIRE(houses.size() == 2);
    const auto of = [&](std::size_t n, const std::string& name) { return houses[n]->GetFieldAsDouble(name.c_str()); };
    // Mirror images differ by round-off of places and sums, which grows while the flow spreads.
    for (const auto& [south, north] : {std::pair<const char*, const char*>{"north", "south"},
                                       {"south", "north"},
                                       {"west", "west"},
                                       {"east", "east"}})
        for (const char* what : {"depth_", "pressure_"}) {
            const std::string unit = what[0] == 'd' ? "_m" : "_Pa";
            CAPTURE(south, what);
            CHECK(of(0, what + std::string(south) + unit) ==
                  Approx(of(1, what + std::string(north) + unit)).epsilon(1e-6));
        }
    CHECK(of(0, "hit_s") == Approx(of(1, "hit_s")).epsilon(1e-6));
    CHECK(of(0, "peak_depth_m") > 0.1);
    CHECK(of(0, "depth_north_m") > of(0, "depth_south_m"));  // the flow's axis lies to the north of the southern house
}

// A wall with its face on an edge of pixels raises the nodes beyond. The flow stands on those before them.
TEST_CASE("Depth at a wall does not depend on whether its face lies on an edge of pixels", "[barriers][results]") {
    const Village village;
    const auto at_wall = [&](double x) {
        write_text(village.path() / "houses.geojson", collection(square(x, -5, 110, "")));
        REQUIRE(
            call_frana(village.path(), "run case.toml --out run --quiet --overwrite --set barrier.0.height=60").code ==
            0);
        const Layer layer(village.path() / "run" / "results.gpkg", "barriers");
        const OGRFeatureUniquePtr wall(layer.get().GetNextFeature());
        return std::pair(wall->GetFieldAsDouble("depth_west_m"), wall->GetFieldAsDouble("dynamic_pressure_west_Pa"));
    };
    const auto [on_edge, pressure_on_edge] = at_wall(75.0);  // pixels are 5 m wide
    const auto [off_edge, pressure_off_edge] = at_wall(75.5);
    // Both raise the same nodes before the flow, from 77.5 m on, and the first those at 72.5 m too: a cell nearer.
    CHECK(on_edge > 0.5 * off_edge);
    CHECK(pressure_on_edge > 0.5 * pressure_off_edge);
}

// Below a steep face the averaged bed is raised one node farther out, so that a pile has its depth two nodes from the wall.
TEST_CASE("The depth at a wall is that of the pile before it", "[barriers][results]") {
    const Village village;
    write_text(village.path() / "houses.geojson", collection(square(75, -5, 110, "")));
    REQUIRE(call_frana(village.path(), "run case.toml --out run --quiet --set barrier.0.height=60").code == 0);
    const Raster peak = raster_of(village.path() / "run", "peak_depth.tif");
    double pile = 0.0;
    for (Index j = 0; j < peak.geometry.ny; ++j)
        for (Index i = 0; i < peak.geometry.nx; ++i)
            if (peak.geometry.x(i) > 60.0 && peak.geometry.x(i) < 75.0) pile = std::max(pile, peak.at(i, j));
    REQUIRE(pile > 1.0);
    const Layer layer(village.path() / "run" / "results.gpkg", "barriers");
    const OGRFeatureUniquePtr wall(layer.get().GetNextFeature());
    CHECK(wall->GetFieldAsDouble("depth_west_m") == Approx(pile).epsilon(1e-6));  // rasters are in single precision
}

// A film on the raised nodes is no flow that came onto them: what passes two nodes beside a house does not stand at it.
TEST_CASE("A house is not hit by a flow two cells beside it with a film between", "[barriers][results]") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const GridGeometry grid{40, 20, 2.5, 2.5, 5.0};
    std::vector<ProductRaster> rasters;
    for (const char* name : {"peak_depth", "peak_dynamic_pressure", "arrival_time"})
        rasters.push_back({name, "", "", Raster::filled(grid, kNone)});
    const auto set = [&](Index i, double depth, double pressure, double arrival) {
        for (Index j = 0; j < grid.ny; ++j)
            rasters[0].raster.at(i, j) = depth, rasters[1].raster.at(i, j) = pressure,
                                    rasters[2].raster.at(i, j) = arrival;
    };
    for (Index i = 0; i < 18; ++i) set(i, 6.0, 4e5, 10.0);  // up to x = 90 m
    set(18, 0.001, 4e2, kNone);                             // a film up to 95 m, never as deep as a footprint
    Polygons house;
    house.parts = {Polygon{{{{100, 40}, {110, 40}, {110, 50}, {100, 50}, {100, 40}}}}};
    const BarrierHit passed = hit_on(house, rasters);
    CHECK_FALSE(passed.depth > 0.1);
    CHECK(std::isnan(passed.time));
    set(18, 0.2, 1e3, 12.0);  // the flow came onto it, and stands on the pixels around it
    CHECK(hit_on(house, rasters).depth == 6.0);
}

// Pixels on the diagonal at a corner counted for both sides, so that the lee had the depth of what passed the house.
TEST_CASE("What passes the corner of a house is not at its lee side", "[barriers][results]") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const double cell = GENERATE(2.0, 4.0, 5.0);
    const GridGeometry grid{50, 50, 0.5 * cell, 0.5 * cell, cell};
    std::vector<ProductRaster> rasters;
    for (const char* name : {"peak_depth", "peak_dynamic_pressure", "arrival_time"})
        rasters.push_back({name, "", "", Raster::filled(grid, kNone)});
    const double from = 10.0 * cell, to = 13.0 * cell;  // edges of pixels
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i < grid.nx; ++i) {
            const bool wake = grid.x(i) > from && grid.y(j) > from && grid.y(j) < to;  // behind it, as it flows east
            if (!wake) rasters[0].raster.at(i, j) = 1.5, rasters[1].raster.at(i, j) = 6e4;
            if (!wake) rasters[2].raster.at(i, j) = 1.0;
        }
    Polygons house;
    house.parts = {Polygon{{{{from, from}, {to, from}, {to, to}, {from, to}, {from, from}}}}};
    const BarrierHit hit = hit_on(house, rasters);
    CHECK(std::isnan(hit.side_depth[1]));
    CHECK(std::isnan(hit.side_pressure[1]));
    for (const std::size_t side : {0, 2, 3}) CHECK(hit.side_depth[side] == 1.5);
    Polygons tower;  // round, with sides shorter than a cell, and one that is narrower than a cell
    std::vector<Vec2> ring;
    for (int n = 0; n < 32; ++n)
        ring.emplace_back(from + cell * std::cos(n * constants::kPi / 16),
                          from + cell * std::sin(n * constants::kPi / 16));
    tower.parts = {Polygon{{ring}}};
    for (ProductRaster& raster : rasters) raster.raster = Raster::filled(grid, 1.0);
    for (const double depth : hit_on(tower, rasters).side_depth) CHECK(depth == 1.0);
    const double thin = from + 0.3 * cell;
    tower.parts = {Polygon{{{{from, from}, {thin, from}, {thin, to}, {from, to}}}}};
    for (const double depth : hit_on(tower, rasters).side_depth) CHECK(depth == 1.0);
}

// Points reach up to the face. Pixels with their middle on it had no side, and in cases/wall the deepest of all is one.
TEST_CASE("Depth on a face itself is that of its side, and the largest side has the largest depth",
          "[barriers][results]") {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const GridGeometry grid{40, 20, 0.0, 0.0, 5.0};
    std::vector<ProductRaster> rasters;
    for (const char* name : {"peak_depth", "peak_dynamic_pressure", "arrival_time"})
        rasters.push_back({name, "", "", Raster::filled(grid, kNone)});
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 0; i <= 20; ++i)  // up to the face at x = 100 m, and deeper towards it
            rasters[0].raster.at(i, j) = 0.1 * static_cast<double>(i), rasters[1].raster.at(i, j) = 1e3,
                                    rasters[2].raster.at(i, j) = 1.0;
    Polygons wall;
    const bool turned = GENERATE(false, true);
    wall.parts = {Polygon{{{{100, -10}, {110, -10}, {110, 110}, {100, 110}, {100, -10}}}}};
    if (turned) std::reverse(wall.parts[0].rings[0].begin(), wall.parts[0].rings[0].end());
    const BarrierHit on_face = hit_on(wall, rasters);
    CHECK(on_face.depth == Approx(2.0));
    CHECK(on_face.side_depth[3] == on_face.depth);
    for (Index j = 0; j < grid.ny; ++j) rasters[0].raster.at(21, j) = 2.5, rasters[2].raster.at(21, j) = 1.0;
    CHECK(hit_on(wall, rasters).side_depth[3] == 2.5);  // in the wall, as near to both: to the east as well
    CHECK(hit_on(wall, rasters).side_depth[1] == 2.5);
    CHECK(std::isnan(on_face.side_depth[0]));
    CHECK(std::isnan(on_face.side_depth[1]));
    CHECK(std::isnan(on_face.side_depth[2]));
}

TEST_CASE("A force on a barrier has the time that it is the mean over, wherever it is told", "[barriers][results]") {
    const FreshFolder folder;
    BarrierSummary dam, none;
    dam.name = "dam", none.name = "none";
    dam.first_contact = 5.0, dam.peak_force = 3.16e6, dam.peak_force_time = 7.9, dam.blur = 0.2;
    write_barrier_table(folder.path() / "barriers.csv", {dam, none}, {BarrierHit(), BarrierHit()});
    const std::string table = text_of(folder.path() / "barriers.csv");
    CHECK_THAT(table, Contains("peak_force [N],peak_force_mean_over [s],"));
    CHECK_THAT(table, Contains("dam,5,3160000,0.2,") && Contains("none,,,,"));
    RunRecord record;
    record.density = 1000.0;
    record.barriers = {dam, none};
    CHECK_THAT(report_markdown(record, folder.path()),
               Contains("| dam | 0.2 s, as in `barriers.csv` | 3.16e+06 N | 7.9 s |") && !Contains("| none | 0 s"));
}

TEST_CASE("A height that a feature lacks is refused with its name", "[barriers]") {
    const Village village;
    write_text(village.path() / "houses.geojson",
               collection(square(75, 32, 8, R"("h":5)") + "," + square(75, 60, 8, R"("h":null)")));
    const std::string text = text_of(village.path() / "case.toml");
    const std::string fixed = "height = 6";
    std::string by_field = text;
    by_field.replace(by_field.find(fixed), fixed.size(), "height_field = \"h\"");
    write_text(village.path() / "case.toml", by_field);
    const Outcome check = call_frana(village.path(), "check case.toml");
    CHECK(check.code == 2);
    CHECK_THAT(check.err, Contains("houses.geojson") && Contains("h") && Contains("feature"));
}

TEST_CASE("A run again writes the same bytes of its barriers, and lists the file", "[barriers][results]") {
    const Village village;
    REQUIRE(call_frana(village.path(), "run case.toml --out a --quiet").code == 0);
    REQUIRE(call_frana(village.path(), "run case.toml --out b --quiet").code == 0);
    CHECK(text_of(village.path() / "a" / "results.gpkg") == text_of(village.path() / "b" / "results.gpkg"));
    CHECK_THAT(text_of(village.path() / "a" / "run.json"), Contains("results.gpkg"));
    CHECK(call_frana(village.path(), "run case.toml --out a --quiet").code == 2);
    CHECK(call_frana(village.path(), "run case.toml --out a --quiet --overwrite").code == 0);
}

TEST_CASE("Of many houses the report has those that are covered most, and a resumed run the same bytes of all",
          "[barriers][results][resume]") {
    const Village village;
    std::string houses;
    for (int row = 0; row < 5; ++row)
        for (int column = 0; column < 5; ++column)
            houses += (houses.empty() ? "" : ",") + square(55 + 15 * column, 10 + 17 * row, 8, R"("use":"house")");
    write_text(village.path() / "houses.geojson", collection(houses));
    REQUIRE(call_frana(village.path(), "run case.toml --out straight --quiet").code == 0);
    REQUIRE(call_frana(village.path(), "run case.toml --out parts --quiet --until 2.5").code == 0);
    REQUIRE(call_frana(village.path(), "run case.toml --out parts --quiet --resume").code == 0);
    const fs::path straight = village.path() / "straight", parts = village.path() / "parts";
    for (const char* file : {"results.gpkg", "barriers.csv"}) {
        CAPTURE(file);
        CHECK(text_of(parts / file) == text_of(straight / file));
    }
    const std::string table = text_of(straight / "barriers.csv");
    CHECK(std::count(table.begin(), table.end(), '\n') == 26);
    const auto rows_of = [](const fs::path& run_dir) {  // of the report's table of barriers
        std::vector<std::string> rows;
        std::istringstream report(text_of(run_dir / "report.md"));
        for (std::string line; std::getline(report, line);)
            if (line.rfind("| house_", 0) == 0) rows.push_back(line);
        return rows;
    };
    const std::vector<std::string> rows = rows_of(straight);
    CHECK(rows_of(parts) == rows);
    // Those that the report leaves out are covered by no more than any that it has.
    const Layer layer(straight / "results.gpkg", "barriers");
    REQUIRE(layer.get().GetFeatureCount() == 25);
    double least_shown = INFINITY, most_left_out = 0.0;
    std::size_t hit = 0, covered = 0;
    for (const OGRFeatureUniquePtr& house : layer.get()) {
        const std::string name = std::string("| ") + house->GetFieldAsString("barrier") + " |";
        const bool shown =
            std::any_of(rows.begin(), rows.end(), [&](const std::string& row) { return row.rfind(name, 0) == 0; });
        const bool reached = house->IsFieldSetAndNotNull(house->GetFieldIndex("peak_depth_m")) != 0;
        const double depth = reached ? house->GetFieldAsDouble("peak_depth_m") : 0.0;
        hit += house->IsFieldSetAndNotNull(house->GetFieldIndex("hit_s")) != 0;
        covered += depth > 0.0;
        if (shown) least_shown = std::min(least_shown, depth);
        if (!shown) most_left_out = std::max(most_left_out, depth);
    }
    CHECK(most_left_out <= least_shown);
    CHECK(rows.size() == std::min(covered, kMostBarrierTables));
    REQUIRE((hit > 3 && hit < 25));
    CHECK_THAT(text_of(straight / "report.md"), Contains("Of 25 barriers " + std::to_string(hit) + " were hit."));
    // A wall along a line, whose contact is not known, counts by what runs over it.
    write_text(village.path() / "dammed.toml",
               text_of(village.path() / "case.toml") +
                   "\n[[barrier]]\nname = \"dam\"\nline = [[50.0, 90.0], [50.0, 5.0]]\nheight = 0.2\n");
    REQUIRE(call_frana(village.path(), "run dammed.toml --out dammed --quiet").code == 0);
    const std::string report = text_of(village.path() / "dammed" / "report.md");
    CHECK_THAT(report, Contains("\n| dam | - | - |"));
    CHECK_THAT(report, Contains("Of 26 barriers "));
    // Or by what stands before it: nothing gets past this one.
    write_text(village.path() / "held.toml",
               text_of(village.path() / "case.toml") +
                   "\n[[barrier]]\nname = \"dam\"\nline = [[50.0, 98.0], [50.0, 2.0]]\nheight = 60\n");
    REQUIRE(call_frana(village.path(), "run held.toml --out held --quiet").code == 0);
    const std::string held = text_of(village.path() / "held" / "report.md");
    CHECK_THAT(held, Contains("\n| dam | - | - |"));
    CHECK_THAT(held, Contains("Of 26 barriers 1 were hit. Shown are walls that were reached"));
}

TEST_CASE("Attributed polygons come back in the order of the polygons, types widened where features differ",
          "[results]") {
    const FreshFolder folder;
    const fs::path file = folder.path() / "a.gpkg";
    const Polygon unit{{{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{0.5, 0.5}, {0.5, 1.0}, {1.0, 1.0}, {1.0, 0.5}}}};
    write_layers(file, "",
                 {{"things",
                   {{unit, {{"n", 3LL}, {"x", 2LL}, {"fid", std::string("a")}, {"bad", NAN}}},
                    {unit, {{"N", 4LL}, {"x", 0.5}, {"mixed", 1LL}}},
                    {unit, {{"mixed", std::string("b")}}}}},
                  {"nothing", {}}});
    std::vector<std::string> log;
    const auto back = read_attributed_polygons(file, "", log);
    REQUIRE(back.size() == 3);
    using Named = std::vector<std::pair<std::string, Attribute>>;
    CHECK(back[0].attributes == Named{{"n", 3LL}, {"x", 2.0}, {"fid", std::string("a")}});
    CHECK(back[1].attributes == Named{{"n", 4LL}, {"x", 0.5}, {"mixed", std::string("1")}});
    CHECK(back[2].attributes == Named{{"mixed", std::string("b")}});
    CHECK(back[0].polygon.rings.size() == 2);
    CHECK_THROWS_WITH(write_layers(folder.path() / "nowhere" / "a.gpkg", "", {}), Contains("cannot be written"));
}

TEST_CASE("The report has the forces of what leans on a barrier from the start", "[barriers][results]") {
    const FreshFolder folder;
    std::string dem = "ncols 13\nnrows 6\nxllcorner -0.5\nyllcorner -0.5\ncellsize 1\nNODATA_value -9999\n";
    for (int row = 0; row < 6; ++row) dem += "10 10 10 10 10 10 10 10 10 10 10 10 10\n";
    write_text(folder.path() / "dem.asc", dem);
    const auto strip = [](double from, double to) {
        const auto p = [](double x, double y) { return "[" + std::to_string(x) + "," + std::to_string(y) + "]"; };
        return collection(R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[)" +
                          p(from, -0.4) + "," + p(to, -0.4) + "," + p(to, 5.4) + "," + p(from, 5.4) + "," +
                          p(from, -0.4) + "]]}}");
    };
    write_text(folder.path() / "water.geojson", strip(-0.4, 8));
    write_text(folder.path() / "dam.geojson", strip(8, 10));
    write_text(folder.path() / "case.toml",
               "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"water.geojson\"\ndepth = 2\n"
               "[material]\ndensity = 1000\nbed.law = \"none\"\n[boundary]\nsides = \"wall\"\n[[stage]]\n"
               "model = \"mpm3d\"\ncell = 0.5\n[[barrier]]\nname = \"dam\"\noutline = \"dam.geojson\"\nheight = 4\n"
               "[time]\nend = 0.5\n[output]\nevery = 0.5\nformats = []\n");
    const Outcome run = call_frana(folder.path(), "run case.toml --out run --quiet");
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Json dam = Json::parse(text_of(folder.path() / "run" / "run.json"))["barriers"][0];
    REQUIRE(dam["peak_force"].get<double>() > 0.5e5);  // rho g h^2 b / 2 = 98 kN
    const std::string report = text_of(folder.path() / "run" / "report.md");
    CHECK_THAT(report, Contains("| Barrier | Mean over | Largest horizontal force |"));
    CHECK_THAT(report, Contains("| dam | 0.01 s |"));
    CHECK_THAT(report, Contains("Moments are about the middle of each outline on the bed: dam (9, 2.5, 10) m."));
}
