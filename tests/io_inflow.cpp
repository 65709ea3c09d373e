// A flood through a line, and what passes another, by the program: files, record, report, resume.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/colour.h"
#include "catch.h"
#include "io_figures_scene.h"
#include "observe/table.h"
#include "plane_case.h"
#include "read_layer.h"
#include "run/folder/section_ends.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const char* const kFlood = R"(
[terrain]
dem = "dem.asc"
[[inflow]]
name = "torrent"
line = [[40, 35], [40, 65]]
table = "q.csv"
[material.bed]
law = "voellmy"
mu = 0.05
xi = 400
[time]
end = 12
[output]
every = 2
formats = ["vtk", "geotiff", "png"]
[[section]]
name = "bridge"
line = [[55, 5], [55, 95]]
)";
constexpr double kVolume = 0.5 * (1.0 * 60.0 + 7.0 * 60.0);

/// The release of the plane is not used.
struct Flood : PlaneCase {
    Flood() {
        write_text(file(), kFlood);
        write_text(folder() / "q.csv", "t [s], discharge [m3/s]\n1, 0\n2, 60\n9, 0\n");
    }
};

Json record_of(const fs::path& run_dir) { return Json::parse(text_of(run_dir / "run.json")); }

}  // namespace

TEST_CASE("The runout of a flood is that from its line, in all commands", "[program][inflow][converge]") {
    const Flood plane;
    const fs::path study = plane.folder() / "study", dir = study / "cell_4";
    const Outcome run = plane.frana("converge CASE --cells 5,4 --quiet --out " + study.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    CHECK_THAT(run.out, !Contains("nan"));
    CHECK(record_of(dir)["results"]["start"] == Json({40.0, 50.0}));
    const Json converged = Json::parse(text_of(study / "converge.json"));
    const double runout = converged["runout"][1];
    CHECK(runout > 20.0);
    write_text(plane.folder() / "survey.geojson",
               R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
               {"type": "Polygon", "coordinates": [[[40, 30], [80, 30], [80, 70], [40, 70], [40, 30]]]}}]})");
    REQUIRE(plane.frana("compare " + dir.string() + " --survey survey.geojson").code == 0);
    const Json compared = Json::parse(text_of(dir / "compare.json"));
    CHECK(compared["runout_path"] == "steepest path from where material comes in");
    CHECK(compared["runout_simulated"].get<double>() == Approx(runout));
    write_text(plane.folder() / "many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\n[[ensemble.vary]]\nkey = \"material.bed.mu\"\n"
               "distribution = \"discrete\"\nvalues = [0.05]\n");
    const Outcome ensemble = plane.frana("ensemble many.toml --quiet --out many");
    INFO(ensemble.err);
    REQUIRE(ensemble.code == 0);
    std::istringstream rows(text_of(plane.folder() / "many" / "runs.csv"));
    std::string names, row;
    std::getline(rows, names), std::getline(rows, row);
    std::istringstream heads(names), fields(row);
    double of_ensemble = 0.0;
    for (std::string head, field; std::getline(heads, head, ',') && std::getline(fields, field, ',');)
        if (head == "runout_m") of_ensemble = std::stod(field);
    CHECK(of_ensemble == Approx(converged["runout"][0].get<double>()).margin(5.0));  // by a path on cells of 5 m
}

TEST_CASE("A flood leaves its budget, and a section its table, figure and lines in the report", "[program][inflow]") {
    const Flood plane;
    const Outcome check = plane.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("inflow torrent: 240 m3 until 9 s, at most 60 m3/s at 2 s; the line is 30 m wide"));
    CHECK_THAT(check.out, !Contains("time        0 s") && !Contains("and 0 that come in"));
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --out " + dir.string());
    CHECK(run.code == 0);
    const Json json = record_of(dir);
    CHECK(json["budgets"]["inflow"]["volume"].get<double>() == Approx(kVolume).epsilon(1e-13));
    CHECK(json["budgets"]["inflow"]["expected"].get<double>() == Approx(kVolume).epsilon(1e-13));
    CHECK(std::abs(json["budgets"]["inflow"]["relative_error"].get<double>()) < 1e-13);
    CHECK(json["budgets"]["mass"]["initial"] == 0.0);
    CHECK(json["budgets"]["mass"]["came_in"].get<double>() == Approx(1000.0 * kVolume).epsilon(1e-13));
    CHECK(std::abs(json["budgets"]["mass"]["relative_error"].get<double>()) < 1e-13);
    const Table table = read_table(dir / "sections" / "bridge.csv");
    CHECK(table.columns == std::vector<std::string>{"t", "discharge", "volume", "sediment"});
    CHECK(table.column("sediment") == table.column("volume"));  // of one phase
    CHECK(table.rows() == json["steps"].get<std::size_t>() + 1);
    const double passed = json["sections"][0]["volume"].get<double>();
    CHECK(passed == table.column("volume").back());
    CHECK(passed > 0.3 * kVolume);
    CHECK(passed < kVolume);
    CHECK(json["sections"][0]["towards"][0] == 1.0);
    const std::string report = text_of(dir / "report.md");
    for (const char* text :
         {"## Sections", "| bridge | 90 degrees from north |", "came in by inflows", "figures/sections_discharge.png",
          "inflow torrent: 240 m3", "| farthest front from the middle of inflow torrent |"})
        CHECK_THAT(report, Contains(text));
    CHECK(json["results"]["front_from"] == "the middle of inflow torrent");
    CHECK(fs::file_size(dir / "figures" / "sections_discharge.png") > 1000);
}

