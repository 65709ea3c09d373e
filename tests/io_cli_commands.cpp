// The program as a person calls it: exit codes, what goes to stdout and what to stderr.
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "base/atomic_file.h"
#include "catch.h"
#include "checks/verify/library.h"
#include "plane_case.h"
#include "pond.h"
#include "run/folder/run_lock.h"
#include "scene/parameters.h"

namespace fs = std::filesystem;
using Catch::Contains;

namespace {

/// What the parameter table expects of a key.
std::string expected_of(const char* key) { return frana::find_parameter(key)->expected(); }

}  // namespace

TEST_CASE("--version names the libraries, --help the commands, and both leave with 0", "[cli]") {
    const PlaneCase scene;
    const Outcome version = scene.frana("--version");
    CHECK(version.code == 0);
    CHECK_THAT(version.out, Contains("frana ") && Contains("VTK 9") && Contains("GDAL 3") && Contains("HDF5 1"));
    const Outcome help = scene.frana("--help");
    CHECK(help.code == 0);
    CHECK_THAT(help.out, Contains("run") && Contains("check") && Contains("describe") && Contains("particles") &&
                             Contains("figures") && Contains("compare"));
}

TEST_CASE("A mistake on the command line leaves with 2 and a sentence on stderr", "[cli]") {
    const PlaneCase scene;
    CHECK(scene.frana("").code == 2);
    const Outcome unknown = scene.frana("chekc CASE");
    CHECK(unknown.code == 2);
    CHECK(unknown.out.empty());
    CHECK(unknown.err ==
          "command line: found the unknown command \"chekc\"; expected one of run, converge, ensemble, calibrate, "
          "check, describe, "
          "particles, convert, figures, compare, states, verify, bench, stress; did you mean check?\n");
    const Outcome threads = scene.frana("run CASE --threads 0");
    CHECK(threads.code == 2);
    CHECK_THAT(threads.err, Contains("--threads"));
    const Outcome resume = scene.frana("run CASE --resume");
    CHECK(resume.code == 2);
    CHECK_THAT(resume.err, Contains("run with --overwrite instead of --resume"));
    const Outcome size = scene.frana("figures . --size 12");
    CHECK(size.code == 2);
    CHECK_THAT(size.err, Contains("WIDTHxHEIGHT"));
    CHECK(scene.frana("check no_such.toml").code == 2);
    const Outcome value = scene.frana("run CASE --out --quiet");
    CHECK(value.code == 2);
    CHECK_THAT(value.err, Contains("--out: its value is missing before --quiet"));
    CHECK_FALSE(std::filesystem::exists(scene.folder() / "--quiet"));
}

TEST_CASE("A number on the command line is finite and within its bound, or is named in a sentence", "[cli]") {
    const PlaneCase scene;
    const auto refused = [&](const std::string& arguments, const std::string& sentence) {
        CAPTURE(arguments);
        const Outcome outcome = scene.frana(arguments);
        CHECK(outcome.code == 2);
        CHECK(outcome.err == sentence + "\n");
    };
    for (const char* wrong : {"nan", "0", "-1", "inf", "soon"})
        refused(fmt::format("run CASE --until {}", wrong),
                fmt::format("--until: found {}; expected a finite number above 0; give one", wrong));
    for (const char* wrong : {"nan", "-1", "inf"})
        refused(fmt::format("compare run --survey s.geojson --bed-change d.tif --bed-change-noise {}", wrong),
                fmt::format("--bed-change-noise: found {}; expected a finite number, 0 or more; give one", wrong));
    refused("figures run --time nan", "--time: found nan; expected a finite number; give one");
    refused("convert run --time inf --spacing 1 --out p.h5", "--time: found inf; expected a finite number; give one");
    refused("stress --seconds -1", "--seconds: found -1; expected a finite number above 0; give one");
    CHECK(scene.frana("run CASE --until 0.5 --quiet --out out").code == 0);
    refused("figures out --time 1e9",
            "--time 1e+09: is past the last frame of out/grid.pvd; expected 0 to 0.5 s; give a time of the run, or let "
            "the run go further");
    refused("figures out --time -5",
            "--time -5: lies before the first frame of out/grid.pvd; expected 0 to 0.5 s; give a time of the run");
}

TEST_CASE("describe explains a key, and leaves with 2 for one that does not exist", "[cli]") {
    const PlaneCase scene;
    const Outcome cell = scene.frana("describe grid.cell");
    CHECK(cell.code == 0);
    CHECK_THAT(cell.out, Contains("grid.cell [m]") && Contains("the pixel of the elevation model"));
    const Outcome typo = scene.frana("describe grid.cel1");
    CHECK(typo.code == 2);
    CHECK_THAT(typo.err, Contains("did you mean grid.cell?"));
}

