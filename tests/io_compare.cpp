// A comparison as a person makes it: a run on disk, files of a survey, the program, what it leaves.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "catch.h"
#include "io/gdal_reader.h"
#include "io/gdal_writer.h"
#include "observe/table.h"
#include "program.h"
#include "read_raster.h"
#include "vtk_io/figures/offscreen.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

std::string feature(const std::string& type, const std::string& coordinates) {
    return R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":")" + type +
           R"(","coordinates":)" + coordinates + "}}]}";
}

const std::string footprint = feature("Polygon", "[[[15,15],[100,15],[100,85],[15,85],[15,15]]]");

std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[entry.path().string()] = text_of(entry.path());
    return files;
}

/// A slope of 30 x 20 nodes, 5 m apart, without a CRS, and a run on it.
class Slope {
public:
    explicit Slope(const std::string& formats = R"(["vtk", "geotiff"])", const std::string& survey = "") {
        std::ostringstream dem;
        dem << "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 20; ++row)
            for (int column = 0; column < 30; ++column) dem << 200.0 - 3.0 * column << (column < 29 ? ' ' : '\n');
        write_text(path() / "dem.asc", dem.str());
        write_text(path() / "release.geojson", feature("Polygon", "[[[20,30],[50,30],[50,70],[20,70],[20,30]]]"));
        write_text(path() / "footprint.geojson", footprint);
        write_text(path() / "case.toml",
                   "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 1.5\n"
                   "[material.bed]\nlaw = \"coulomb\"\nmu = 0.3\n[time]\nend = 3\n[output]\nformats = " +
                       formats + "\n" + survey);
        run = frana("run case.toml --out run --quiet");
    }
    const fs::path& path() const { return folder_.path(); }
    fs::path run_dir() const { return path() / "run"; }

    Outcome frana(const std::string& arguments) const { return call_frana(path(), arguments); }

    Outcome run;

private:
    FreshFolder folder_;
};

const char* const contract[] = {"true_positive_area",
                                "false_positive_area",
                                "false_negative_area",
                                "iou",
                                "precision",
                                "recall",
                                "f1",
                                "area_ratio",
                                "area_difference_percent",
                                "runout_difference",
                                "boundary_distance_mean",
                                "boundary_distance_p95"};

Raster peak_depth(const fs::path& run_dir) { return raster_of(run_dir, "peak_depth.tif"); }

const std::string loose = "[erodible]\ndepth = 1.0\nlaw = \"growth\"\ngrowth = 0.05\n";

/// What a second survey would see of a run.
Raster ground_change(const fs::path& run_dir) {
    Raster change = raster_of(run_dir, "bed_change.tif");
    const Raster lying = raster_of(run_dir, "final_depth.tif");
    for (std::size_t k = 0; k < change.values.size(); ++k) change.values[k] += lying.values[k];
    return change;
}

}  // namespace