TEST_CASE("A section that the flow goes round has a remark at that end", "[program][inflow][sections]") {
    const Flood plane;
    write_text(plane.file(), std::string(kFlood) + "[[section]]\nname = \"short\"\nline = [[55, 5], [55, 50]]\n");
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane.frana("run CASE --quiet --set output.formats=[] --out " + dir.string()).code == 0);
    std::vector<std::string> ends;
    const Json json = record_of(dir);
    for (const std::string remark : json["remarks"])
        if (remark.find("passed beyond the end of section") != std::string::npos) ends.push_back(remark);
    REQUIRE(ends.size() == 1);
    CHECK_THAT(ends[0], Contains("the flow passed beyond the end of section short at (55, 50), ") &&
                            Catch::EndsWith(" m deep: draw the line longer"));
    CHECK_THAT(text_of(dir / "report.md"), Contains("- " + ends[0] + "\n"));
}

TEST_CASE("A section may end at the flow's margin, at the terrain's edge or outside of it", "[sections]") {
    Raster peak = Raster::filled({10, 10, 0.0, 0.0, 2.0}, 0.0);
    for (Index j = 4; j < 10; ++j) peak.at(5, j) = 0.5;  // x = 10, from y = 8 to the northern edge
    const auto remarks = [&](double from, double to) {
        return remarks_on_ends({{"a", {{10.0, from}, {10.0, to}}, true}}, peak, 0.1).size();
    };
    CHECK(remarks(2.0, 18.0) == 0);
    CHECK(remarks(8.0, 25.0) == 0);
    CHECK(remarks(2.0, 12.0) == 1);
    CHECK(remarks(12.0, 14.0) == 2);
    peak.at(5, 7) = 0.1;
    CHECK(remarks(2.0, 12.0) == 0);
}

TEST_CASE("A GIS gets the lines and areas of inflows, with what their tables say", "[program][inflow][gis]") {
    const Flood plane;
    write_text(plane.file(), std::string(kFlood) +
                                 "[[inflow]]\nname = \"landslide\"\narea = [[60, 30], [70, 30], [70, 50], [60, 50]]\n"
                                 "table = \"q.csv\"\n");
    const fs::path dir = plane.folder() / "out";
    const Outcome run =
        plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --until 4 --out " + dir.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    for (const auto& [name, inflow] : {std::pair("inflow", "torrent"), std::pair("inflow_areas", "landslide")}) {
        CAPTURE(name);
        const Layer layer(dir / "results.gpkg", name);
        REQUIRE(layer.get().GetFeatureCount() == 1);
        const OGRFeatureUniquePtr feature(layer.get().GetNextFeature());
        CHECK(std::string(feature->GetFieldAsString("name")) == inflow);
        // The corners of q.csv, and a triangle's volume by a sum of trapezoids: round-off.
        CHECK(feature->GetFieldAsDouble("volume_m3") == Approx(kVolume).epsilon(1e-13));
        CHECK(feature->GetFieldAsDouble("peak_discharge_m3_s") == 60.0);
        CHECK(feature->GetFieldAsDouble("peak_s") == 2.0);
        CHECK(feature->GetFieldAsDouble("start_s") == 1.0);
        CHECK(feature->GetFieldAsDouble("end_s") == 9.0);
    }
    const Layer lines(dir / "results.gpkg", "inflow"), areas(dir / "results.gpkg", "inflow_areas");
    const OGRFeatureUniquePtr line(lines.get().GetNextFeature()), area(areas.get().GetNextFeature());
    CHECK(line->GetGeometryRef()->toLineString()->getX(0) == 40.0);
    CHECK(line->GetGeometryRef()->toLineString()->getY(1) == 65.0);
    CHECK(area->GetGeometryRef()->toPolygon()->get_Area() == Approx(200.0));
    CHECK(area->GetFieldAsDouble("area_m2") == Approx(200.0));
}

