// `frana ensemble` as a person calls it, on problems whose probabilities are known.
#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "expected_means.h"
#include "fresh_folder.h"
#include "io/hdf5_peaks.h"
#include "plane_case.h"
#include "pond.h"
#include "read_raster.h"
#include "run/ensemble/kept_peaks.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const std::string depths =
    "[ensemble]\ncase = \"case.toml\"\nmethod = \"lhs\"\nsamples = 20\nfields = [\"peak_depth\", \"peak_speed\"]\n"
    "exceed = { peak_depth = [1.25] }\nquantiles = [0.05, 0.5, 0.95]\n"
    "[[ensemble.vary]]\nkey = \"release.0.depth\"\nrange = [1.0, 2.0]\n";

/// The same with another number of samples.
std::string of_samples(int count) {
    std::string text = depths;
    return text.replace(text.find("samples = 20"), 12, fmt::format("samples = {}", count));
}

/// All files of the maps, but the pictures and what tells of the clock.
std::vector<std::string> whole(const fs::path& folder) {
    std::vector<std::string> all = {text_of(folder / "runs.csv"), text_of(folder / "samples.csv")};
    std::vector<fs::path> rasters;
    for (const auto& entry : fs::directory_iterator(folder / "rasters")) rasters.push_back(entry.path());
    std::sort(rasters.begin(), rasters.end());
    for (const fs::path& file : rasters) all.push_back(file.filename().string() + text_of(file));
    return all;
}

}  // namespace

TEST_CASE("an ensemble of ponds has the probabilities and quantiles of their depths", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml", depths);
    const Outcome done = pond.frana("ensemble many.toml --out many --threads 2");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    CHECK_THAT(done.out, Contains("20 of 20 runs"));
    // A slice of 20 in one key: shares are right to 1/20, quantiles to a slice's width.
    const frana::Raster p = pond.map("many", "probability_peak_depth_1.25"),
                        middle = pond.map("many", "quantile_peak_depth_0.5"),
                        low = pond.map("many", "quantile_peak_depth_0.05");
    for (std::size_t k = 0; k < p.values.size(); ++k) {
        CHECK(p.values[k] == Approx(0.75).margin(0.0500001));
        CHECK(middle.values[k] == Approx(1.5).margin(0.0500001));
        CHECK(low.values[k] == Approx(1.05).margin(0.0500001));
    }
    const Json json = Json::parse(text_of(pond.path("many/ensemble.json")));
    CHECK(json["run"] == 20);
    CHECK(json["failed"] == 0);
    CHECK(json["results"]["max_depth_m"]["mean"].get<double>() == Approx(1.5).margin(0.025));  // of stratified means
    for (const Json& file : json["files"]) CHECK(fs::exists(pond.path("many") / file.get<std::string>()));
    CHECK_THAT(text_of(pond.path("many/report.md")),
               Contains("largest depth [m]") &&
                   Contains("| 5 % of the runs stay below | 50 % of the runs stay below |") &&
                   Contains("- `release.0.depth`: uniform, 1 to 2 m\n"));

    SECTION("another threshold needs no run") {
        const Outcome more = pond.frana("ensemble --join many --exceed peak_depth=1.75 --quiet");
        CHECK(more.err.empty());
        REQUIRE(more.code == 0);
        CHECK(pond.map("many", "probability_peak_depth_1.75").values[40] == Approx(0.25).margin(0.0500001));
    }
    SECTION("a sample is a case of its own") {
        const Outcome again = pond.frana("ensemble many.toml --out many --again 7");
        REQUIRE(again.code == 0);
        CHECK_THAT(again.out, Contains("frana run many/sample_7/case.toml"));
        const Outcome quoted = pond.frana("ensemble many.toml --out 'a folder' --again 7");
        CHECK(quoted.out == "frana run 'a folder/sample_7/case.toml' --out 'a folder/sample_7/run'\n");
        CHECK(pond.frana("run many/sample_7/case.toml --out again --quiet --set 'output.formats=[\"geotiff\"]'").code ==
              0);
        std::string row = text_of(pond.path("many/samples.csv"));
        const double depth = std::stod(row.substr(row.find("\n7,1,") + 5));
        CHECK(pond.map("again", "peak_depth").values[40] == Approx(depth).epsilon(1e-6));
    }
    SECTION("the folder is not run into again without a word") {
        const Outcome second = pond.frana("ensemble many.toml --out many");
        CHECK(second.code == 2);
        CHECK_THAT(second.err, Contains("found the runs of an earlier ensemble") && Contains("--resume"));
        pond.write("many.toml", depths + "levels = 3\n");
        CHECK(pond.frana("ensemble many.toml --out many --resume").code == 2);
        pond.write("many.toml", of_samples(30));
        const Outcome differs = pond.frana("ensemble many.toml --out many --resume");
        CHECK(differs.code == 2);
        CHECK_THAT(differs.err, Contains("found \"samples 20\" where now it is \"samples 30\""));
    }
}