TEST_CASE("check tells grid, particles and volume of a good case without running it", "[cli]") {
    const PlaneCase scene;
    const Outcome check = scene.frana("check CASE");
    CHECK(check.err.empty());
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("30 x 20 nodes, 5 m apart"));
    CHECK_THAT(check.out, Contains("192 particles on 1200 m2, depth up to 1.5 m"));  // 48 cells of 4
    CHECK_THAT(check.out, Contains("volume 1800 m3 from raster or polygon, 1800 m3 in particles"));
    CHECK_THAT(check.out, Contains("bed slope 5.7 to 5.7 degrees"));  // atan(0.1)
    CHECK_THAT(check.out, Contains("width       about 40 m, 8 cells, from the release (40 m across)"));
    CHECK_THAT(check.out, Contains("150 ns per particle and step"));
    CHECK_THAT(check.out, Contains("remark      material.bed.law is not given"));
    CHECK_THAT(check.out, Catch::EndsWith("ready to run\n"));
    CHECK_FALSE(fs::exists(scene.folder() / "out"));
}

TEST_CASE("check foretells the frames, with a remark where they are thousands", "[cli]") {
    const PlaneCase scene;
    const Outcome few = scene.frana("check CASE --set output.every=0.5");
    CHECK_THAT(few.out, Contains("frames      5, about ") && !Contains("output.every"));
    const Outcome many = scene.frana("check CASE --set output.every=1e-4");
    CHECK_THAT(many.out, Contains("remark      output.every: found 20001 frames, about ") &&
                             Contains(" MB; expected 3000 at most; give a longer time"));
    const Outcome none = scene.frana("check CASE --set output.formats=[]");
    CHECK_THAT(none.out, Contains("frames      3\n"));
}

TEST_CASE("check and run refuse 3D points that no memory holds", "[cli]") {
    const PlaneCase scene;
    scene.write("[[stage]]\nmodel = \"mpm3d\"\nspacing = 0.001\n");
    for (const char* command : {"check CASE", "run CASE"}) {
        const Outcome outcome = scene.frana(command);
        CHECK(outcome.code == 2);
        CHECK_THAT(outcome.err, Contains("stage.spacing: found 1.8e+12 3D points"));
        CHECK_THAT(outcome.err, Contains("GB that are free; give a larger spacing or a smaller window"));
        CHECK_THAT(outcome.out, !Contains("ready to run"));
    }
}

TEST_CASE("An in-situ entry that cannot work is refused before the run folder is changed", "[cli][insitu]") {
    const PlaneCase scene;
    const std::string name = scene.file().string();
    const auto refused = [&](const std::string& rest, const std::string& sentence) {
        scene.write(rest);
        for (const char* command : {"check CASE", "run CASE --out out"}) {
            const Outcome outcome = scene.frana(command);
            CHECK(outcome.code == 2);
            CHECK(outcome.err == name + sentence);
        }
        CHECK_FALSE(fs::exists(scene.folder() / "out"));
    };
    refused("[[insitu]]\nname = \"a\"\nkind = \"figure\"\nfield = \"depht\"\n",
            ":11: insitu.0.field: found the text \"depht\"; expected " + expected_of("insitu.field") +
                "; did you mean \"depth\"?\n");
    refused("[[camera]]\nname = \"c\"\nprojection = \"perspective\"\ntarget = [40, 50, 95]\n",
            ":8: camera.0.position: not given, but camera.projection = \"perspective\" needs it; expected a list of 3 "
            "numbers [m], where the eye is: [x, y, elevation]; add position = ... under [[camera]]\n");
}

TEST_CASE("A run without formats leaves its in-situ products only", "[cli][insitu]") {
    const PlaneCase scene;
    scene.write("[output]\nformats = []\n[[insitu]]\nname = \"most\"\nkind = \"reduce\"\n");
    const Outcome check = scene.frana("check CASE");
    CHECK(check.code == 0);
    CHECK_THAT(check.out, Contains("in situ     reduce \"most\"\n"));
    CHECK(scene.frana("run CASE --out out --quiet").code == 0);
    CHECK(fs::exists(scene.folder() / "out" / "insitu" / "most.csv"));
    for (const char* frames : {"grid.pvd", "particles.pvd", "rasters", "figures", "terrain.vti"})
        CHECK_FALSE(fs::exists(scene.folder() / "out" / frames));
}

TEST_CASE("A pipe in the place of a file is refused at once: nobody may ever write to it", "[cli]") {
    const PlaneCase scene;
    REQUIRE(::mkfifo((scene.folder() / "survey.geojson").c_str(), 0666) == 0);
    scene.write("[survey]\nfootprint = \"survey.geojson\"\n");
    const Outcome check = scene.frana("check CASE");
    CHECK(check.code == 2);
    CHECK(check.err == scene.file().string() + ":9: survey.footprint: found \"" +
                           (scene.folder() / "survey.geojson").string() +
                           "\", a pipe or a device; expected a file; copy what comes out of it into a file, and name "
                           "that\n");
}