TEST_CASE("compare leaves the contract's scores, a page and a picture, and they agree with the rasters", "[compare]") {
    const Slope slope;
    REQUIRE(slope.run.code == 0);
    const Outcome done = slope.frana("compare run --survey footprint.geojson");
    // the one remark: neither terrain nor survey says where on the earth it lies
    CHECK_THAT(done.err, Contains("taken as the terrain's own") && !Contains("not drawn"));
    CHECK(std::count(done.err.begin(), done.err.end(), '\n') == 1);
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(slope.run_dir() / "compare.json"));
    for (const char* key : contract) {
        CAPTURE(key);
        REQUIRE(json.contains(key));
        CHECK(json[key].is_number());
    }
    CHECK_FALSE(json.contains("volume_error"));

    // The survey's edges are those of pixels, so that a count of pixels gives the same areas.
    const Raster peak = peak_depth(slope.run_dir());
    const GridGeometry& g = peak.geometry;
    double hit = 0.0, beyond = 0.0;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const bool surveyed = g.x(i) > 15 && g.x(i) < 100 && g.y(j) > 15 && g.y(j) < 85;
            if (peak.at(i, j) > 0.1) (surveyed ? hit : beyond) += 25.0;
        }
    REQUIRE(hit > 1000.0);
    CHECK(json["true_positive_area"].get<double>() == Approx(hit).epsilon(1e-9));
    CHECK(json["false_positive_area"].get<double>() == Approx(beyond).epsilon(1e-9).margin(1e-6));
    CHECK(json["false_negative_area"].get<double>() == Approx(85 * 70 - hit).epsilon(1e-9));
    CHECK(json["iou"].get<double>() == Approx(hit / (85 * 70 + beyond)).epsilon(1e-9));
    CHECK(json["runout_path"] == "steepest path from the release");

    const std::string page = text_of(slope.run_dir() / "compare.md");
    CHECK_THAT(page, Contains("## Against the survey") && Contains("| IoU"));
    REQUIRE(hit + beyond < 85 * 70);  // so this also tells that the difference has no sign
    const double difference = 100.0 - 100.0 * (hit + beyond) / (85 * 70);
    CHECK_THAT(page, Contains(fmt::format("| area difference [%] | {:.1f} |", difference)));
    CHECK_THAT(done.out, Contains("| IoU") && Contains("compare.json"));
    if (no_renderer_reason().empty()) {
        CHECK(fs::file_size(slope.run_dir() / "figures" / "compare.png") > 1000);
        CHECK_THAT(page, Contains("figures/compare.png"));
    }
}

TEST_CASE("compare takes a path and a deposit, and writes where --json says", "[compare]") {
    const Slope slope;
    std::vector<std::string> log;
    Raster deposit =
        GdalReader().read_raster(slope.run_dir() / "rasters" / "final_depth.tif", {-1e9, -1e9, 1e9, 1e9}, "", log);
    for (double& h : deposit.values) h *= 2.0;
    write_geotiff(slope.path() / "deposit.tif", deposit, "m", "thickness");
    write_text(slope.path() / "path.geojson", feature("LineString", "[[10,50],[140,50]]"));
    const Outcome done =
        slope.frana("compare run --survey footprint.geojson --path path.geojson --deposit deposit.tif --json s.json");
    REQUIRE(done.code == 0);
    CHECK_FALSE(fs::exists(slope.run_dir() / "compare.json"));
    const Json json = Json::parse(text_of(slope.path() / "s.json"));
    CHECK(json["runout_survey"].get<double>() == Approx(90).epsilon(1e-9));
    // twice the thickness everywhere, and powers of two survive single precision
    CHECK(json["volume_error"].get<double>() == Approx(-0.5).epsilon(1e-12));
    CHECK(json["depth_mae"].get<double>() > 0.0);
    CHECK(json["depth_rmse"].get<double>() >= json["depth_mae"].get<double>());
}

TEST_CASE("A survey in the case is compared with at the end of the run", "[compare]") {
    const Slope slope(R"(["png"])", "[survey]\nfootprint = \"footprint.geojson\"\n");
    REQUIRE(slope.run.code == 0);
    const Json json = Json::parse(text_of(slope.run_dir() / "compare.json"));
    for (const char* key : contract) CHECK(json.contains(key));
    CHECK(json["iou"].get<double>() > 0.0);
    const std::string report = text_of(slope.run_dir() / "report.md");
    CHECK_THAT(report, Contains("## Against the survey") && Contains("[compare.json](compare.json)"));
    if (no_renderer_reason().empty()) CHECK_THAT(report, Contains("figures/compare.png"));
    CHECK(Json::parse(text_of(slope.run_dir() / "run.json"))["warnings"].dump().find("not compared") ==
          std::string::npos);

    const Outcome later = slope.frana("compare run --survey footprint.geojson");  // no rasters were asked for
    CHECK(later.code == 2);
    CHECK_THAT(later.err, Contains("rasters/peak_depth.tif: is not there") && Contains("add \"geotiff\""));
}