TEST_CASE("an ensemble has the same bytes on any number of threads, in shards, and after being killed", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml", of_samples(300));  // more than are written at once
    REQUIRE(pond.frana("ensemble many.toml --out one --threads 1 --quiet").code == 0);
    const std::vector<std::string> expected = whole(pond.path("one"));
    CHECK(expected.size() > 8);
    REQUIRE(pond.frana("ensemble many.toml --out four --threads 4 --quiet").code == 0);
    CHECK(whole(pond.path("four")) == expected);
    for (const char* shard : {"2/3", "0/3", "1/3"})  // in any order
        REQUIRE(pond.frana(std::string("ensemble many.toml --out parts --quiet --shard ") + shard).code == 0);
    REQUIRE(pond.frana("ensemble --join parts --quiet").code == 0);
    CHECK(whole(pond.path("parts")) == expected);
    // Killed early and late, in the middle of what it writes: whatever was kept is whole.
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    for (const char* seconds : {"0.1", "0.15", "0.2", "0.25", "0.3", "0.35", "0.4", "0.5"})
        static_cast<void>(std::system(
            fmt::format("cd {} && timeout --foreground -s KILL {} {} ensemble many.toml --out killed --resume "
                        "--quiet > /dev/null 2>&1",
                        pond.path("").string(), seconds, program.string())
                .c_str()));
    const Outcome last = pond.frana("ensemble many.toml --out killed --resume --quiet");
    CHECK(last.err.empty());
    REQUIRE(last.code == 0);
    CHECK(whole(pond.path("killed")) == expected);
}

TEST_CASE("a disk that fills up ends an ensemble with one sentence, and what it stored goes on", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml", of_samples(300));
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    // No file may be larger than 8 blocks of 512 or 1024 bytes.
    const int status =
        std::system(fmt::format("cd {} && sh -c \"trap '' XFSZ; ulimit -f 8; {} ensemble many.toml --out full "
                                "--threads 4 --quiet\" > out.txt 2> err.txt",
                                pond.path("").string(), program.string())
                        .c_str());
    CHECK(WEXITSTATUS(status) == 2);
    CHECK_THAT(text_of(pond.path("err.txt")), Contains("cannot be written"));
    REQUIRE(pond.frana("ensemble many.toml --out full --resume --quiet").code == 0);
    for (const double p : pond.map("full", "probability_reached").values) CHECK(p == Approx(1.0));
}

