// Runs that stop and go on, as a person does it: the program, its sentences, and the folder it leaves.
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "fake_scene.h"
#include "fresh_folder.h"
#include "io/gdal_sum.h"
#include "program.h"
#include "run/folder/checkpoint.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_job.h"
#include "run/folder/run_lock.h"
#include "small_disk.h"

using namespace frana;
namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

const char* const slope_case = R"(
[terrain]
dem = "dem.asc"
[[release]]
outline = "release.geojson"
depth = 1.5
[material.bed]
law = "coulomb"
mu = 0.2
[time]
end = 4
[output]
every = 0.5
formats = ["xdmf"]
)";

const char* const barrier = R"(
[[stage]]
model = "depth_averaged"
until = 0.3
[[stage]]
model = "mpm3d"
window = [60, 20, 100, 80]
[[barrier]]
outline = "wall.geojson"
height = 3
)";

const char* const rain_on_blocks = R"(
[material]
density = 2600.0
[material.structure]
law = "drucker_prager"
cohesion = 0.0
friction_angle_deg = 30.0
young_modulus = 1e5
fraction = 0.0
[water]
model = "free"
share = 0.4
rain = "rain.asc"
)";

/// A plane of 30 x 20 nodes, 5 m apart, with a release; runs go into "out".
class Folder {
public:
    Folder() {
        write_dem(100.0);
        write_text(path() / "release.geojson",
                   R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {
                      "type": "Polygon", "coordinates": [[[20, 30], [50, 30], [50, 70], [20, 70], [20, 30]]]}}]})");
        write_text(path() / "case.toml", slope_case);
    }
    void write_dem(double top) const {
        std::ostringstream dem;
        dem << "ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n";
        for (int row = 0; row < 20; ++row)
            for (int column = 0; column < 30; ++column) dem << top - 1.5 * column << (column < 29 ? ' ' : '\n');
        write_text(path() / "dem.asc", dem.str());
    }
    Outcome run(const std::string& arguments) const {
        return call_frana(path(), "run case.toml --quiet --threads 1 --out out " + arguments);
    }
    const fs::path& path() const { return folder_.path(); }
    fs::path out() const { return path() / "out"; }
    Json json() const { return Json::parse(text_of(out() / "run.json")); }

private:
    FreshFolder folder_;
};

/// The files that a whole run leaves, but those with wall times in them.
std::map<std::string, std::string> files_of(const fs::path& run_dir) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (entry.is_regular_file() && name != "run.json" && name != "report.md" && name != "checkpoint.h5")
            files[fs::relative(entry.path(), run_dir).generic_string()] = text_of(entry.path());
    }
    return files;
}

void check_same_files(const fs::path& found, const fs::path& expected) {
    const auto a = files_of(found), b = files_of(expected);
    REQUIRE(b.size() > 4);
    CHECK(a.size() == b.size());
    for (const auto& [name, bytes] : b) {
        INFO(name);
        REQUIRE(a.count(name) == 1);
        CHECK((a.at(name) == bytes));
    }
}

}  // namespace

TEST_CASE("a run until some time that goes on later leaves what one run leaves", "[resume][cli]") {
    const Folder folder;
    REQUIRE(folder.run("").code == 0);
    fs::rename(folder.out(), folder.path() / "whole");
    const std::string until = GENERATE("2", "1.77", "0.3");
    CAPTURE(until);
    const Outcome part = folder.run("--until " + until);
    REQUIRE(part.code == 0);
    CHECK(folder.json()["exit_reason"] == "until");
    const std::string said = "stopped by --until at " + until + " of ";
    CHECK_THAT(text_of(folder.out() / "report.md"), Contains(said) && Contains("; --resume goes on"));
    const Outcome resumed = folder.run("--resume");
    CHECK(resumed.err.empty());
    REQUIRE(resumed.code == 0);
    check_same_files(folder.out(), folder.path() / "whole");
    const Json json = folder.json(), whole = Json::parse(text_of(folder.path() / "whole" / "run.json"));
    for (const char* key : {"steps", "frames", "budgets", "results", "particle_steps", "simulated_time", "warnings"})
        CHECK(json[key] == whole[key]);
    CHECK(json["checkpoints"]["resumed_at"].size() == 1);
    CHECK(whole["checkpoints"]["resumed_at"].empty());
    CHECK(whole["checkpoints"]["written"] == 1);
    // A run that is over makes its products again and is over.
    REQUIRE(folder.run("--resume").code == 0);
    check_same_files(folder.out(), folder.path() / "whole");
}