TEST_CASE("A path of the case that touches neither flow nor survey leaves the areas compared, and is told",
          "[compare]") {
    const Slope slope;
    write_text(slope.path() / "beside.geojson", feature("LineString", "[[120,2],[140,2]]"));
    write_text(slope.path() / "case.toml", text_of(slope.path() / "case.toml") +
                                               "[survey]\nfootprint = \"footprint.geojson\"\npath = "
                                               "\"beside.geojson\"\n");
    REQUIRE(slope.frana("run case.toml --out run --overwrite --quiet").code == 0);
    const Json json = Json::parse(text_of(slope.run_dir() / "compare.json"));
    CHECK(json["iou"].get<double>() > 0.0);
    CHECK(json["runout_difference"].is_null());
    CHECK_THAT(json["remarks"].dump(), Contains("touches neither what was simulated nor what was surveyed"));
    CHECK_THAT(text_of(slope.run_dir() / "report.md"), Contains("beside.geojson: found a line that touches neither"));
}

TEST_CASE("A comparison with other files than the case's stands beside the run's own, and says so", "[compare]") {
    const Slope slope(R"(["geotiff", "png"])",
                      "[survey]\nfootprint = \"footprint.geojson\"\n[[gauge]]\nname = \"g\"\npoint = [60, 50]\n");
    REQUIRE(slope.run.code == 0);
    write_text(slope.path() / "other map.geojson", feature("Polygon", "[[[15,15],[90,15],[90,85],[15,85],[15,15]]]"));
    const auto before = contents(slope.run_dir());
    const Outcome other = slope.frana("compare run --survey 'other map.geojson'");
    REQUIRE(other.code == 0);
    CHECK_THAT(other.out, Contains("has other survey files (`footprint.geojson`)") && Contains("Written:\n"));
    auto after = contents(slope.run_dir());
    for (const char* name : {"compare_with_other_map.json", "compare_with_other_map.md"}) {
        CHECK_THAT(other.out, Contains(name));
        CHECK(after.count((slope.run_dir() / name).string()) == 1);
    }
    for (const auto& [file, text] : before) {
        CAPTURE(file);
        const bool same = after[file] == text;
        if (fs::path(file).filename() != "run.json") CHECK(same);  // that lists the new files
    }
    CHECK_THAT(text_of(slope.run_dir() / "compare_with_other_map.md"), Contains("`report.md`"));

    const Outcome same = slope.frana("compare run --survey footprint.geojson");
    REQUIRE(same.code == 0);
    CHECK_THAT(same.out, Contains("the survey files of the case") && Contains("run/compare.json\n"));
    if (!no_renderer_reason().empty()) return;
    // The run, compare and figures draw the same picture, path and gauge and all.
    const fs::path picture = slope.run_dir() / "figures" / "compare.png";
    const std::string drawn = before.at(picture.string());
    CHECK(after.count((slope.run_dir() / "figures" / "compare_with_other_map.png").string()) == 1);
    const auto as_drawn = [&] { return text_of(picture) == drawn; };
    CHECK(as_drawn());
    fs::remove(picture);
    REQUIRE(slope.frana("figures run --size 1400x1200").code == 0);  // the size of a run's own
    CHECK(as_drawn());
}