TEST_CASE("runs join only with what they were made of; what was refused is tried again", "[ensemble]") {
    const Pond pond;
    const std::string by_table =
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nfields = [\"peak_depth\"]\n";
    pond.write("many.toml", by_table);
    pond.write("rows.csv", "release.0.depth,release.0.outline\n0.5,\"all.geojson\"\n0.6,\"later.geojson\"\n");
    CHECK(pond.frana("ensemble many.toml --out many --quiet").code == 3);
    fs::copy_file(pond.path("all.geojson"), pond.path("later.geojson"));
    REQUIRE(pond.frana("ensemble many.toml --out many --resume --quiet").code == 0);
    CHECK(Json::parse(text_of(pond.path("many/ensemble.json")))["failed"] == 0);
    pond.write("rows.csv", "release.0.depth,release.0.outline\n5.0,\"all.geojson\"\n6.0,\"later.geojson\"\n");
    CHECK_THAT(pond.frana("ensemble --join many").err, Contains("expected runs of the same ensemble"));

    pond.write("many.toml", depths);
    REQUIRE(pond.frana("ensemble many.toml --out other --quiet").code == 0);
    const std::string dem = text_of(pond.path("dem.asc"));
    pond.write("dem.asc",
               "ncols 6\nnrows 6\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n" +
                   std::string("0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n"));
    const Outcome moved = pond.frana("ensemble --join other");
    CHECK(moved.code == 2);
    CHECK_THAT(moved.err, Contains("expected runs of the same ensemble") && Contains("give the files back"));
}

TEST_CASE("Runs whose values name a file that has changed join no others", "[ensemble]") {
    const Pond pond;
    fs::copy_file(pond.path("west.geojson"), pond.path("part.geojson"));
    const std::string vary =
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"sobol\"\nsamples = 8\nfields = [\"peak_depth\"]\n"
        "[[ensemble.vary]]\nkey = \"release.0.outline\"\ndistribution = \"discrete\"\n"
        "values = [\"all.geojson\", \"part.geojson\"]\n";
    const std::string table =
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nfields = [\"peak_depth\"]\n";
    pond.write("rows.csv", "release.0.outline\nall.geojson\npart.geojson\n");
    const std::string text = GENERATE_REF(vary, table);
    CAPTURE(text);
    pond.write("many.toml", text);
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const std::string part = text_of(pond.path("part.geojson"));
    pond.write("part.geojson", text_of(pond.path("all.geojson")));
    for (const char* how : {"ensemble many.toml --out many --resume", "ensemble --join many"}) {
        const Outcome changed = pond.frana(how);
        CHECK(changed.code == 2);
        CHECK_THAT(changed.err, Contains("made with another content of release.0.outline=part.geojson") &&
                                    Contains("give the files back"));
    }
    pond.write("part.geojson", part);
    CHECK(pond.frana("ensemble --join many --quiet").code == 0);
    const std::vector<std::string> outlines = pond.column("many", "release.0.outline");
    CHECK(std::count(outlines.begin(), outlines.end(), "part.geojson") == static_cast<long>(outlines.size()) / 2);
    CHECK_THAT(text_of(pond.path("many/samples.csv")), !Contains("'") && !Contains("\""));
}

TEST_CASE("Sobol's samples can be prolonged: those that have run stay", "[ensemble]") {
    const Pond pond;
    std::string few = depths;
    few.replace(few.find("\"lhs\""), 5, "\"sobol\"").replace(few.find("samples = 20"), 12, "samples = 16");
    pond.write("many.toml", few);
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    few.replace(few.find("samples = 16"), 12, "samples = 32");
    pond.write("many.toml", few);
    const Outcome more = pond.frana("ensemble many.toml --out many --resume");
    REQUIRE(more.code == 0);
    CHECK_THAT(more.out, Contains("16 of 16 runs, 0 failed"));  // the new ones
    CHECK(Json::parse(text_of(pond.path("many/ensemble.json")))["run"] == 32);
    const Outcome other = pond.frana("ensemble many.toml --out many --shard 1/2 --quiet");
    CHECK(other.code == 0);  // runs again what it could have taken; the maps are the same
    few.replace(few.find("samples = 32"), 12, "samples = 8");
    pond.write("many.toml", few);
    const Outcome fewer = pond.frana("ensemble many.toml --out many --resume");
    CHECK(fewer.code == 2);
    CHECK_THAT(fewer.err, Contains("found 32 runs, the last of them sample 31, where samples is 8") &&
                              Contains("give samples = 32") && !Contains("remove"));
}

// What is refused is tried again with the new ones. Their peaks must not take the place of those that are there.
TEST_CASE("Samples can be prolonged twice when one of the first is always refused", "[ensemble]") {
    const Pond pond;
    const auto write = [&](int samples) {
        pond.write("many.toml",
                   "[ensemble]\ncase = \"case.toml\"\nmethod = \"sobol\"\nsamples = " + std::to_string(samples) +
                       "\nfields = [\"peak_depth\"]\n[[ensemble.vary]]\nkey = \"release.0.outline\"\n"
                       "distribution = \"discrete\"\nvalues = [\"all.geojson\", \"gone.geojson\"]\n"
                       "weights = [0.75, 0.25]\n");
    };
    for (const int samples : {8, 16, 32}) {
        write(samples);
        const Outcome done =
            pond.frana(std::string("ensemble many.toml --out many --quiet") + (samples > 8 ? " --resume" : ""));
        CHECK(done.code == 3);  // more than 5 % failed
    }
    const Outcome joined = pond.frana("ensemble --join many");
    CAPTURE(joined.err);
    CHECK(joined.code == 3);
    const Json page = Json::parse(text_of(pond.path("many/ensemble.json")));
    CHECK(page["run"] == 32);
    CHECK(page["failed"] == 8);
    for (const double p : pond.map("many", "probability_reached").values) CHECK(p == Approx(1.0));
}

TEST_CASE("scenarios count by their weights", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\nexceed = { peak_depth = [1.0] }\n"
               "[[ensemble.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\nvalues = [0.5, 1.5]\n"
               "weights = [0.3, 0.7]\n");
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    for (const double p : pond.map("many", "probability_peak_depth_1").values) CHECK(p == Approx(0.7).epsilon(1e-6));
    for (const double p : pond.map("many", "probability_reached").values) CHECK(p == Approx(1.0));
}

TEST_CASE("a run's way begins at its own release, and not where one enters that never does", "[ensemble]") {
    const PlaneCase plane;
    const std::string laws = "[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n";
    const auto square = [&](const char* name, double x) {
        frana::write_text(plane.folder() / name,
                          fmt::format(R"({{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties":
                          {{}}, "geometry": {{"type": "Polygon", "coordinates":
                          [[[{0}, 30], [{1}, 30], [{1}, 70], [{0}, 70], [{0}, 30]]]}}}}]}})",
                                      x, x + 30));
    };
    square("lower.geojson", 50.0);
    square("far.geojson", 115.0);
    plane.write(laws + "[[release]]\noutline = \"far.geojson\"\ndepth = 1.5\nwhen_hit = true\n");
    frana::write_text(plane.folder() / "rows.csv", "release.0.outline\nrelease.geojson\nlower.geojson\n");
    frana::write_text(plane.folder() / "many.toml",
                      "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n");
    REQUIRE(plane.frana("ensemble many.toml --out many --quiet").code == 0);
    std::istringstream runs(text_of(plane.folder() / "many/runs.csv"));
    std::string line;
    std::getline(runs, line);
    std::vector<std::string> head;
    for (std::istringstream cells(line); std::getline(cells, line, ',');) head.push_back(line);
    const auto column = std::find(head.begin(), head.end(), "runout_m") - head.begin();
    std::vector<double> runout;
    while (std::getline(runs, line)) {
        std::istringstream cells(line);
        for (std::ptrdiff_t n = 0; n <= column; ++n) std::getline(cells, line, ',');
        runout.push_back(std::stod(line));
    }
    REQUIRE(runout.size() == 2);
    // On a plane both go as far, to a pixel: 30 m lower, and in 2 s not as far as the release beyond.
    CHECK(runout[0] > 10.0);
    CHECK(std::abs(runout[0] - runout[1]) <= 5.0);
}