TEST_CASE("a state that was left with the former word for a choice is resumed", "[resume]") {
    const FreshFolder folder;
    const auto labels = [](const std::string& model) {
        return CheckpointLabels{{"version", "9.9"}, {"case", "stage.0.model = \"" + model + "\"\n"}};
    };
    write_checkpoint(folder.path() / "checkpoint.h5", labels("solid_flow"), [](Archive& archive) {
        double number = 1.0;
        archive.number("number", number);
    });
    CHECK_NOTHROW(open_checkpoint(folder.path(), labels("mpm3d")));
    CHECK_THROWS_WITH(open_checkpoint(folder.path(), labels("depth_averaged")),
                      Contains("stage.0.model is \"mpm3d\" there and \"depth_averaged\" here"));
}

TEST_CASE("what is no state of this case is refused with the reason, and the folder stays as it was", "[resume][cli]") {
    const Folder folder;
    const Outcome none = folder.run("--resume");
    CHECK(none.code == 2);
    CHECK_THAT(none.err, Contains("out/checkpoint.h5: not found; expected the state that a run leaves there; "
                                  "run with --overwrite instead of --resume to start at the beginning"));
    CHECK_FALSE(fs::exists(folder.out()));
    REQUIRE(folder.run("--until 3").code == 0);
    // Killed before its first state: the way out leads out.
    fs::rename(folder.out() / "checkpoint.h5", folder.path() / "aside.h5");
    CHECK_THAT(folder.run("--resume").err, Contains("run with --overwrite instead of --resume"));
    REQUIRE(folder.run("--until 3 --overwrite").code == 0);
    const auto before = files_of(folder.out());
    const std::string report = text_of(folder.out() / "report.md");
    std::string arguments = "--resume", sentence;
    SECTION("another value of a key") {
        arguments += " --set material.bed.mu=0.3";
        sentence =
            "found the state of another case: material.bed.mu is 0.2 there and 0.3 here; give the case and the "
            "--set it was left with, or run with --overwrite instead of --resume to start at the beginning";
    }
    SECTION("another number of tables") {
        write_text(folder.path() / "case.toml",
                   std::string(slope_case) + "[[gauge]]\nname = \"a\"\npoint = [20, 30]\n");
        sentence = "gauge.0.name is not given there and \"a\" here";
    }
    SECTION("another law") {
        arguments += " --set material.bed.law=none";
        sentence = "material.bed.law is \"coulomb\" there and \"none\" here";
    }
    SECTION("another terrain") {
        folder.write_dem(101.0);
        sentence =
            "out/checkpoint.h5: found a state from before the file dem.asc was changed; put the file back as it "
            "was, or run with --overwrite instead of --resume to start at the beginning";
    }
    SECTION("another release") {
        std::string outline = text_of(folder.path() / "release.geojson");
        outline.replace(outline.find("[50, 70]"), 8, "[55, 70]");
        write_text(folder.path() / "release.geojson", outline);
        sentence = "found a state from before the file release.geojson was changed";
    }
    SECTION("a damaged file") {
        std::fstream file(folder.out() / "checkpoint.h5", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(3000);
        file << "x";
        sentence = "checkpoint.h5: is damaged, its checksum does not fit";
    }
    SECTION("an earlier end") {
        // The state is that of the last whole step before the end.
        arguments += " --until 0.01";
        sentence = "--until: found 0.01 s; expected at least the 1.";
    }
    const Outcome refused = folder.run(arguments);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains(sentence));
    CHECK(std::count(refused.err.begin(), refused.err.end(), '\n') == 1);
    CHECK(files_of(folder.out()) == before);
    CHECK(text_of(folder.out() / "report.md") == report);
}

TEST_CASE("a state is refused when any file that the case names has changed since", "[resume][cli]") {
    const Folder folder;
    const auto outline = [&](const char* name, double from, double to) {
        write_text(folder.path() / name,
                   fmt::format(R"({{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{}},
                               "geometry": {{"type": "Polygon", "coordinates": [[[{0}, 30], [{1}, 30], [{1}, 70],
                               [{0}, 70], [{0}, 30]]]}}}}]}})",
                               from, to));
    };
    const auto rain = [&](double rate) {
        write_text(folder.path() / "rain.asc",
                   fmt::format("ncols 2\nnrows 2\nxllcorner -1\nyllcorner -1\ncellsize 100\n{0} {0}\n{0} {0}\n", rate));
    };
    outline("wall.geojson", 90, 95);
    outline("survey.geojson", 20, 100);
    rain(1e-5);
    const bool water = GENERATE(false, true);
    write_text(folder.path() / "case.toml", std::string(slope_case) + (water ? rain_on_blocks : barrier) +
                                                "[survey]\nfootprint = \"survey.geojson\"\n");
    REQUIRE(folder.run("--until 1").code == 0);
    REQUIRE(folder.run("--resume --until 1.5").code == 0);
    std::string name = "survey.geojson";
    SECTION("a survey") { outline("survey.geojson", 20, 101); }
    SECTION("a barrier or the rain") {
        name = water ? "rain.asc" : "wall.geojson";
        rain(2e-5);
        outline("wall.geojson", 90, 96);
    }
    const Outcome refused = folder.run("--resume");
    CHECK(refused.code == 2);
    CHECK(refused.err ==
          "out/checkpoint.h5: found a state from before the file " + name +
              " was changed; put the file back as it was, or run with --overwrite instead of --resume to start at the "
              "beginning\n");
}