TEST_CASE("Comparisons with files of the same name in other folders, or with another path, stand beside one another",
          "[compare]") {
    const Slope slope(R"(["geotiff"])", "[survey]\nfootprint = \"footprint.geojson\"\n");
    REQUIRE(slope.run.code == 0);
    for (const char* folder : {"s1", "s2"}) fs::create_directories(slope.path() / folder);
    write_text(slope.path() / "s1/f.geojson", feature("Polygon", "[[[15,15],[90,15],[90,85],[15,85],[15,15]]]"));
    write_text(slope.path() / "s2/f.geojson", feature("Polygon", "[[[15,15],[60,15],[60,85],[15,85],[15,15]]]"));
    write_text(slope.path() / "path.geojson", feature("LineString", "[[35,50],[140,50]]"));
    const auto scores = [&](const std::string& name) { return Json::parse(text_of(slope.run_dir() / name)); };
    REQUIRE(slope.frana("compare run --survey s1/f.geojson").code == 0);
    const Json first = scores("compare_with_f.json");
    const Outcome second = slope.frana("compare run --survey s2/f.geojson");
    REQUIRE(second.code == 0);
    CHECK_THAT(second.out, Contains("run/compare_with_f_2.json") && Contains("run/compare_with_f_2.md") &&
                               Contains("`compare_with_f.json` is of other files (`s1/f.geojson`), and stays."));
    CHECK(scores("compare_with_f.json") == first);
    CHECK(scores("compare_with_f_2.json")["survey"] == "s2/f.geojson");
    REQUIRE(slope.frana("compare run --survey s1/f.geojson --path path.geojson").code == 0);
    CHECK(scores("compare_with_f_3.json")["path"] == "path.geojson");
    CHECK(scores("compare_with_f.json") == first);
    // The same files come into their own place again.
    REQUIRE(slope.frana("compare run --survey " + (slope.path() / "s2/f.geojson").string()).code == 0);
    REQUIRE(slope.frana("compare run --survey s1/f.geojson --path path.geojson").code == 0);
    CHECK_FALSE(fs::exists(slope.run_dir() / "compare_with_f_4.json"));
}

TEST_CASE("compare finds the terrain of a run without VTK files, and does without when it is gone", "[compare]") {
    const Slope slope(R"(["geotiff"])");
    REQUIRE(slope.frana("compare run --survey footprint.geojson").code == 0);
    const Json with = Json::parse(text_of(slope.run_dir() / "compare.json"));
    CHECK(with["runout_difference"].is_number());
    fs::remove(slope.path() / "dem.asc");
    const Outcome done = slope.frana("compare run --survey footprint.geojson");
    CHECK(done.code == 0);
    CHECK_THAT(done.err, Contains("no terrain.vti"));
    const Json without = Json::parse(text_of(slope.run_dir() / "compare.json"));
    CHECK(without["iou"] == with["iou"]);
    CHECK(without["runout_difference"].is_null());
}

TEST_CASE("What cannot be compared leaves with 2, one sentence, and the run as it was", "[compare]") {
    const Slope slope;
    REQUIRE(slope.frana("compare run --survey footprint.geojson").code == 0);
    const auto before = contents(slope.run_dir());
    const auto refused = [&](const std::string& arguments, const std::string& what) {
        CAPTURE(arguments);
        const Outcome outcome = slope.frana("compare " + arguments);
        CHECK(outcome.code == 2);
        CHECK(outcome.out.empty());
        CHECK_THAT(outcome.err, Contains(what) && Contains("; expected "));
        CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    };
    write_text(slope.path() / "line.geojson", feature("LineString", "[[15,15],[100,15]]"));
    write_text(slope.path() / "empty.geojson", R"({"type":"FeatureCollection","features":[]})");
    write_text(slope.path() / "away.geojson", feature("Polygon", "[[[915,15],[990,15],[990,85],[915,15]]]"));
    write_text(slope.path() / "dot.geojson", feature("LineString", "[[15,15],[15,15]]"));
    write_text(slope.path() / "far.geojson", feature("LineString", "[[915,15],[990,15]]"));
    refused("run --survey line.geojson", "line.geojson: holds 1 line only");
    refused("run --survey empty.geojson", "empty.geojson: ");
    refused("run --survey away.geojson", "away.geojson: covers ");
    refused("run --survey gone.geojson", "gone.geojson: no such file");
    refused("run --survey footprint.geojson --path gone.geojson", "gone.geojson: no such file");
    refused("run --survey footprint.geojson --path footprint.geojson", "holds 1 polygon only");
    refused("run --survey footprint.geojson --path dot.geojson", "dot.geojson: ");
    refused("run --survey footprint.geojson --path far.geojson",
            "far.geojson: found no point of its line on the terrain");
    // within the terrain, and beside all that flowed or was surveyed
    write_text(slope.path() / "beside.geojson", feature("LineString", "[[120,2],[140,2]]"));
    refused("run --survey footprint.geojson --path beside.geojson",
            "beside.geojson: found a line that touches neither what was simulated nor what was surveyed");
    refused("run --survey footprint.geojson --deposit gone.tif", "gone.tif: no such file");
    refused("run --survey footprint.geojson --deposit footprint.geojson", "footprint.geojson: cannot be opened");
    refused("run --survey footprint.geojson --json footprint.geojson", "found a file that this command reads");
    refused("run --survey footprint.geojson --json run/rasters/peak_depth.tif", "found a file that this command reads");
    refused("nowhere --survey footprint.geojson", "nowhere/run.json: cannot be read");
    refused("run", "found no survey");
    CHECK(slope.frana("compare run --bed-change footprint.geojson --deposit footprint.geojson").code == 2);
    CHECK(contents(slope.run_dir()) == before);
}