TEST_CASE("Pictures and scores of a run that has not ended are refused in one sentence", "[cli]") {
    const PlaneCase scene;
    fs::create_directories(scene.folder() / "out");
    for (const char* record : {R"({"exit_reason": "running", "others": {}})", R"({"title": 7})", "half a rec"}) {
        std::ofstream(scene.folder() / "out" / "run.json") << record;
        for (const char* command : {"figures out", "compare out --survey a.geojson", "states out"}) {
            CAPTURE(record, command);
            const Outcome refused = scene.frana(command);
            CHECK(refused.code == 2);
            CHECK_FALSE(Contains("json.exception").match(refused.err));
            CHECK(std::count(refused.err.begin(), refused.err.end(), '\n') == 1);
            const bool begun = std::string(record).find("running") != std::string::npos;
            if (begun) CHECK_THAT(refused.err, Contains("broke off before its end") && Contains("--overwrite"));
            if (!begun) continue;
            const frana::RunLock held(scene.folder() / "out");  // as a run that goes on does
            const Outcome early = scene.frana(command);
            CHECK(early.code == 2);
            CHECK_THAT(early.err, Contains("found a run that has not ended; expected a finished one; wait for"));
        }
    }
}

TEST_CASE("figures that cannot write a single picture are an error", "[cli]") {
    const PlaneCase scene;
    REQUIRE(scene.frana("run CASE --quiet --out out").code == 0);
    fs::remove_all(scene.folder() / "out/figures");
    frana::write_text(scene.folder() / "out/figures", "a file where the folder of pictures belongs");
    const Outcome none = scene.frana("figures out");
    CHECK(none.code == 2);
    CHECK(none.out.empty());
    CHECK_THAT(none.err, Contains("was not drawn") && Contains("pictures could be drawn"));
}

TEST_CASE("check lists all problems of a bad case on stderr and is not ready", "[cli]") {
    const PlaneCase scene;
    scene.write("[grid]\ncel = 3\n[survey]\nfootprint = \"none.geojson\"\n");
    const Outcome check = scene.frana("check CASE --set scheme.cfl=7");
    CHECK(check.code == 2);
    CHECK(check.out.empty());
    const std::string name = scene.file().string();
    CHECK(check.err ==
          name + ":9: grid.cel: found an unknown key; expected a key of [grid]: cell; did you mean grid.cell?\n" +
              name + ":11: survey.footprint: found no file \"" + (scene.folder() / "none.geojson").string() +
              "\"; expected an existing file; correct the name (it is relative to the case file), or put "
              "the file there\n"
              "--set scheme.cfl: found 7; expected a number above 0 and at most 1; choose a value in this "
              "range\n3 problems\n");
}

TEST_CASE("particles writes every format, with the given count", "[cli]") {
    const PlaneCase scene;
    for (const char* name : {"p.csv", "p.json", "p.h5", "deep/p.vtp"}) {
        CAPTURE(name);
        const Outcome outcome =
            scene.frana(std::string("particles CASE --set particles.placement=r2 --count 500 --out ") + name);
        CHECK(outcome.err.empty());
        CHECK(outcome.code == 0);
        CHECK_THAT(outcome.out, Contains("500 particles in"));
        CHECK(fs::file_size(scene.folder() / name) > 500 * 8);
    }
    const std::string csv = text_of(scene.folder() / "p.csv");
    CHECK(std::count(csv.begin(), csv.end(), '\n') == 501);
    fs::copy(scene.folder() / "release.geojson", scene.folder() / "release.json");
    const Outcome input = scene.frana("particles CASE --set release.0.outline=release.json --out release.json");
    CHECK(input.code == 2);
    CHECK_THAT(input.err, Contains("--out release.json: found a file that this command reads"));
    CHECK(text_of(scene.folder() / "release.json") == text_of(scene.folder() / "release.geojson"));
    const Outcome wrong = scene.frana("particles CASE --out p.xyz");
    CHECK(wrong.code == 2);
    CHECK_THAT(wrong.err, Contains("expected .h5, .json, .csv or .vtp"));
}