TEST_CASE("Each polygon of an inflow has its own area in a GIS, and the volume of the table",
          "[program][inflow][gis]") {
    const Flood plane;
    write_text(plane.folder() / "two.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [
                  [[[60, 30], [70, 30], [70, 50], [60, 50], [60, 30]]],
                  [[[80, 30], [90, 30], [90, 40], [80, 40], [80, 30]]]]}})");
    write_text(plane.file(),
               std::string(kFlood) + "[[inflow]]\nname = \"landslide\"\narea = \"two.geojson\"\ntable = \"q.csv\"\n");
    const fs::path dir = plane.folder() / "out";
    REQUIRE(plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --until 4 --out " + dir.string()).code ==
            0);
    const Layer layer(dir / "results.gpkg", "inflow_areas");
    REQUIRE(layer.get().GetFeatureCount() == 2);
    for (const double area : {200.0, 100.0}) {
        const OGRFeatureUniquePtr row(layer.get().GetNextFeature());
        CHECK(row->GetFieldAsDouble("area_m2") == Approx(area));
        CHECK(row->GetFieldAsDouble("volume_m3") == Approx(kVolume).epsilon(1e-13));
    }
}

TEST_CASE("Pictures of a run show its inflows, drawn again too, and not those whose file has gone",
          "[program][inflow][figures]") {
    const Flood plane;
    write_text(plane.folder() / "line.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates":
               [[40, 35], [40, 65]]}})");
    const fs::path dir = plane.folder() / "out", map = dir / "figures" / "map_peak_depth.png";
    REQUIRE(plane
                .frana("run CASE --quiet --set inflow.0.line=line.geojson --set 'output.formats=[\"geotiff\",\"png\"]' "
                       "--until 4 --out " +
                       dir.string())
                .code == 0);
    const auto black = [&] { return figures::count(read_png(map), colours::black, 3); };
    const int at_once = black();
    REQUIRE(plane.frana("figures " + dir.string() + " --size 1400x1200").err.empty());
    const int again = black();
    fs::remove(plane.folder() / "line.geojson");
    const Outcome gone = plane.frana("figures " + dir.string() + " --size 1400x1200");
    CHECK(gone.code == 0);
    CHECK_THAT(gone.err, Contains("inflow torrent is not on the maps: ") && Contains("line.geojson"));
    // Half of what the dashes of the line, the name beside it and the entry of the legend have.
    constexpr int kLine = 500;
    CHECK(at_once > black() + kLine);
    CHECK(again > black() + kLine);
}

TEST_CASE("What of a flood's table has not come in is told, before the run and after it", "[program][inflow]") {
    const Flood plane;
    const Outcome check = plane.frana("check CASE --set time.end=5");
    CHECK_THAT(check.out,
               Contains("inflow torrent: found a table that goes on to 9 s; expected time.end = 5 s or less"));
    const fs::path dir = plane.folder() / "out";
    CHECK(plane.frana("run CASE --quiet --set time.end=5 --set output.formats=[] --out " + dir.string()).code == 0);
    const Json inflow = record_of(dir)["budgets"]["inflow"];
    CHECK(inflow["tables"].get<double>() == Approx(kVolume).epsilon(1e-13));
    // The rest of the triangle, and what of the last row has not come in.
    const double rest = 0.5 * 4.0 * 60.0 * 4.0 / 7.0,
                 left = inflow["tables"].get<double>() - inflow["expected"].get<double>();
    CHECK(left >= rest * (1.0 - 1e-12));
    CHECK(inflow["volume"].get<double>() == Approx(kVolume - left).epsilon(1e-12));
    CHECK_THAT(text_of(dir / "report.md"), Contains("; of their 240 m3 ") && Contains(" m3 had not come in |"));
    CHECK_THAT(text_of(dir / "report.md"), Contains("Net is what left less what came in: energy is negative"));
    const double net = record_of(dir)["budgets"]["energy"]["left_domain"];
    CHECK(net < 0.0);  // nothing left, and what came in stood above the datum
    CHECK_THAT(text_of(dir / "report.md"), Contains(fmt::format("| net {:.4g} |", net)));
    // Until t after the peak the triangle has brought all but what is right of t.
    const double until = 9.0 - std::sqrt(2.0 * left * 7.0 / 60.0);
    CHECK_THAT(text_of(dir / "report.md"),
               Contains(fmt::format("by the tables, until their row of t = {:.4g} s, {:.6g} "
                                    "m3, ",
                                    until, inflow["expected"].get<double>())));
}