TEST_CASE("A survey that says nothing stops a run before its first step, with the case's line", "[compare]") {
    const Slope slope;
    const auto before = contents(slope.run_dir());
    REQUIRE(before.size() > 5);
    write_text(slope.path() / "away.geojson", feature("Polygon", "[[[915,15],[990,15],[990,85],[915,15]]]"));
    write_text(slope.path() / "line.geojson", feature("LineString", "[[15,15],[100,15]]"));
    const std::string given = text_of(slope.path() / "case.toml");
    for (const auto& [name, what] : {std::pair{"away", "does not touch the terrain"}, {"line", "holds 1 line only"}}) {
        write_text(slope.path() / "case.toml", given + "[survey]\nfootprint = \"" + name + ".geojson\"\n");
        for (const char* command : {"run case.toml --out run --overwrite --quiet", "check case.toml"}) {
            const Outcome outcome = slope.frana(command);
            CAPTURE(command, outcome.err);
            CHECK(outcome.code == 2);
            CHECK_THAT(outcome.err, Contains("case.toml:14: survey.footprint: ") && Contains(what));
        }
    }
    CHECK(contents(slope.run_dir()) == before);
}

TEST_CASE("A picture that cannot be drawn is a warning; scores that cannot be written are an error", "[compare]") {
    const Slope slope(R"(["geotiff"])");
    write_text(slope.run_dir() / "figures", "a file where the folder should be");
    const Outcome no_picture = slope.frana("compare run --survey footprint.geojson");
    CHECK(no_picture.code == 0);
    CHECK_THAT(no_picture.err, Contains("figures/compare.png was not drawn"));
    CHECK(fs::exists(slope.run_dir() / "compare.json"));
    const Outcome no_scores = slope.frana("compare run --survey footprint.geojson --json nowhere/scores.json");
    CHECK(no_scores.code == 2);
    CHECK_THAT(no_scores.err, Contains("nowhere/scores.json"));
}

