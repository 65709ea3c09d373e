// `frana calibrate` on a survey that a run with known friction has made.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "base/atomic_file.h"
#include "catch.h"
#include "ensemble/sample_table.h"
#include "expected_means.h"
#include "io/gdal_reader.h"
#include "io/gdal_writer.h"
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
    // Survey and runs err by a pixel, 5 m. By less, single points have all of the weight: outlines of runs next to one another
    // are 1 m apart.
    mudflow.write("find.toml", "[calibrate]\nsamples = 64\nrounds = 4\nsigma = 5.0\n" + vary +
                                   "[[event]]\ncase = \"case.toml\"\nname = \"rim\"\n");
    const Outcome done = mudflow.frana("calibrate find.toml --out found --threads 2 --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(mudflow.path("found/calibrate.json")));
    CHECK(json["evaluations"] == 256);
    CHECK(json["effective_number"].get<double>() > 50.0);  // below, the report calls quantiles guesses
    // mu within 3 %: what the noise of single runs allows (a change of 3 % in mu is lost in it). Outlines within a pixel.
    CHECK(json["best"]["material.bed.mu"].get<double>() == Approx(kMu).epsilon(0.03));
    CHECK(json["events"][0]["boundary"].get<double>() < 5.0);
    // The search goes no way up, and its steps are too short to leave the valley.
    const Json& optimum = json["optimum"];
    CHECK(optimum["score"].get<double>() >= json["score"].get<double>());
    CHECK(optimum["values"]["material.bed.mu"].get<double>() == Approx(kMu).epsilon(0.03));
    CHECK(optimum["events"][0]["boundary"].get<double>() < 5.0);
    CHECK(optimum["noise"].get<double>() > 0.0);
    CHECK(optimum["evaluations"].get<int>() > 5);  // those that tell the noise
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
    // More friction of one kind, less of the other: so one outline leaves them.
    REQUIRE(json["pairs"].size() == 1);
    CHECK(json["pairs"][0]["keys"] == Json({"material.bed.mu", "material.bed.xi"}));
    CHECK(json["pairs"][0]["correlation"].get<double>() > 0.5);
    CHECK_THAT(text_of(mudflow.path("found/report.md")),
               Contains("`material.bed.mu` and `material.bed.xi` go together (correlation 0."));
    CHECK(fs::exists(mudflow.path("found/posterior.png")));

    // What is left open goes on into the maps of another event: here a few of its rows, into the same one.
    const std::string rows = text_of(mudflow.path("found/posterior.csv"));
    std::istringstream lines(rows);
    std::string line;
    std::getline(lines, line);
    CHECK(line == "weight,material.bed.mu,material.bed.xi");
    long draws = 0;
    std::set<std::string> points;
    while (std::getline(lines, line)) {
        draws += std::stol(line);
        CHECK(points.insert(line.substr(line.find(','))).second);  // each once, so no run is made twice
    }
    CHECK(draws == 256);
    CHECK(points.size() < 256);
    std::size_t end = 0;
    for (int n = 0; n < 4; ++n) end = rows.find('\n', end) + 1;
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

namespace {

/// A slide down a plane whose bed is taken up, and all that a survey can have of one of its runs.
class SurveyedSlide {
public:
    SurveyedSlide() {
        const std::string scene =
            "[terrain]\ndem = \"dem.asc\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 1.5\n"
            "[material.bed]\nlaw = \"coulomb\"\nmu = 0.05\n"
            "[erodible]\ndepth = 0.5\nlaw = \"growth\"\ngrowth = 0.01\n[time]\nend = 6\n"
            "[[gauge]]\nname = \"low\"\npoint = [75, 50]\n";
        write("event.toml", scene +
                                "[survey]\nfootprint = \"truth/footprint.geojson\"\n"
                                "deposit = \"truth/rasters/final_depth.tif\"\n"
                                "bed_change = \"dod.tif\"\npath = \"path.geojson\"\n");
        write("truth.toml", scene);
        write("path.geojson", R"({"type": "LineString", "coordinates": [[35, 50], [140, 50]]})");
        REQUIRE(run("truth.toml", "truth", kTruth).code == 0);
        // A second survey sees the ground with what lies on it.
        frana::Raster change = raster("truth/rasters/bed_change.tif");
        const frana::Raster lying = raster("truth/rasters/final_depth.tif");
        frana::write_geotiff(path("truth/rasters/final_depth.tif"), lying, "m", "a survey of all of the ground");
        for (std::size_t k = 0; k < change.values.size(); ++k) change.values[k] += lying.values[k];
        frana::write_geotiff(path("dod.tif"), change, "m", "after minus before");
    }
    /// Where the flow never came its rasters are nodata, while a survey sees that nothing has changed.
    frana::Raster raster(const std::string& name) const {
        std::vector<std::string> log;
        frana::Raster read = frana::GdalReader().read_raster(path(name), {0.0, 0.0, 150.0, 100.0}, "", log);
        for (double& value : read.values) value = std::isnan(value) ? 0.0 : value;
        return read;
    }
    Outcome run(const std::string& file, const std::string& out, double mu) const {
        return frana("run " + file + " --out " + out + " --quiet --set material.bed.mu=" + std::to_string(mu) +
                     " --set 'output.formats=[\"geotiff\"]'");
    }
    void write(const std::string& name, const std::string& text) const { frana::write_text(path(name), text); }
    fs::path path(const std::string& name) const { return scene_.folder() / name; }
    Outcome frana(const std::string& arguments) const { return scene_.frana(arguments); }
    /// A column of a table with commas.
    std::vector<double> column(const std::string& file, const std::string& name) const {
        std::istringstream lines(text_of(path(file)));
        std::string line;
        std::getline(lines, line);
        const std::vector<std::string> names = frana::comma_fields(line);
        const auto at = std::find(names.begin(), names.end(), name) - names.begin();
        REQUIRE(at < static_cast<std::ptrdiff_t>(names.size()));
        std::vector<double> all;
        while (std::getline(lines, line))
            all.push_back(std::stod(frana::comma_fields(line)[static_cast<std::size_t>(at)]));
        return all;
    }
    static constexpr double kTruth = 0.05;

private:
    PlaneCase scene_;
};

const std::string only_mu = "[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = [0.0, 0.1]\n";

}  // namespace

TEST_CASE("each kind of survey finds the friction that it was made with, and all of them together", "[ensemble]") {
    const SurveyedSlide slide;
    // Only the northern half of the deposit was surveyed; the slide is the same in both.
    frana::Raster deposit = slide.raster("truth/rasters/final_depth.tif");
    for (std::size_t k = 0; k < deposit.values.size() / 2; ++k) deposit.values[k] = frana::Raster::nodata;
    frana::write_geotiff(slide.path("truth/rasters/final_depth.tif"), deposit, "m", "depth at the end");
    // What the true run had at its gauge, from its own table.
    const std::vector<double> depth = slide.column("truth/gauges/low.csv", "depth [m]"),
                              speed = slide.column("truth/gauges/low.csv", "speed [m/s]");
    const double deepest = *std::max_element(depth.begin(), depth.end()),
                 fastest = *std::max_element(speed.begin(), speed.end());
    const std::string gauge = "[[event.gauge]]\nname = \"low\"\ndepth = " + std::to_string(deepest) +
                              "\nspeed = " + std::to_string(fastest) + "\n";
    slide.write("find.toml", "[calibrate]\nsamples = 16\nrounds = 1\ncorrelation = 15\n" + only_mu +
                                 "[[event]]\ncase = \"event.toml\"\nname = \"slide\"\n"
                                 "objective = [\"outline\", \"runout\", \"deposit\", \"bed_change\", \"gauges\"]\n" +
                                 gauge);
    const Outcome done = slide.frana("calibrate find.toml --out found --threads 2 --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(slide.path("found/calibrate.json")));
    const Json& misfits = json["events"][0]["misfits"];
    CHECK(misfits.size() == 5);
    // Sobol's first 16 points are a sixteenth of the range apart; pixels of 5 m hide some of a runout.
    const double near = 0.1 * 3 / 16;
    CHECK(json["best"]["material.bed.mu"].get<double>() == Approx(SurveyedSlide::kTruth).margin(near));
    const std::vector<double> tried = slide.column("found/runs.csv", "material.bed.mu");
    for (const auto& [kind, misfit] : misfits.items()) {
        CAPTURE(kind);
        const std::vector<double> all = slide.column("found/runs.csv", "slide: " + kind + "_rms");
        const auto [least, most] = std::minmax_element(all.begin(), all.end());
        CHECK(tried[static_cast<std::size_t>(least - all.begin())] == Approx(SurveyedSlide::kTruth).margin(near));
        CHECK(*least < 0.5 * *most);
        CHECK(misfit["number"].get<double>() > 0.0);
    }
    // The scores are those of `frana compare`.
    const double mu = slide.column("found/runs.csv", "material.bed.mu")[3];
    REQUIRE(slide.run("event.toml", "fourth", mu).code == 0);
    const Json compared = Json::parse(text_of(slide.path("fourth/compare.json")));
    CHECK(slide.column("found/runs.csv", "slide: iou")[3] == Approx(compared["iou"].get<double>()).epsilon(1e-6));
    CHECK(slide.column("found/runs.csv", "slide: boundary_m")[3] ==
          Approx(compared["boundary_distance_mean"].get<double>()).epsilon(1e-6));
    CHECK(slide.column("found/runs.csv", "slide: runout_rms")[3] ==
          Approx(std::abs(compared["runout_difference"].get<double>())).margin(1e-6));
    // So is what left the terrain.
    const std::vector<double> left = slide.column("found/runs.csv", "slide: left_share");
    const Json mass = Json::parse(text_of(slide.path("fourth/run.json")))["budgets"]["mass"];
    CHECK(left[3] == Approx(mass["left_share"].get<double>()).epsilon(1e-6).margin(1e-12));
    CHECK(json["left_terrain"] == std::count_if(left.begin(), left.end(), [](double share) { return share > 1e-3; }));
    // So is the volume of the best run that lies where the survey has no data.
    REQUIRE(slide.run("event.toml", "best", json["best"]["material.bed.mu"].get<double>()).code == 0);
    const double unsurveyed =
        Json::parse(text_of(slide.path("best/compare.json")))["deposit_volume_unsurveyed"].get<double>();
    CHECK(unsurveyed > 0.0);
    CHECK(misfits["deposit"]["unsurveyed_m3"].get<double>() == Approx(unsurveyed).epsilon(1e-6));
    CHECK_THAT(text_of(slide.path("found/report.md")),
               Contains("m3 of the simulated deposit of the best point lie where the survey has no data"));
}

namespace {

/// Starts the program, and kills it once it has kept more runs than there were, or has thrown them away.
void kill_once_more_is_kept(const fs::path& folder, const fs::path& kept, const char* mode = "--resume") {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    const auto size = [&] {
        std::error_code none;
        const auto bytes = fs::file_size(kept, none);
        return none ? 0 : bytes;
    };
    const auto before = size();
    const pid_t child = ::fork();
    if (child == 0) {
        if (::chdir(folder.c_str()) == 0)
            ::execl(program.c_str(), "frana", "calibrate", "find.toml", "--out", "killed", mode, "--quiet", nullptr);
        ::_exit(127);
    }
    while (::waitpid(child, nullptr, WNOHANG) == 0) {
        if (size() != before) ::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

/// All that a calibration leaves but what tells of the clock.
std::vector<std::string> whole(const fs::path& folder) {
    auto json = Json::parse(text_of(folder / "calibrate.json"));
    REQUIRE(json.erase("core_seconds") == 1);
    return {json.dump(), text_of(folder / "runs.csv"), text_of(folder / "posterior.csv"),
            text_of(folder / "report.md")};
}

std::ptrdiff_t lines_in(const fs::path& file) {
    const std::string text = text_of(file);
    return std::count(text.begin(), text.end(), '\n');
}

}  // namespace

TEST_CASE("the shipped calibration finds what its README promises, as far as fewer runs can tell", "[ensemble]") {
    const FreshFolder folder;
    const fs::path shipped = fs::path(FRANA_SOURCE_DIR) / "cases" / "calibrate";
    std::string text = text_of(shipped / "calibrate.toml");
    const auto exchange = [&](const std::string& old, const std::string& by) {
        const std::size_t at = text.find(old);
        REQUIRE(at != std::string::npos);
        text.replace(at, old.size(), by);
    };
    exchange("samples = 64", "samples = 16");
    exchange("rounds = 6", "rounds = 2\nsearch = \"none\"");
    exchange("draws = 64", "draws = 4");
    for (const char* file : {"case.toml", "second.toml", "next.toml"})
        exchange(std::string("\"") + file + "\"", "\"" + (shipped / file).string() + "\"");
    frana::write_text(folder.path() / "few.toml", text);
    const Outcome done = call_frana(folder.path(), "calibrate few.toml --out few --threads 2 --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const Json json = Json::parse(text_of(folder.path() / "few/calibrate.json")),
               next = Json::parse(text_of(folder.path() / "few/predict/ensemble.json"));
    CHECK(json["failed"] == 0);
    CHECK(next["failed"] == 0);
    const auto mean_of = [&](const std::string& key) {
        const Json& of = json["posterior"].contains(key) ? json["posterior"][key] : next["results"][key];
        return of["mean"].get<double>();
    };
    CHECK(check_means(shipped / "expected.csv", mean_of) == 3);
    // The surveys tell mu: its prior is even over 0.2. Of xi they tell little, and nothing is asked of it but that tolerance.
    const double before = 0.2 / std::sqrt(12.0);
    CHECK(json["posterior"]["material.bed.mu"]["sd"].get<double>() < 0.3 * before);
}

TEST_CASE("two events are weighed together, with the same bytes on any number of threads", "[ensemble]") {
    const SurveyedSlide slide;
    slide.write("again.toml", text_of(slide.path("event.toml")));  // one case is one event
    slide.write("two.toml", "[calibrate]\nsamples = 6\nrounds = 2\nsearch = \"none\"\nsigma = 1\n" + only_mu +
                                "[[event]]\ncase = \"event.toml\"\nname = \"a\"\n"
                                "[[event]]\ncase = \"again.toml\"\nname = \"b\"\nweight = 0.5\n");
    REQUIRE(slide.frana("calibrate two.toml --out one --threads 1 --quiet").code == 0);
    REQUIRE(slide.frana("calibrate two.toml --out three --threads 3 --quiet").code == 0);
    for (const char* file : {"runs.csv", "posterior.csv"})
        CHECK(text_of(slide.path("one") / file) == text_of(slide.path("three") / file));
    const Json json = Json::parse(text_of(slide.path("one/calibrate.json")));
    CHECK(json["evaluations"] == 24);
    CHECK_FALSE(json.contains("optimum"));
    REQUIRE(json["events"].size() == 2);
    // The same event twice: what one tells predicts the other as well as its own survey does, but for the weight.
    CHECK(json["events"][0]["boundary"] == json["events"][1]["boundary"]);
    CHECK(json["events"][0]["boundary_by_others"].get<double>() < json["events"][0]["boundary_by_prior"].get<double>());
}

TEST_CASE("the search goes down from a poor point, and says where it ended", "[ensemble]") {
    const SurveyedSlide slide;
    slide.write(
        "find.toml",
        "[calibrate]\nsamples = 2\nrounds = 1\nsigma = 1\n"
        "[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = [0.0, 0.3]\n[[event]]\ncase = \"event.toml\"\n");
    REQUIRE(slide.frana("calibrate find.toml --out found --quiet").code == 0);
    const Json json = Json::parse(text_of(slide.path("found/calibrate.json")));
    const Json& optimum = json["optimum"];
    CHECK(optimum["score"].get<double>() > json["score"].get<double>() + optimum["noise"].get<double>());
    // The least step is 3 % of the range, 0.009.
    CHECK(optimum["values"]["material.bed.mu"].get<double>() == Approx(SurveyedSlide::kTruth).margin(2 * 0.009));
    CHECK_FALSE(optimum["ended"].get<std::string>().empty());
    // Each of its points was run once, and the one where it begins by the rounds; two lines stand above the rows.
    CHECK(optimum["evaluations"].get<std::ptrdiff_t>() + 2 == lines_in(slide.path("found/kept/runs.csv")) - 2);
}

TEST_CASE("a key that is likeliest at an end of its range is told", "[ensemble]") {
    const SurveyedSlide slide;
    const auto told = [&](const std::string& range, const std::string& out) {
        slide.write(out + ".toml", "[calibrate]\nsamples = 64\nrounds = 2\nsearch = \"none\"\nsigma = 2\n" +
                                       ("[[calibrate.vary]]\nkey = \"material.bed.mu\"\nrange = " + range + "\n") +
                                       "[[event]]\ncase = \"event.toml\"\n");
        REQUIRE(slide.frana("calibrate " + out + ".toml --out " + out + " --quiet").code == 0);
        return text_of(slide.path(out + "/report.md"));
    };
    // The truth is 0.05.
    CHECK_THAT(told("[0.0, 0.03]", "above"),
               Contains("The surveys favour `material.bed.mu` most at the upper end of its range, 0.03."));
    CHECK_THAT(told("[0.07, 0.2]", "below"),
               Contains("The surveys favour `material.bed.mu` most at the lower end of its range, 0.07."));
    CHECK_THAT(told("[0.0, 0.1]", "within"), !Contains("The surveys favour"));
}

TEST_CASE("a calibration that is killed goes on, and leaves the same bytes", "[ensemble]") {
    const SurveyedSlide slide;
    const std::string head = "[calibrate]\nsamples = 16\nrounds = ",
                      tail = "\n" + only_mu + "[[event]]\ncase = \"event.toml\"\nname = \"slide\"\n";
    slide.write("find.toml", head + "2" + tail);
    REQUIRE(slide.frana("calibrate find.toml --out whole --threads 2 --quiet").code == 0);
    const fs::path kept = slide.path("killed/kept/runs.csv");
    for (int kills = 0; kills < 3; ++kills) kill_once_more_is_kept(slide.path(""), kept);
    CHECK(lines_in(kept) > 2);  // a run at least
    CHECK_FALSE(fs::exists(slide.path("killed/calibrate.json")));
    const Outcome without = slide.frana("calibrate find.toml --out killed --quiet");
    CHECK(without.code == 2);
    CHECK_THAT(without.err, Contains("found an earlier calibration") && Contains("--resume"));
    REQUIRE(slide.frana("calibrate find.toml --out killed --resume --quiet").code == 0);
    CHECK(whole(slide.path("killed")) == whole(slide.path("whole")));
    const std::ptrdiff_t rows = lines_in(kept);
    CHECK(rows == lines_in(slide.path("whole/kept/runs.csv")));  // nothing was run twice

    // A finished one is left as it is.
    const auto written = fs::last_write_time(slide.path("killed/calibrate.json"));
    const Outcome again = slide.frana("calibrate find.toml --out killed --resume");
    CHECK(again.code == 0);
    CHECK_THAT(again.out, Contains("killed: all is there"));
    CHECK(fs::last_write_time(slide.path("killed/calibrate.json")) == written);

    // Another round adds its own runs to those.
    slide.write("find.toml", head + "3" + tail);
    REQUIRE(slide.frana("calibrate find.toml --out killed --resume --quiet").code == 0);
    CHECK(Json::parse(text_of(slide.path("killed/calibrate.json")))["evaluations"] == 48);
    CHECK(lines_in(kept) >= rows + 16);

    // Begun anew and killed, it is not taken for finished.
    kill_once_more_is_kept(slide.path(""), kept, "--overwrite");
    CHECK_FALSE(fs::exists(slide.path("killed/calibrate.json")));
    const Outcome anew = slide.frana("calibrate find.toml --out killed --resume --quiet");
    INFO(anew.err);
    REQUIRE(anew.code == 0);

    // Another terrain or survey is another calibration.
    const std::string terrain = text_of(slide.path("dem.asc"));
    std::string higher = terrain;
    slide.write("dem.asc", higher.replace(higher.find("100"), 3, "101"));
    CHECK_THAT(slide.frana("calibrate find.toml --out killed --resume").err,
               Contains("expected runs of the same calibration"));
    slide.write("dem.asc", terrain);
    CHECK_THAT(slide.frana("calibrate find.toml --out killed --resume").out, Contains("killed: all is there"));
    fs::copy_file(slide.path("release.geojson"), slide.path("truth/footprint.geojson"),
                  fs::copy_options::overwrite_existing);
    const Outcome other = slide.frana("calibrate find.toml --out killed --resume");
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("found \"event slide ") && Contains("expected runs of the same calibration"));
}

TEST_CASE("what a survey tells becomes maps of another event in the same command", "[ensemble]") {
    const SurveyedSlide slide;
    const std::string text = "[calibrate]\nsamples = 8\nrounds = 1\nsearch = \"none\"\ndraws = 6\n" + only_mu +
                             "[[event]]\ncase = \"event.toml\"\n[predict]\ncase = \"truth.toml\"\n";
    slide.write("find.toml", text + "fields = [\"peak_depth\"]\nexceed = { peak_depth = [0.5] }\n");
    const Outcome done = slide.frana("calibrate find.toml --out found --quiet");
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    CHECK(lines_in(slide.path("found/posterior.csv")) == 7);
    CHECK(Json::parse(text_of(slide.path("found/predict/ensemble.json")))["run"] == 6);

    CHECK(fs::exists(slide.path("found/predict/rasters/probability_peak_depth_0.5.tif")));

    // Killed on the way to the maps, it goes on with them alone; then all is there.
    const auto written = fs::last_write_time(slide.path("found/calibrate.json"));
    fs::remove(slide.path("found/predict/ensemble.json"));
    REQUIRE(slide.frana("calibrate find.toml --out found --resume --quiet").code == 0);
    CHECK(fs::exists(slide.path("found/predict/ensemble.json")));
    CHECK(fs::last_write_time(slide.path("found/calibrate.json")) == written);
    CHECK_THAT(slide.frana("calibrate find.toml --out found --resume").out, Contains("all is there"));

    // Maps of a case that has changed are made again, and nothing of the old ones stays.
    slide.write("truth.toml", text_of(slide.path("truth.toml")) + "[output]\nfootprint_depth = 0.2\n");
    slide.write("found/predict/rasters/old.tif", "");
    const auto outlined = fs::last_write_time(slide.path("found/predict/probability.geojson"));
    REQUIRE(slide.frana("calibrate find.toml --out found --resume --quiet").code == 0);
    CHECK(fs::last_write_time(slide.path("found/calibrate.json")) == written);
    CHECK(Json::parse(text_of(slide.path("found/predict/ensemble.json")))["run"] == 6);
    CHECK_FALSE(fs::exists(slide.path("found/predict/rasters/old.tif")));
    CHECK(fs::last_write_time(slide.path("found/predict/probability.geojson")) > outlined);

    const auto complaint = [&](const std::string& predict) {
        slide.write("find.toml", text.substr(0, text.find("[predict]")) + predict);
        const Outcome outcome = slide.frana("calibrate find.toml --out wrong --quiet");
        CHECK(outcome.code == 2);
        CHECK_FALSE(fs::exists(slide.path("wrong")));
        return outcome.err;
    };
    CHECK_THAT(complaint("[predict]\n"), Contains("predict.case: found none"));
    CHECK_THAT(complaint("[predict]\ncase = \"none.toml\"\n"), Contains("predict.case: found no file"));
    CHECK_THAT(complaint("[predict]\ncase = \"truth.toml\"\nexceed = { depth = [1] }\n"),
               Contains("predict.exceed.depth: found a key that is not used unless predict.fields names it"));
    CHECK_THAT(complaint("[predict]\ncase = \"truth.toml\"\nsamples = 4\n"), Contains("predict.samples"));
    CHECK_THAT(complaint("predict = 1\n"), Contains("predict"));
    CHECK_THAT(complaint("[predict]\ncase = \"truth.toml\"\nexceed = { peak_depth = [0.1] }\n"),
               Contains("predict.exceed.peak_depth: found 0.1 m; expected at least the case's "
                        "output.footprint_depth = 0.2 m"));
}

TEST_CASE("what an event's survey lacks is said in one sentence", "[ensemble]") {
    const SurveyedSlide slide;
    slide.write("bare.toml", text_of(slide.path("truth.toml")) + "[survey]\nfootprint = \"truth/footprint.geojson\"\n");
    const auto complaint = [&](const std::string& event) {
        slide.write("find.toml", "[calibrate]\n" + only_mu + "[[event]]\ncase = \"bare.toml\"\n" + event);
        const Outcome outcome = slide.frana("calibrate find.toml --out found --quiet");
        CHECK(outcome.code == 2);
        CHECK_FALSE(fs::exists(slide.path("found")));
        return outcome.err;
    };
    CHECK_THAT(complaint("objective = [\"deposit\"]\n"), Contains("bare.toml: survey.deposit: found none"));
    CHECK_THAT(complaint("objective = [\"outline\", \"bed_change\"]\n"), Contains("survey.bed_change: found none"));
    CHECK_THAT(
        complaint("objective = [\"area\"]\n"),
        Contains(
            "event.0.objective: found \"area\"; expected a list of outline, runout, deposit, bed_change or gauges"));
    CHECK_THAT(complaint("objective = [\"runout\", \"runout\"]\n"), Contains("found \"runout\" twice"));
    CHECK_THAT(complaint("objective = []\n"), Contains("found no words"));
    CHECK_THAT(complaint("objective = [\"gauges\"]\n"), Contains("found \"gauges\", and no [[event.gauge]]"));
    const std::string gauge = "[[event.gauge]]\nname = \"low\"\n", counts = "objective = [\"gauges\"]\n";
    CHECK_THAT(complaint(gauge + "depth = 1\n"), Contains("found [[event.gauge]], and no \"gauges\""));
    CHECK_THAT(complaint(counts + gauge), Contains("found no name, or neither depth nor speed"));
    CHECK_THAT(complaint(counts + gauge + "depth = 0\n"), Contains("found 0; expected a number above 0"));
    CHECK_THAT(complaint(counts + gauge + "depth = 0.1\n"),
               Contains("event.gauge.depth: found 0.1 m at \"low\"") && Contains("expected more than 0.1 m"));
    CHECK_THAT(complaint(counts + gauge + "speed = 0.1\n"),
               Contains("event.gauge.speed: found 0.1 m/s") && Contains("leave it out"));
    CHECK_THAT(complaint(counts + "[[event.gauge]]\nname = \"hihg\"\ndepth = 1\n"),
               Contains("gauge: found none of the name \"hihg\"") && Contains("is one of low meant?"));
    std::string rock = text_of(slide.path("event.toml"));
    rock.erase(rock.find("[erodible]"), rock.find("[time]") - rock.find("[erodible]"));
    slide.write("rock.toml", rock);
    slide.write("find.toml",
                "[calibrate]\n" + only_mu + "[[event]]\ncase = \"rock.toml\"\nobjective = [\"bed_change\"]\n");
    CHECK_THAT(slide.frana("calibrate find.toml --out found --quiet").err,
               Contains("survey.bed_change: found beside a bed that does not change"));
    slide.write("path.geojson", R"({"type": "LineString", "coordinates": [[35, 2], [140, 2]]})");
    slide.write("find.toml",
                "[calibrate]\n" + only_mu + "[[event]]\ncase = \"event.toml\"\nobjective = [\"runout\"]\n");
    CHECK_THAT(slide.frana("calibrate find.toml --out found --quiet").err,
               Contains("survey.path: found a line that does not touch the surveyed footprint"));
    CHECK_THAT(complaint("sigma_height = 0\n"), Contains("event.0.sigma_height: found 0 m; expected a height above 0"));
    CHECK_THAT(complaint("sigma_log = -1\n"), Contains("found -1; expected a number above 0"));
}

TEST_CASE("where every run is refused, the first refusal is said", "[ensemble]") {
    const PlaneCase scene;
    scene.write(
        "[survey]\nfootprint = \"release.geojson\"\n[material.bed]\nlaw = \"pouliquen\"\nmu_s = 0.3\nmu_2 = 0.6\n"
        "grain_diameter = 0.01\n");
    frana::write_text(scene.folder() / "find.toml",
                      "[calibrate]\nsamples = 4\nrounds = 1\n[[calibrate.vary]]\nkey = \"material.bed.mu_2\"\n"
                      "range = [0.1, 0.2]\n[[event]]\ncase = \"case.toml\"\n");
    const Outcome outcome = scene.frana("calibrate find.toml --out found --quiet");
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err,
               Contains("found that all 4 runs failed, the first one so: ") && Contains("material.bed.mu_2: "));
    CHECK_FALSE(fs::exists(scene.folder() / "found" / "calibrate.json"));
    const Outcome other = scene.frana("run CASE --out run --quiet");
    REQUIRE(other.code == 0);
    const std::string report = text_of(scene.folder() / "run" / "report.md");
    for (const char* how : {"", " --overwrite", " --resume"}) {
        const Outcome refused = scene.frana(std::string("calibrate find.toml --out run --quiet") + how);
        CHECK(refused.code == 2);
        CHECK_THAT(refused.err, Contains("which a calibration would replace"));
    }
    CHECK(text_of(scene.folder() / "run" / "report.md") == report);
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
    CHECK_THAT(complaint("[calibrate]\nsearch = \"genetic\"\n" + vary + event),
               Contains("calibrate.search: found \"genetic\"; expected bobyqa or none"));
    CHECK_THAT(complaint("[calibrate]\nsample = 4\n" + vary + event), Contains("is samples meant?"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + "[[event]]\ncase = \"none.toml\"\n"), Contains("none.toml"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + event + "weight = 0\n"),
               Contains("found 0; expected a number above 0"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + event + event),
               Contains("event.1.name: found \"case\" a second time; expected another name"));
    fs::create_symlink("case.toml", scene.folder() / "link.toml");
    CHECK_THAT(complaint("[calibrate]\n" + vary + event + "[[event]]\ncase = \"link.toml\"\n"),
               Contains("event.1.case: found the case of \"case\" a second time"));
    CHECK_THAT(complaint("[calibrate]\n" + vary + event + event + "name = \"other\"\n"),
               Contains("event.1.case: found the case of \"case\" a second time"));
    CHECK_THAT(complaint("[calibrate]\nsamples = 501\nrounds = 10\n" + vary + event), Contains("found 5010 runs"));
    CHECK_THAT(complaint("[calibrate]\n[[calibrate.vary]]\nkey = \"release.0.depth\"\ndistribution = \"discrete\"\n"
                         "values = [1, 2]\n" +
                         event),
               Contains("found scenarios for release.0.depth"));
}