TEST_CASE("the sum of an input is that of all the files that are read with it", "[resume]") {
    const FreshFolder folder;
    const fs::path grid = folder.path() / "rain.asc", virtual_grid = folder.path() / "rain.vrt";
    const auto write_grid = [&](int last) {
        write_text(grid, fmt::format("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 {}\n", last));
    };
    write_grid(2);
    write_text(virtual_grid, R"(<VRTDataset rasterXSize="2" rasterYSize="1">
        <GeoTransform>0, 1, 0, 1, 0, -1</GeoTransform><VRTRasterBand dataType="Float32" band="1"><SimpleSource>
        <SourceFilename relativeToVRT="1">rain.asc</SourceFilename><SourceBand>1</SourceBand></SimpleSource>
        </VRTRasterBand></VRTDataset>)");
    const std::string before = sum_of_input(grid), virtually = sum_of_input(virtual_grid);
    CHECK(before.size() == 16);
    CHECK(virtually != before);
    SECTION("another value") {
        write_grid(3);
        CHECK(sum_of_input(grid) != before);
        CHECK(sum_of_input(virtual_grid) != virtually);
    }
    SECTION("statistics that a viewer left beside it") {
        write_text(folder.path() / "rain.asc.aux.xml", "<PAMDataset></PAMDataset>");
        CHECK(sum_of_input(grid) == before);
    }
    SECTION("the same elsewhere, under another name") {
        fs::rename(grid, folder.path() / "other.asc");
        CHECK(sum_of_input(folder.path() / "other.asc") == before);
        CHECK(sum_of_input(grid) == "missing");
    }
    SECTION("no file of GDAL's") {
        const fs::path mesh = folder.path() / "wall.stl";
        write_text(mesh, "solid made");
        const std::string first = sum_of_input(mesh);
        write_text(mesh, "solid male");
        CHECK(sum_of_input(mesh) != first);
    }
}