TEST_CASE("compare holds changes of the ground against a survey, in total and along the path",
          "[compare][bed_change]") {
    const Slope slope(R"(["vtk", "geotiff"])", loose);
    // Longer than the others, so that the flow leaves ground that it eroded.
    REQUIRE(slope.frana("run case.toml --out run --overwrite --quiet --set time.end=7").code == 0);
    Raster twice = ground_change(slope.run_dir());
    for (double& change : twice.values) change *= 2.0;
    write_geotiff(slope.path() / "dod.tif", twice, "m", "after minus before");
    const std::string compare = "compare run --survey footprint.geojson";
    const Outcome done = slope.frana(compare + " --bed-change dod.tif --bed-change-noise 0");
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(slope.run_dir() / "compare.json"))["bed_change"];
    constexpr double single = 1e-6;  // of the files
    CHECK(json["simulated"]["eroded"].get<double>() > 10.0);
    CHECK(json["simulated"]["deposited"].get<double>() > 10.0);
    CHECK(json["eroded_error"].get<double>() == Approx(-0.5).epsilon(single));
    CHECK(json["deposited_error"].get<double>() == Approx(-0.5).epsilon(single));
    CHECK(json["misplaced_share"].get<double>() < single);
    CHECK(json["rmse"].get<double>() >= json["mae"].get<double>());
    const Table table = read_table(slope.run_dir() / "compare_bed_change.csv");
    REQUIRE(table.rows() > 5);
    for (const std::string what : {"eroded", "deposited"}) {
        double sum = 0.0;
        for (const double volume : table.column("surveyed_" + what)) sum += volume;
        CHECK(sum == Approx(json["surveyed"][what].get<double>()));
    }
    CHECK(table.column("simulated_balance").back() ==
          Approx(json["simulated"]["deposited"].get<double>() - json["simulated"]["eroded"].get<double>()));
    CHECK_THAT(text_of(slope.run_dir() / "compare.md"), Contains("| Change of the ground against `dod.tif`"));
    if (no_renderer_reason().empty()) CHECK(fs::exists(slope.run_dir() / "figures" / "compare_bed_change.png"));

    // Alone it has the same errors, and no scores of an extent.
    const Outcome alone = slope.frana("compare run --bed-change dod.tif --bed-change-noise 0");
    REQUIRE(alone.code == 0);
    const Json of_alone = Json::parse(text_of(slope.run_dir() / "compare.json"));
    CHECK(of_alone["bed_change"] == json);
    CHECK_FALSE(of_alone.contains("iou"));
    CHECK_THAT(alone.out, Contains("| Change of the ground against `dod.tif`") && Contains("compare_bed_change.csv") &&
                              !Contains("IoU") && !Contains("figures/compare.png"));

    // An answer from another comparison does not stay.
    REQUIRE(slope.frana(compare).code == 0);
    CHECK_FALSE(Json::parse(text_of(slope.run_dir() / "compare.json")).contains("bed_change"));
    CHECK_FALSE(fs::exists(slope.run_dir() / "compare_bed_change.csv"));
}

TEST_CASE("Changes of the ground in a case are compared at the end; what cannot be is refused",
          "[compare][bed_change]") {
    const Slope rock;
    const Raster any = raster_of(rock.run_dir(), "peak_depth.tif");
    write_geotiff(rock.path() / "dod.tif", Raster::filled(any.geometry, -0.25), "m", "after minus before");
    GridGeometry east = any.geometry;
    east.x0 += 5000.0;
    write_geotiff(rock.path() / "away.tif", Raster::filled(east, -0.25), "m", "after minus before");
    const std::string compare = "compare run --survey footprint.geojson --bed-change ";
    const Outcome no_bed = rock.frana(compare + "dod.tif");
    CHECK(no_bed.code == 2);
    CHECK_THAT(no_bed.err, Contains("bed_change.tif: is not there, since the run's bed did not change; expected"));
    write_text(rock.path() / "case.toml",
               text_of(rock.path() / "case.toml") + loose +
                   "[survey]\nfootprint = \"footprint.geojson\"\nbed_change = \"dod.tif\"\n");
    REQUIRE(rock.frana("run case.toml --out run --overwrite --quiet").code == 0);
    const Json json = Json::parse(text_of(rock.run_dir() / "compare.json"))["bed_change"];
    CHECK(json["surveyed"]["eroded"].get<double>() > 0.0);
    CHECK(json["noise"] == 0.1);
    const std::string report = text_of(rock.run_dir() / "report.md");
    CHECK_THAT(report, Contains("| Change of the ground against") && Contains("compare_bed_change.csv"));
    const Outcome away = rock.frana(compare + "away.tif");
    CHECK(away.code == 2);
    CHECK_THAT(away.err, Contains("away.tif: covers") && Contains("does not touch the terrain"));
    CHECK(rock.frana("check case.toml --set survey.bed_change=\"away.tif\"").code == 2);
}