TEST_CASE("runs that fail count by their weight", "[ensemble]") {
    const Pond pond;
    pond.write(
        "rows.csv",
        "weight,release.0.outline,release.0.depth\n10,all.geojson,0.5\n29,all.geojson,1.5\n1,gone.geojson,1.5\n");
    const std::string text =
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nexceed = { peak_depth = [1.0] }\n";
    pond.write("many.toml", text);
    // A third of the rows, and a fortieth of the weight.
    const Outcome light = pond.frana("ensemble many.toml --out light");
    CHECK(light.code == 0);
    CHECK_THAT(light.out, Contains("1 with 0.025 of the weight failed: had these exceeded a threshold nowhere, a "
                                   "probability p of the maps would "
                                   "be 0.975 p, and had they exceeded it everywhere, 0.975 p + 0.025"));
    CHECK(Json::parse(text_of(pond.path("light/ensemble.json")))["failed_share"].get<double>() == Approx(0.025));
    for (const double p : pond.map("light", "probability_peak_depth_1").values)
        CHECK(p == Approx(29.0 / 39.0).epsilon(1e-6));
    pond.write(
        "rows.csv",
        "weight,release.0.outline,release.0.depth\n10,all.geojson,0.5\n20,all.geojson,1.5\n10,gone.geojson,1.5\n");
    const Outcome heavy = pond.frana("ensemble many.toml --out heavy");
    CHECK(heavy.code == 3);
    CHECK_THAT(heavy.err, Contains("1 of 3 runs failed, more than 5 % of the weight"));
}

TEST_CASE("Of a run that is refused the table of runs has no numbers", "[ensemble]") {
    const Pond pond;
    pond.write("case.toml", text_of(pond.path("case.toml")) + "[survey]\nfootprint = \"west.geojson\"\n");
    pond.write("many.toml", "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n");
    pond.write("rows.csv", "release.0.outline\nall.geojson\ngone.geojson\n");
    CHECK(pond.frana("ensemble many.toml --out many --quiet").code == 3);
    REQUIRE(pond.column("many", "reason").at(1) == "refused");
    for (const char* name : {"runout_m", "reach_m", "footprint_area_m2", "volume_m3", "max_depth_m", "max_speed_m_s",
                             "iou", "boundary_m", "left_share", "mass_error"}) {
        CAPTURE(name);
        CHECK_FALSE(pond.column("many", name).at(0).empty());
        CHECK(pond.column("many", name).at(1).empty());
    }
}