TEST_CASE("a state of another version or precision is refused", "[resume]") {
    const FreshFolder folder;
    FakeSimulation simulation;
    const Scene scene = fake_scene(simulation);
    const CaseFile file = CaseFile::parse(slope_case, "hill/case.toml");
    const CheckpointLabels here = checkpoint_labels(scene, file);
    const auto refused = [&](const char* name, const char* value) {
        CheckpointLabels there = here;
        there[name] = value;
        write_checkpoint(folder.path() / "checkpoint.h5", there, [](Archive&) {});
        try {
            open_checkpoint(folder.path(), here);
        } catch (const UserError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK_THAT(refused("version", "0.0.1"),
               Contains("checkpoint.h5: found a state of version 0.0.1; expected version " + here.at("version") +
                        "; use the program that left it, or run"));
    CHECK_THAT(
        refused("precision", "float"),
        Contains("found a state of precision float; expected precision double; give scheme.precision as it was"));
    CHECK(refused("build", "another compiler").empty());
    const CheckpointKeeper keeper(folder.path(), here, {}, open_checkpoint(folder.path(), here));
    REQUIRE(keeper.warnings().size() == 1);
    CHECK_THAT(keeper.warnings().front(), Contains("resumed by another build") && Contains("another compiler"));
}

TEST_CASE("Ctrl-C, SIGTERM, SIGHUP and SIGPIPE leave a state to go on from, and 130", "[resume][cli]") {
    const Folder folder;
    REQUIRE(folder.run("").code == 0);
    fs::rename(folder.out(), folder.path() / "whole");
    const char* const name = GENERATE("INT", "TERM", "HUP", "PIPE");
    // A gauge that the run writes to at every output says that it is under way.
    const std::string program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    const std::string script = "cd " + folder.path().string() + " && { " + program +
                               " run case.toml --quiet --threads 1 --out out & } && while ! test -e out/run.xdmf; do "
                               "sleep 0.01; done; kill -" +
                               std::string(name) + " $!; wait $!";
    const int status = std::system(("sh -c '" + script + "' 2> " + (folder.path() / "err.txt").string()).c_str());
    REQUIRE(WIFEXITED(status));
    // A run that was faster than the signal has ended as any other.
    if (folder.json()["exit_reason"] == "interrupted")
        CHECK(WEXITSTATUS(status) == 130);
    else
        CHECK(WEXITSTATUS(status) == 0);
    CHECK(fs::exists(folder.out() / "report.md"));
    REQUIRE(folder.run("--resume").code == 0);
    check_same_files(folder.out(), folder.path() / "whole");
}

TEST_CASE("a disk that is full while a state is saved leaves the earlier one, and the run goes on", "[resume]") {
    const FreshFolder folder;
    FakeSimulation simulation;
    Scene scene = fake_scene(simulation);
    scene.output.vtk = scene.output.xdmf = scene.output.geotiff = scene.output.png = false;
    scene.gauges.clear();
    scene.profiles.clear();
    const CaseFile file = CaseFile::parse(slope_case, "hill/case.toml");
    const CheckpointLabels labels = checkpoint_labels(scene, file);
    const fs::path state = folder.path() / "checkpoint.h5";
    prepare_run_folder(folder.path());
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    const auto go = [&](Simulation& of, CheckpointKeeper& keeper) {
        return carry_out(scene, of, folder.path(), begin_record(scene, file), Interrupt(), progress, &keeper);
    };
    {
        CheckpointKeeper keeper(folder.path(), labels, {}, nullptr);
        go(simulation, keeper);
        CHECK(keeper.progress().written == 1);
        CHECK(keeper.warnings().empty());
    }
    const std::string before = text_of(state);
    REQUIRE(before.size() > 40000);
    FakeSimulation again;
    CheckpointKeeper keeper(folder.path(), labels, std::chrono::duration<double>(1e-9), nullptr);
    const SmallDisk disk(40000);  // more than any other file of this run needs
    const RunRecord record = go(again, keeper);
    CHECK(record.summary.reason == "until");  // the scene ends before the case's time.end
    CHECK(record.summary.last.time == 2.0);
    CHECK(text_of(state) == before);
    CHECK(record.checkpoints.written == 0);
    CHECK(record.checkpoints.failed > 10);
    const Json json = Json::parse(text_of(folder.path() / "run.json"));
    CHECK(json["checkpoints"]["failed"] == record.checkpoints.failed);
    CHECK_THAT(text_of(folder.path() / "report.md"),
               Contains(fmt::format("- checkpoint: {0} of {0} could not be written, the first one at t = 0 s: ",
                                    record.checkpoints.failed)) &&
                   Contains("checkpoint.h5: cannot be written: File too large; check the folder's permissions and free "
                            "space"));
}

TEST_CASE("two runs in one folder are refused, and a dead one's lock is none", "[resume][cli]") {
    const Folder folder;
    fs::create_directories(folder.out());
    write_text(folder.out() / ".frana.lock", "99999999\n");  // left by a process that was killed
    REQUIRE(folder.run("--until 0.5").code == 0);
    CHECK_FALSE(fs::exists(folder.out() / ".frana.lock"));
    const auto before = files_of(folder.out());
    {
        const RunLock held(folder.out());
        for (const char* arguments : {"", "--resume"}) {
            const Outcome refused = folder.run(arguments);
            CHECK(refused.code == 2);
            CHECK(refused.err ==
                  fmt::format("out: found a run of process {} that is still going on there; expected a folder of its "
                              "own; wait for its end, or choose another folder with --out\n",
                              ::getpid()));
        }
        auto now = files_of(folder.out());
        CHECK(now.erase(".frana.lock") == 1);
        CHECK(now == before);
    }
    CHECK(folder.run("--resume").code == 0);
}

TEST_CASE("files that a killed run was writing are removed by the next one", "[resume][cli]") {
    const Folder folder;
    REQUIRE(folder.run("--until 1").code == 0);
    fs::create_directories(folder.out() / "rasters");
    for (const char* name : {".checkpoint.tmp17.h5", "rasters/.peak_depth.tmp17.tif"})
        write_text(folder.out() / name, "half a file");
    write_text(folder.out() / ".notes.tmp17.txt", "the user's own");
    const std::string arguments = GENERATE("--overwrite", "--resume");
    REQUIRE(folder.run(arguments).code == 0);
    CHECK_FALSE(fs::exists(folder.out() / ".checkpoint.tmp17.h5"));
    CHECK_FALSE(fs::exists(folder.out() / "rasters" / ".peak_depth.tmp17.tif"));
    CHECK(fs::exists(folder.out() / ".notes.tmp17.txt"));
}