TEST_CASE("A run that ends before anything came in says so", "[program][inflow]") {
    const Flood plane;
    const fs::path dir = plane.folder() / "out";
    CHECK(plane.frana("run CASE --quiet --until 0.5 --set 'output.formats=[\"png\"]' --out " + dir.string()).code == 0);
    const std::string report = text_of(dir / "report.md");
    CHECK_THAT(report, Contains("--resume goes on: no material has come in yet") && !Contains("nothing moves"));
    CHECK(record_of(dir)["rest"]["reason"] == "before any material came in");
    CHECK_THAT(report, Contains("| 0 m3 | 0 m3 | not reached | 0 m3 |"));
    CHECK_FALSE(fs::exists(dir / "figures" / "sections_discharge.png"));
    CHECK_THAT(report, Contains("| came in by inflows | 0 m3; no row of the tables' 240 m3 has come in yet |"));
}

TEST_CASE("A flood that is stopped in the middle of its table goes on with the same bits", "[program][inflow]") {
    const Flood plane;
    const std::string straight = (plane.folder() / "straight").string(), parts = (plane.folder() / "parts").string();
    CHECK(plane.frana("run CASE --quiet --set output.formats=[] --threads 1 --out " + straight).code == 0);
    CHECK(plane.frana("run CASE --quiet --set output.formats=[] --until 5 --threads 2 --out " + parts).code == 0);
    CHECK(record_of(parts)["budgets"]["inflow"]["volume"].get<double>() < kVolume);
    CHECK(plane.frana("run CASE --quiet --set output.formats=[] --resume --threads 2 --out " + parts).code == 0);
    CHECK(text_of(fs::path(parts) / "sections" / "bridge.csv") ==
          text_of(fs::path(straight) / "sections" / "bridge.csv"));
    CHECK(text_of(fs::path(parts) / "history.csv") == text_of(fs::path(straight) / "history.csv"));
    CHECK(record_of(parts)["budgets"]["inflow"] == record_of(straight)["budgets"]["inflow"]);
}

TEST_CASE("A flood through the line of a vector file is that through its points", "[program][inflow]") {
    const Flood plane;
    write_text(plane.folder() / "line.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates":
               [[40, 35], [40, 65]]}})");
    const std::string points = (plane.folder() / "points").string(), file = (plane.folder() / "file").string();
    const std::string run = "run CASE --quiet --set output.formats=[] --until 4 ";
    CHECK(plane.frana(run + "--out " + points).code == 0);
    CHECK(plane.frana(run + "--set inflow.0.line=line.geojson --set section.0.line=line.geojson --out " + file).code ==
          0);
    CHECK(text_of(fs::path(points) / "history.csv") == text_of(fs::path(file) / "history.csv"));
    CHECK_THAT(text_of(fs::path(file) / "resolved.toml"), Contains("line.geojson\""));
    CHECK(plane.frana("check " + (fs::path(file) / "resolved.toml").string()).code == 0);
}

TEST_CASE("Pictures of a run whose section is a file are drawn again, without its line where the file has gone",
          "[program][inflow][figures]") {
    const Flood plane;
    write_text(plane.folder() / "bridge.geojson",
               R"({"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates":
               [[55, 5], [55, 95]]}})");
    const std::string dir = (plane.folder() / "out").string();
    const std::string run =
        "run CASE --quiet --set section.0.line=bridge.geojson --set 'output.formats=[\"geotiff\"]' ";
    REQUIRE(plane.frana(run + "--until 4 --out " + dir).code == 0);
    const Outcome again = plane.frana("figures " + dir);
    INFO(again.err);
    CHECK(again.code == 0);
    CHECK_THAT(again.out, Contains("map_peak_depth.png") && Contains("sections_discharge.png"));
    CHECK(again.err.empty());
    fs::remove(plane.folder() / "bridge.geojson");
    const Outcome gone = plane.frana("figures " + dir);
    CHECK(gone.code == 0);
    CHECK_THAT(gone.out, Contains("map_peak_depth.png") && Contains("sections_discharge.png"));
    CHECK_THAT(gone.err, Contains("section bridge is not on the maps: ") && Contains("bridge.geojson"));
}