TEST_CASE("runs that fail are counted and bound the maps, and stop no other", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml",
               "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\nexceed = { peak_depth = [1.0] }\n"
               "[[ensemble.vary]]\nkey = \"release.0.outline\"\ndistribution = \"discrete\"\n"
               "values = [\"all.geojson\", \"gone.geojson\"]\n"
               "[[ensemble.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\nvalues = [0.5, 1.5]\n");
    const Outcome done = pond.frana("ensemble many.toml --out many");
    CHECK(done.code == 3);
    CHECK_THAT(done.err, Contains("2 of 4 runs failed, more than 5 %"));
    CHECK_THAT(done.err, Contains("the first one so: ") && Contains("gone.geojson"));
    CHECK_THAT(done.out, Contains("remark      dem.asc: no CRS"));
    CHECK_THAT(text_of(pond.path("many/report.md")),
               Contains("\nRemarks on the case:\n\n- ") && Contains("\n- dem.asc: no CRS") &&
                   Contains("\n\nThe first run that failed says: ") && Contains("gone.geojson"));
    const Json record = Json::parse(text_of(pond.path("many/ensemble.json")));
    CHECK_THAT(record["remarks"].dump(), Contains("\"dem.asc: no CRS"));
    CHECK_THAT(record["first_failure"].get<std::string>(), Contains("gone.geojson"));
    CHECK_THAT(pond.frana("ensemble many.toml --out other --check").out, Contains("remark      dem.asc: no CRS"));
    CHECK_THAT(done.out, Contains("between k and k + 2"));
    CHECK_THAT(text_of(pond.path("many/runs.csv")), Contains("refused") && Contains("gone.geojson"));
    for (const double p : pond.map("many", "probability_peak_depth_1").values) CHECK(p == Approx(0.5));
    for (const double p : pond.map("many", "probability_peak_depth_1_low").values) CHECK(p == Approx(0.25));
    for (const double p : pond.map("many", "probability_peak_depth_1_high").values) CHECK(p == Approx(0.75));
    CHECK(Json::parse(text_of(pond.path("many/ensemble.json")))["failed"] == 2);
}

TEST_CASE("runs that still move at time.end are told, whether or not they may stop at rest", "[ensemble]") {
    const PlaneCase plane;
    const std::string stops = GENERATE("true", "false");
    CAPTURE(stops);
    plane.write("stop_at_rest = " + stops + "\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n");
    std::string text = text_of(plane.file());  // after 2 s all are slower than two cells in that time
    frana::write_text(plane.file(), text.replace(text.find("end = 2"), 7, "end = 12"));
    frana::write_text(plane.folder() / "many.toml",
                      "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\n[[ensemble.vary]]\nkey = "
                      "\"material.bed.mu\"\ndistribution = \"discrete\"\nvalues = [0.05, 0.06, 3.0]\n");
    const Outcome done = plane.frana("ensemble many.toml --out many");
    INFO(done.err);
    REQUIRE(done.code == 0);
    CHECK(Json::parse(text_of(plane.folder() / "many/ensemble.json"))["not_at_rest"] == 2);
    CHECK_THAT(done.out, Contains("2 still moved at time.end"));
    REQUIRE(plane.frana("ensemble many.toml --out many --resume").code == 0);
    CHECK(Json::parse(text_of(plane.folder() / "many/ensemble.json"))["not_at_rest"] == 2);
}

TEST_CASE("Runs without weight are not among those that still moved", "[ensemble]") {
    const PlaneCase plane;
    plane.write("[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n");
    frana::write_text(plane.folder() / "rows.csv", "weight,material.bed.mu\n0,0.05\n1,3.0\n1,0.06\n");
    frana::write_text(plane.folder() / "many.toml",
                      "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\n");
    REQUIRE(plane.frana("ensemble many.toml --out many --quiet").code == 0);
    CHECK(Json::parse(text_of(plane.folder() / "many/ensemble.json"))["not_at_rest"] == 1);
}

TEST_CASE("an ensemble replaces no files that no ensemble left, and no sample of another one", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml", of_samples(2));
    REQUIRE(pond.frana("run case.toml --out run --quiet").code == 0);
    const std::string report = text_of(pond.path("run/report.md"));
    for (const char* how : {"--out run", "--out run --resume"}) {
        const Outcome refused = pond.frana(std::string("ensemble many.toml ") + how);
        CHECK(refused.code == 2);
        CHECK_THAT(refused.err, Contains("run: found figures/") && Contains("which an ensemble would replace"));
    }
    CHECK(text_of(pond.path("run/report.md")) == report);
    CHECK_FALSE(fs::exists(pond.path("run/shards")));

    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    REQUIRE(pond.frana("ensemble many.toml --out many --again 1").code == 0);
    const std::string sample = text_of(pond.path("many/sample_1/case.toml"));
    pond.write("other.toml", of_samples(3));
    const Outcome other = pond.frana("ensemble other.toml --out many --again 1");
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("\"samples 2\" where now it is \"samples 3\""));
    CHECK(text_of(pond.path("many/sample_1/case.toml")) == sample);
    REQUIRE(pond.frana("ensemble other.toml --out empty --again 1").code == 0);
    CHECK_THAT(pond.frana("ensemble many.toml --out empty --again 1").err, Contains("found another case there"));
}