TEST_CASE("verify names the problem that was meant, writes JSON with the contract's keys, and compares tables",
          "[cli]") {
    const PlaneCase scene;
    const Outcome unknown = scene.frana("verify stokr");
    CHECK(unknown.code == 2);
    CHECK_THAT(unknown.err, Contains("did you mean stoker?"));
    const Outcome known = scene.frana("verify --list");
    CHECK_THAT(known.out, Contains("energy_line        stands for energy_parabola, energy_hockey, energy_avaframe: "));
    CHECK_THAT(scene.frana("verify energy_lin").err, Contains("did you mean energy_line?"));
    CHECK(frana::verify::without_aliases({"energy_hockey", "energy_line", "ritter"}) ==
          std::vector<std::string>{"energy_hockey", "energy_parabola", "energy_avaframe", "ritter"});
    for (const frana::verify::Alias& alias : frana::verify::aliases()) {
        CHECK(frana::verify::find_problem(alias.name) == nullptr);
        for (const std::string& name : alias.problems) CHECK(frana::verify::find_problem(name) != nullptr);
    }
    const Outcome line = scene.frana("verify energy_line --cells 40 --json line.json");
    const auto three = nlohmann::json::parse(text_of(scene.folder() / "line.json"));
    REQUIRE(three.size() == 3);
    CHECK(three[0]["name"] == "energy_parabola");
    CHECK(three[2]["name"] == "energy_avaframe");
    const Outcome done = scene.frana("verify stoker --cells 50,100 --json v.json --table v.txt");
    CHECK(done.code == 0);
    std::ifstream file(scene.folder() / "v.json");
    const auto list = nlohmann::json::parse(file);
    REQUIRE(list.size() == 2);
    for (const char* key : {"name", "preset", "cells", "particles", "steps", "wall_seconds", "l1_depth", "l2_depth",
                            "linf_depth", "l1_momentum", "front_error", "mass_error", "observed_order"})
        CHECK(list[1].contains(key));
    CHECK(list[1]["cells"] == 100);
    CHECK(scene.frana("verify stoker --cells 50,100 --against v.txt").code == 0);
    CHECK(scene.frana("verify stoker --cells 50,120 --against v.txt").code == 1);
}

// They were taken and had no effect, or were found wrong when all had run.
TEST_CASE("Options of verify and stress without effect are refused before the work, and files that cannot be",
          "[cli]") {
    const PlaneCase scene;
    const auto refused = [&](const std::string& arguments, const std::string& part) {
        CAPTURE(arguments);
        const Outcome outcome = scene.frana(arguments);
        CHECK(outcome.code == 2);
        CHECK(outcome.out.empty());
        CHECK_THAT(outcome.err, Contains(part));
        CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    };
    refused("stress --case CASE --json s.json", "excludes");
    refused("stress --case CASE --seed 2", "excludes");
    refused("stress --scenes 1 --mirror y", "--mirror requires --case");
    refused("stress --scenes 1 --steps 10", "--steps requires --case");
    refused("stress --scenes 1 --figure cfl.png", "--figure requires --cfl-map");
    refused("stress --cfl-map --scenes 1", "excludes");
    refused("stress --scenes 1 --known nowhere.txt", "nowhere.txt: cannot be read; expected lines of SEED MODEL SCENE");
    refused("stress --scenes 1 --json nowhere/s.json", "--json nowhere/s.json: found no folder");
    refused("verify ritter --cells 50 --figure x.png", "excludes");
    refused("verify --study --json v.json", "excludes");
    refused("verify --list --cells 50", "excludes");
    refused("verify tank --points 9", "--points: found 9; expected 1, 8, 27 or 64 for tank; choose one of them");
    refused("verify ritter --points 8", "--points: found 8; expected 1, 4, 9 or 16 for ritter; choose one of them");
    refused("verify ritter --cells 50 --json nowhere/v.json", "--json nowhere/v.json: found no folder");
    const Outcome fewer = scene.frana("verify ritter --cells 50 --points 1 --json v.json");
    CHECK(fewer.code != 2);
    CHECK(nlohmann::json::parse(text_of(scene.folder() / "v.json")).at(0)["cells"] == 50);
}

TEST_CASE("bench leaves with 2 and a sentence for numbers that cannot be", "[cli]") {
    const PlaneCase scene;
    const Outcome few = scene.frana("bench --particles 70000,5 --json b.json");
    CHECK(few.code == 2);
    CHECK(few.err == "--particles: found 5; expected 1000 to 100000000; choose a number in this range\n");
    CHECK(scene.frana("bench --threads 0").code == 2);
    CHECK(scene.frana("bench --particles many").code == 2);
    CHECK_FALSE(fs::exists(scene.folder() / "b.json"));
}

TEST_CASE("A check says what stands on barriers from the start", "[cli][remarks]") {
    const Pond pond;
    const std::string barrier = "[[barrier]]\nname = \"plate\"\noutline = \"west.geojson\"\nheight = 3\n";
    pond.write("case.toml", text_of(pond.path("case.toml")) + barrier);
    const Outcome checked = pond.frana("check case.toml");
    CHECK(checked.code == 0);
    CHECK_THAT(checked.out,
               Contains("remark      barriers: found ") && Contains("of releases on top of barriers; expected none"));
}