TEST_CASE("What a run over an area leaves as its case in full is a case", "[program][inflow][resolved]") {
    const Flood plane;
    std::string text = kFlood;
    const std::string line = "line = [[40, 35], [40, 65]]";
    text.replace(text.find(line), line.size(), "area = [[30, 35], [50, 35], [50, 65], [30, 65]]");
    text +=
        "[[release]]\noutline = \"release.geojson\"\ndepth = 1.0\nat = 3.0\n"
        "[[release]]\noutline = \"release.geojson\"\ndepth = 0.5\nwhen_hit = true\n"
        "[deposition]\nlaw = \"rest\"\n[forest]\ndetrainment = 20\n"
        "[[barrier]]\nname = \"house\"\noutline = \"release.geojson\"\nheight = 2.0\n";
    write_text(plane.file(), text);
    const std::string dir = (plane.folder() / "out").string();
    const Outcome run = plane.frana("run CASE --quiet --set output.formats=[] --until 1 --out " + dir);
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Outcome check = plane.frana("check " + dir + "/resolved.toml");
    INFO(check.err);
    CHECK(check.code == 0);
    CHECK_THAT(text_of(dir + "/resolved.toml"), !Contains("velocity = \"normal\""));
}

TEST_CASE("Sediment that passes a section is the share of the ground along its line", "[program][inflow][zones]") {
    const Flood plane;
    std::string text = text_of(plane.file());
    const std::string voellmy = "law = \"voellmy\"\nmu = 0.05\nxi = 400\n";
    text.replace(text.find(voellmy), voellmy.size(),
                 "law = \"pouliquen\"\nmu_s = 0.05\nmu_2 = 0.4\ngrain_diameter = 0.01\nsolid_fraction = 0.6\n"
                 "[[material.zone]]\noutline = \"beyond.geojson\"\nsolid_fraction = 0.3\n");
    write_text(plane.file(), text);
    write_text(plane.folder() / "beyond.geojson",
               R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
               {"type": "Polygon", "coordinates": [[[48, 0], [98, 0], [98, 100], [48, 100], [48, 0]]]}}]})");
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana("run CASE --quiet --set output.formats=[] --out " + dir.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    const Json bridge = record_of(dir)["sections"][0];
    REQUIRE(bridge["volume"].get<double>() > 1.0);
    CHECK(bridge["sediment"].get<double>() == Approx(0.3 * bridge["volume"].get<double>()).epsilon(1e-12));
}

TEST_CASE("A flood that takes up its bed grows from what came in", "[program][inflow][erosion]") {
    const Flood plane;
    const fs::path dir = plane.folder() / "out";
    const Outcome run = plane.frana(
        "run CASE --quiet --set output.formats=[] --set erodible.law=growth --set erodible.growth=0.01 "
        "--set erodible.depth=0.5 --out " +
        dir.string());
    INFO(run.err);
    REQUIRE(run.code == 0);
    const double taken = record_of(dir)["budgets"]["bed"]["eroded"].get<double>() / 1000.0;
    REQUIRE(taken > 0.1 * kVolume);
    CHECK_THAT(text_of(dir / "report.md"),
               Contains(fmt::format("(its mass grew {:.3g} times)", (kVolume + taken) / kVolume)));
    const std::string caption = record_of(dir)["caption"];  // that of another growth is another
    CHECK_THAT(caption, Catch::StartsWith(fmt::format("inflow {:.6g} m3, ", kVolume)));
    for (const char* text : {"erodible.law growth, ", "erodible.growth 0.01 1/m, ", "erodible.depth 0.5 m, "})
        CHECK_THAT(caption, Contains(text));
}

TEST_CASE("A growth that the steepest path would make more than a hundredfold is told before the run",
          "[program][inflow][erosion]") {
    const Flood plane;
    const auto told = [&](const std::string& growth) {
        const Outcome check = plane.frana(
            "check CASE --set erodible.law=growth --set erodible.depth=0.5 --set erodible.growth=" + growth);
        INFO(check.err);
        REQUIRE(check.code == 0);
        return check.out;
    };
    // From the line to the plane's last node are 105 m: exp(5.25) is 191, exp(4.2) is 67.
    CHECK_THAT(
        told("0.05"),
        Contains("remark      erodible.growth: found 0.05 /m, by which 240 m3 would become 4.57e+04 m3 over 105 m "
                 "of loose material on the steepest path, though there are only ") &&
            Contains(" m3 of it; expected growth to 100 times at most"));
    CHECK_THAT(told("10"), Contains("240 m3 would become 1e+12 m3 or more over 105 m"));  // "inf m3" before
    CHECK_THAT(told("0.04"), !Contains("erodible.growth: found"));
}