TEST_CASE("an ensemble's forecast, job script and mistakes", "[ensemble]") {
    const Pond pond;
    pond.write("many.toml", depths);
    const Outcome check = pond.frana("ensemble many.toml --out many --check");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("20 samples by \"lhs\"") && Contains("core seconds") &&
                              Contains("release.0.depth=1.") &&
                              Contains("MB of peaks on disk, maps and figures come on top"));
    CHECK_FALSE(fs::exists(pond.path("many")));
    const Outcome script = pond.frana("ensemble many.toml --out many --slurm 40");
    CHECK(script.code == 0);
    CHECK_THAT(script.out, Contains("--array=0-39") && Contains("$SLURM_ARRAY_TASK_ID/40") && Contains("--join"));
    const Outcome odd = pond.frana("ensemble many.toml --out \"it's \\$HOME of\" --slurm 2");
    REQUIRE(odd.code == 0);
    const std::string folder = fs::absolute(pond.path("it's $HOME of")).string();
    const std::string lead = folder.substr(0, folder.size() - 11);  // up to the apostrophe
    CHECK_THAT(odd.out, Contains(" --out '" + lead + "'\\''s $HOME of' --shard"));
    const std::string mark = "# afterwards: ";
    const std::size_t line = odd.out.find(mark) + mark.size();
    pond.write("job.sh", "sbatch() { eval \"set -- $3\"; echo \"$5\"; }\n" +
                             odd.out.substr(line, odd.out.find('\n', line) - line) + "\n");
    REQUIRE(std::system(fmt::format("sh {0}/job.sh > {0}/words.txt", pond.path(".").string()).c_str()) == 0);
    CHECK(text_of(pond.path("words.txt")) == folder + "\n");
    for (const char* shard : {"4/4", "5/4", "-1/4", "1", "a/b"}) {
        CAPTURE(shard);
        const Outcome wrong = pond.frana(std::string("ensemble many.toml --out many --shard=") + shard);
        CHECK(wrong.code == 2);
        CHECK_THAT(wrong.err, Contains("expected I/N with I from 0 to N - 1"));
    }
    CHECK_THAT(pond.frana("ensemble --out many").err, Contains("FILE: found none"));
    CHECK_THAT(pond.frana("ensemble many.toml").err, Contains("--out: found none"));
    CHECK_THAT(pond.frana("ensemble --join none").err, Contains("expected the folder of an ensemble"));
    CHECK_THAT(pond.frana("ensemble many.toml --out many --again 20").err, Contains("expected a sample from 0 to 19"));
    std::string low = depths;
    low.replace(low.find("[1.25]"), 6, "[0.05]");
    pond.write("many.toml", low);
    CHECK_THAT(pond.frana("ensemble many.toml --out many").err, Contains("output.footprint_depth = 0.1 m"));
}

