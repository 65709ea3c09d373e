// `frana calibrate` on a survey that a run with known friction has made.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/atomic_file.h"
#include "catch.h"
#include "plane_case.h"
#include "program.h"
#include "shared_data.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

constexpr double kMu = 0.12, kXi = 400.0;

const std::string vary =
    "[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = [0.06, 0.20]\n"
    "[[calibrate.vary]]\nkey = \"material.bed.xi\"\ndistribution = \"loguniform\"\nrange = [100, 1000]\n";

/// The mudflow of cases/ensemble, whose survey is the footprint of a run with kMu and kXi.
class Mudflow {
public:
    Mudflow() {
        const fs::path cases = fs::path(FRANA_SOURCE_DIR) / "cases";
        std::string text = text_of(cases / "ensemble" / "case.toml");
        for (std::size_t at = 0; (at = text.find("../maungawhau", at)) != std::string::npos;)
            text.replace(at, 13, (cases / "maungawhau").string());
        write("case.toml", text + "[survey]\nfootprint = \"truth/footprint.geojson\"\n");
        write("truth.toml", text);
        const Outcome truth = frana(
            "run truth.toml --out truth --quiet --set material.bed.mu=0.12 --set material.bed.xi=400 "
            "--set 'output.formats=[\"geotiff\"]'");
        REQUIRE(truth.code == 0);
    }
    void write(const std::string& name, const std::string& text) const { frana::write_text(path(name), text); }
    fs::path path(const std::string& name) const { return folder_.path() / name; }
    Outcome frana(const std::string& arguments) const { return call_frana(folder_.path(), arguments); }

private:
    FreshFolder folder_;
};

}  // namespace

TEST_CASE("calibration finds the friction that a footprint was made with, on real terrain", "[ensemble]") {
    const Mudflow mudflow;
    // The survey is exact but for its pixels of 5 m, so outlines err by less than half of one.
    mudflow.write("find.toml", "[calibrate]\nsamples = 64\nrounds = 3\nsigma = 2.0\ncorrelation = 25.0\n" + vary +
                                   "[[event]]\ncase = \"case.toml\"\nname = \"rim\"\n");
    const Outcome done = mudflow.frana("calibrate find.toml --out found --threads 2 --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(mudflow.path("found/calibrate.json")));
    CHECK(json["evaluations"] == 192);
    // mu within 3 %: what the noise of single runs allows (a change of 3 % in mu is lost in it). Outlines within a pixel.
    CHECK(json["best"]["material.bed.mu"].get<double>() == Approx(kMu).epsilon(0.03));
    CHECK(json["events"][0]["boundary"].get<double>() < 5.0);
    CHECK(json["events"][0]["iou"].get<double>() > 0.95);
    CHECK(json["events"][0]["boundary_by_own"].get<double>() < json["events"][0]["boundary_by_prior"].get<double>());
    // The truth is among what the survey leaves open.
    for (const auto& [key, truth] : {std::pair{"material.bed.mu", kMu}, std::pair{"material.bed.xi", kXi}}) {
        const Json& of = json["posterior"][key];
        CAPTURE(key);
        CHECK(std::abs(of["mean"].get<double>() - truth) < 2.0 * of["sd"].get<double>());
        CHECK(of["q05"].get<double>() < of["q50"].get<double>());
    }
    CHECK_THAT(text_of(mudflow.path("found/report.md")), Contains("| rim |") && Contains("`material.bed.mu`"));
    CHECK(fs::exists(mudflow.path("found/posterior.png")));

    // What is left open goes on into the maps of another event: here a few of its rows, into the same one.
    const std::string rows = text_of(mudflow.path("found/posterior.csv"));
    CHECK(std::count(rows.begin(), rows.end(), '\n') == 257);
    std::size_t end = 0;
    for (int line = 0; line < 4; ++line) end = rows.find('\n', end) + 1;
    mudflow.write("few.csv", rows.substr(0, end));
    mudflow.write(
        "maps.toml",
        "[ensemble]\ncase = \"case.toml\"\nmethod = \"table\"\ntable = \"few.csv\"\nfields = [\"peak_depth\"]\n");
    REQUIRE(mudflow.frana("ensemble maps.toml --out maps --quiet").code == 0);
    CHECK(Json::parse(text_of(mudflow.path("maps/ensemble.json")))["run"] == 3);

    const Outcome again = mudflow.frana("calibrate find.toml --out found");
    CHECK(again.code == 2);
    CHECK_THAT(again.err, Contains("found an earlier calibration") && Contains("--overwrite"));
}

TEST_CASE("two events are weighed together, with the same bytes on any number of threads", "[ensemble]") {
    const Mudflow mudflow;
    mudflow.write("two.toml", "[calibrate]\nsamples = 6\nrounds = 2\n" + vary +
                                  "[[event]]\ncase = \"case.toml\"\nname = \"a\"\n"
                                  "[[event]]\ncase = \"case.toml\"\nname = \"b\"\nweight = 0.5\n");
    REQUIRE(mudflow.frana("calibrate two.toml --out one --threads 1 --quiet").code == 0);
    REQUIRE(mudflow.frana("calibrate two.toml --out three --threads 3 --quiet").code == 0);
    for (const char* file : {"runs.csv", "posterior.csv"})
        CHECK(text_of(mudflow.path("one") / file) == text_of(mudflow.path("three") / file));
    const Json json = Json::parse(text_of(mudflow.path("one/calibrate.json")));
    CHECK(json["evaluations"] == 24);
    REQUIRE(json["events"].size() == 2);
    // The same event twice: what one tells predicts the other as well as its own survey does, but for the weight.
    CHECK(json["events"][0]["boundary"] == json["events"][1]["boundary"]);
    CHECK(json["events"][0]["boundary_by_others"].get<double>() < json["events"][0]["boundary_by_prior"].get<double>());
}

TEST_CASE("what cannot be calibrated is said in one sentence", "[ensemble]") {
    const PlaneCase scene;
    const auto complaint = [&](const std::string& text) {
        frana::write_text(scene.folder() / "find.toml", text);
        const Outcome outcome = scene.frana("calibrate find.toml --out found --quiet");
        CHECK(outcome.code == 2);
        CHECK_FALSE(fs::exists(scene.folder() / "found"));
        return outcome.err;
    };
    const std::string event = "[[event]]\ncase = \"case.toml\"\n";
    CHECK_THAT(complaint("[calibrate]\n" + vary + event), Contains("survey.footprint: found none"));
    CHECK_THAT(complaint(event), Contains("found no [calibrate], or no [[event]]"));
    CHECK_THAT(complaint("[calibrate]\n" + event), Contains("found no [[calibrate.vary]]"));
    CHECK_THAT(complaint("[calibrate]\nsigma = -1\n" + vary + event),
               Contains("found -1 m; expected a length above 0"));
    CHECK_THAT(complaint("[calibrate]\nsample = 4\n" + vary + event), Contains("is samples meant?"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + "[[event]]\ncase = \"none.toml\"\n"), Contains("none.toml"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + event + "weight = 0\n"),
               Contains("found 0; expected a number above 0"));
    CHECK_THAT(complaint("[calibrate]\nsamples = 501\nrounds = 10\n" + vary + event), Contains("found 5010 runs"));
    CHECK_THAT(complaint("[calibrate]\n[[calibrate.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\n"
                         "values = [1, 2]\n" +
                         event),
               Contains("found scenarios for release.0.depth"));
}