TEST_CASE("the shipped ensemble has the means that its README promises, as far as fewer runs can tell", "[ensemble]") {
    const FreshFolder folder;
    const fs::path shipped = fs::path(FRANA_SOURCE_DIR) / "cases" / "ensemble";
    std::string text = text_of(shipped / "ensemble.toml");
    text.replace(text.find("samples = 1024"), 14, "samples = 64");
    text.replace(text.find("\"case.toml\""), 11, "\"" + (shipped / "case.toml").string() + "\"");
    frana::write_text(folder.path() / "few.toml", text);
    const Outcome done = call_frana(folder.path(), "ensemble few.toml --out few --threads 2 --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(folder.path() / "few/ensemble.json"));
    CHECK(json["failed"] == 0);
    const auto mean_of = [&](const std::string& key) { return json["results"][key]["mean"].get<double>(); };
    CHECK(check_means(shipped / "expected.csv", mean_of) == 5);
    // Sample 5 is the same run here and there, alone or among others.
    CHECK(call_frana(folder.path(), "ensemble few.toml --out few --again 5").code == 0);
    REQUIRE(
        call_frana(folder.path(), "run few/sample_5/case.toml --out alone --quiet --set 'output.formats=[]'").code ==
        0);
    const Json alone = Json::parse(text_of(folder.path() / "alone/run.json"));
    std::istringstream rows(text_of(folder.path() / "few/runs.csv"));
    std::string line;
    while (std::getline(rows, line) && line.rfind("5,", 0) != 0) continue;
    const std::string depth = fmt::format(",{},", alone["results"]["max_depth"].get<double>());
    CHECK_THAT(line, Contains(depth));
}

TEST_CASE("runs of a case with a survey say how near they come to it", "[ensemble]") {
    const Pond pond;
    const std::string text = text_of(pond.path("case.toml"));
    pond.write("case.toml", text + "[survey]\nfootprint = \"west.geojson\"\n");
    pond.write("many.toml", depths);
    REQUIRE(pond.frana("ensemble many.toml --out many --quiet").code == 0);
    const std::string runs = text_of(pond.path("many/runs.csv"));
    CHECK_THAT(runs, Contains(",iou,boundary_m,"));
    // All of the pond is wet; surveyed are 25 x 55 m of its 60 x 60.
    CHECK_THAT(runs, Contains(fmt::format(",{:.9g}", 1375.0 / 3600.0).substr(0, 10)));
    CHECK_THAT(text_of(pond.path("many/report.md")), Contains("Nearest to the surveyed footprint"));
}

TEST_CASE("A run of an ensemble is as far from the survey, and reaches as far, as its comparison says", "[ensemble]") {
    const PlaneCase plane;
    frana::write_text(plane.folder() / "survey.geojson",
                      R"({"type": "Polygon", "coordinates": [[[17, 28], [71, 33], [66, 72], [17, 66], [17, 28]]]})");
    plane.write("[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n[survey]\nfootprint = \"survey.geojson\"\n");
    frana::write_text(plane.folder() / "many.toml",
                      "[ensemble]\ncase = \"case.toml\"\nmethod = \"grid\"\n[[ensemble.vary]]\nkey = "
                      "\"material.bed.mu\"\ndistribution = \"discrete\"\nvalues = [0.05]\n");
    REQUIRE(plane.frana("run CASE --out one --quiet").code == 0);
    const Json one = Json::parse(text_of(plane.folder() / "one/compare.json"));
    REQUIRE(plane.frana("ensemble many.toml --out many --quiet").code == 0);
    const std::string runs = text_of(plane.folder() / "many/runs.csv");
    const auto told = [&](const char* name) { return std::stod(column_of(runs, name).at(0)); };
    CHECK(told("boundary_m") == Approx(one["boundary_distance_mean"].get<double>()).epsilon(1e-9));
    CHECK(told("reach_m") == Approx(one["reach_simulated"].get<double>()).epsilon(1e-9));
    CHECK(told("runout_m") == Approx(one["runout_simulated"].get<double>()).epsilon(1e-9));
}

TEST_CASE("What flowed is what was released and taken of the bed, once however often it became bed",
          "[ensemble][deposition]") {
    // A slide comes to rest. Another one follows, takes of what lies there, and leaves in part by the lower side.
    const double density = 1600.0, released = 2.0 * 1.5 * 30.0 * 40.0;
    const bool deposits = GENERATE(true, false);
    CAPTURE(deposits);
    const PlaneCase plane;
    const std::string release = "[[release]]\noutline = \"release.geojson\"\ndepth = 1.5\n",
                      loose = "[erodible]\nlaw = \"growth\"\ngrowth = 0.05\ndepth = ";
    frana::write_text(plane.file(), "[terrain]\ndem = \"dem.asc\"\n" + release + release +
                                        "at = 8\nvelocity = [18.0, 0.0]\n[time]\nend = 30\n[material]\ndensity = 1600\n"
                                        "[material.bed]\nlaw = \"coulomb\"\nmu = 0.2\n" +
                                        loose + (deposits ? "0.0\n[deposition]\nlaw = \"rest\"\ntime = 1\n" : "0.4\n"));
    frana::write_text(plane.folder() / "many.toml",
                      "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"rows.csv\"\nquantiles = [0.5]\n"
                      "fields = [\"eroded_depth\", \"bed_change\"]\nexceed = { eroded_depth = [0.1] }\n");
    frana::write_text(plane.folder() / "rows.csv", "release.0.depth\n1.5\n");
    REQUIRE(plane.frana("ensemble many.toml --out many --quiet").code == 0);
    REQUIRE(plane.frana("run CASE --quiet --set 'output.formats=[\"geotiff\"]' --out alone").code == 0);
    const Json record = Json::parse(text_of(plane.folder() / "alone/run.json")), budgets = record["budgets"];
    const double out = budgets["mass"]["left_domain"], eroded = budgets["bed"]["eroded"];
    REQUIRE((!deposits || out > 0.01 * density * released));
    REQUIRE(eroded > 0.01 * density * released);
    // Where the bed is rock, what was eroded had flowed before.
    const double flowed = released + (deposits ? 0.0 : eroded / density);
    const std::string runs = text_of(plane.folder() / "many/runs.csv");
    const auto number = [&](const std::string& name) { return std::stod(column_of(runs, name).at(0)); };
    // Round-off of sums of some thousand terms, over some thousand steps.
    CHECK(number("volume_m3") == Approx(flowed).epsilon(1e-10));
    CHECK(number("left_share") == Approx(out / (density * flowed)).epsilon(1e-10));
    const Json bed = budgets["bed"];
    CHECK(number("eroded_m3") == Approx(bed["taken_of_bed"].get<double>() / density).epsilon(1e-10).margin(1e-6));
    CHECK(number("deposited_m3") == Approx(bed["lies_behind"].get<double>() / density).epsilon(1e-10).margin(1e-6));
    // Maps of one run are its own: what lies there counts as covered.
    const auto map = [&](const std::string& name) { return raster_in(plane.folder() / (name + ".tif")); };
    const frana::Raster reached = map("many/rasters/probability_reached"),
                        likely = map("many/rasters/probability_eroded_depth_0.1"),
                        change = map("many/rasters/quantile_bed_change_0.5"),
                        change_alone = map("alone/rasters/bed_change"),
                        eroded_alone = map("alone/rasters/eroded_depth");
    REQUIRE(reached.geometry == change_alone.geometry);
    double area = 0.0;
    for (std::size_t k = 0; k < reached.values.size(); ++k) {
        if (!(reached.values[k] > 0.0)) continue;
        area += reached.geometry.cell * reached.geometry.cell;
        const auto known = [](double value) { return std::isnan(value) ? 0.0 : value; };
        CHECK(known(change.values[k]) == Approx(known(change_alone.values[k])).margin(1e-6));
        CHECK((likely.values[k] == 1.0) == (known(eroded_alone.values[k]) > 0.1));
    }
    CHECK(area == record["results"]["footprint_area"].get<double>());
}

namespace {

const frana::GridGeometry pixels{5, 4, 10.0, 20.0, 2.0};
const std::vector<std::string> two_fields = {"peak_depth", "peak_speed"};

/// A run on as many pixels as its number says and one more, so none is like another.
frana::SparseRasters run_of(frana::Index sample) {
    frana::SparseRasters run;
    run.rows.push_back({sample, sample + 1});
    run.values.resize(2);
    for (frana::Index k = 0; k <= sample; ++k) {
        run.values[0].push_back(static_cast<float>(sample) + 0.25F * static_cast<float>(k));
        run.values[1].push_back(100.0F + static_cast<float>(sample * k));
    }
    return run;
}

void write_runs(const std::filesystem::path& file, const std::vector<frana::Index>& samples) {
    frana::PeakBlock block{pixels, two_fields, samples, {}};
    for (const frana::Index sample : samples) block.peaks.push_back(run_of(sample));
    frana::write_peaks(file, block);
}

std::string complaint(std::vector<frana::KeptRun> runs, const std::vector<std::string>& wanted,
                      const frana::GridGeometry& on) {
    try {
        frana::KeptPeaks(std::move(runs), wanted, on);
    } catch (const frana::UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("peaks come run by run in the order of the samples, however they lie in files", "[ensemble]") {
    const FreshFolder folder;
    const auto a = folder.path() / "a.h5", b = folder.path() / "b.h5";
    write_runs(a, {0, 3, 4});
    write_runs(b, {1, 2, 5});  // what two threads or two shards leave
    // Run 3 was lost and is not asked for.
    const frana::KeptPeaks kept({{0, a}, {1, b}, {2, b}, {4, a}, {5, b}}, two_fields, pixels);
    REQUIRE(kept.runs() == 5);
    const std::vector<frana::Index> samples = {0, 1, 2, 4, 5};
    for (const std::vector<std::size_t>& asked : {std::vector<std::size_t>{0, 1}, {1}, {}}) {
        std::size_t next = 0;
        kept.for_each_run(asked, [&](std::size_t run, const frana::SparseRasters& peaks) {
            REQUIRE(run == next++);
            const frana::SparseRasters expected = run_of(samples[run]);
            REQUIRE(peaks.rows.size() == 1);
            CHECK(peaks.rows[0].first == expected.rows[0].first);
            CHECK(peaks.rows[0].count == expected.rows[0].count);
            REQUIRE(peaks.values.size() == 2);
            for (std::size_t f = 0; f < 2; ++f) {
                const bool wanted = std::find(asked.begin(), asked.end(), f) != asked.end();
                CHECK(peaks.values[f] == (wanted ? expected.values[f] : std::vector<float>()));
            }
        });
        CHECK(next == 5);
    }
}

TEST_CASE("peaks that are not those of the ensemble are refused before any of them is used", "[ensemble]") {
    const FreshFolder folder;
    const auto a = folder.path() / "a.h5";
    write_runs(a, {0, 3});
    CHECK(complaint({{0, a}, {3, a}}, two_fields, pixels).empty());
    CHECK_THAT(complaint({{0, a}, {2, a}}, two_fields, pixels), Contains("a.h5: found no run 2"));
    CHECK_THAT(complaint({{0, a}}, {"peak_depth", "arrival_time"}, pixels), Contains("a.h5: found other fields"));
    CHECK_THAT(complaint({{0, a}}, two_fields, {6, 4, 10.0, 20.0, 2.0}), Contains("a.h5: found runs on 5 x 4 nodes"));
    CHECK_THAT(complaint({{0, folder.path() / "none.h5"}}, two_fields, pixels), Contains("none.h5"));
    frana::write_text(folder.path() / "text.h5", "no peaks");
    CHECK_THAT(complaint({{0, folder.path() / "text.h5"}}, two_fields, pixels), Contains("text.h5"));
}
