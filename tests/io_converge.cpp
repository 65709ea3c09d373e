// `frana converge` as a person calls it: a case that ships, on several cells.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "catch.h"
#include "plane_case.h"
#include "program.h"
#include "shared_data.h"

namespace fs = std::filesystem;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

Json json_in(const fs::path& file) { return Json::parse(text_of(file)); }

/// The avalanche on its track; few points a cell, on cells that take a second each.
const std::string avalanche = std::string("converge ") + FRANA_SOURCE_DIR "/cases/avalanche_track/case.toml " +
                              "--set particles.per_cell=4 --set 'output.formats=[]' --quiet --out study ";

}  // namespace

TEST_CASE("converge runs a shipped case on several cells and says whether its answer has converged", "[converge]") {
    const FreshFolder folder;
    const Outcome done = call_frana(folder.path(), avalanche + "--cells 20,40,30");  // in any order
    CHECK(done.err.empty());
    REQUIRE(done.code == 0);
    const fs::path study = folder.path() / "study";
    const Json json = json_in(study / "converge.json");
    CHECK(json["cells"] == Json({40.0, 30.0, 20.0}));
    CHECK(json["folders"] == Json({"cell_40", "cell_30", "cell_20"}));
    for (const char* key : {"runout", "reach", "footprint_area", "deposit_area", "deposit_volume", "peak_depth",
                            "largest_depth", "peak_speed", "largest_speed", "iou_with_finest", "deposit_elsewhere",
                            "cells_across", "wall_seconds", "exit_reason"}) {
        CAPTURE(key);
        CHECK(json[key].size() == 3);
    }
    CHECK(json["iou_with_finest"][2].get<double>() == Approx(1.0));
    CHECK(json["deposit_elsewhere"][2].get<double>() == Approx(0.0).margin(1e-9));
    CHECK(json["iou_with_finest"][0].get<double>() < 0.99);  // 40 m pixels cannot lie on 20 m ones everywhere
    CHECK(json["observed_order"].contains("runout"));
    CHECK(json["converged"].is_boolean());
    CHECK(json["converged"].get<bool>() == json["enough"].is_number());
    for (std::size_t k = 0; k < 3; ++k) {  // the figures are those of the runs
        const fs::path run = study / json["folders"][k].get<std::string>();
        const Json record = json_in(run / "run.json");
        CHECK(record["grid"]["cell"] == json["cells"][k]);
        CHECK(record["flow_width_cells"] == json["cells_across"][k]);
        CHECK(record["results"]["footprint_area"] == json["footprint_area"][k]);
        CHECK(record["exit_reason"] == json["exit_reason"][k]);
        CHECK(json["largest_depth"][k].get<double>() >= json["peak_depth"][k].get<double>());
        // All that is left is the deposit.
        const double mass = record["budgets"]["mass"]["final"].get<double>();
        CHECK(json["deposit_volume"][k].get<double>() == Approx(mass / 300.0).epsilon(1e-6));
        CHECK(fs::exists(run / "rasters" / "peak_depth.tif"));  // added to the formats
    }
    const std::string page = text_of(study / "converge.md");
    CHECK_THAT(page, Contains("| Cell | 40 m | 30 m | 20 m | order |") && Contains(json["verdict"].get<std::string>()));
    CHECK_THAT(done.out, Contains(json["verdict"].get<std::string>()));

    SECTION("which is refused where it lies, resumed with a finer cell, and replaced when asked for") {
        const Outcome again = call_frana(folder.path(), avalanche + "--cells 20,40");
        CHECK(again.code == 2);
        CHECK_THAT(again.err, Contains("found converge.json of an earlier study") && Contains("--overwrite"));
        const std::string coarse = text_of(study / "cell_40" / "run.json");
        REQUIRE(call_frana(folder.path(), avalanche + "--cells 40,20,25 --resume").code == 0);
        CHECK(json_in(study / "converge.json")["cells"] == Json({40.0, 25.0, 20.0}));
        CHECK(text_of(study / "cell_40" / "run.json") == coarse);  // taken as it was
        const Outcome other = call_frana(folder.path(), avalanche + "--cells 40,20 --resume --set material.bed.mu=0.2");
        CHECK(other.code == 2);
        CHECK_THAT(other.err, Contains("material.bed.mu"));
        CHECK(text_of(study / "cell_40" / "run.json") == coarse);
        REQUIRE(call_frana(folder.path(), avalanche + "--cells 40,30 --overwrite").code == 0);
        CHECK(text_of(study / "cell_40" / "run.json") != coarse);
        CHECK(json_in(study / "converge.json")["observed_order"]["runout"].is_null());  // two cells have none
    }
    SECTION("and a run that was interrupted is gone on with, to the same figures") {
        fs::remove_all(study);
        const std::string first = avalanche + "--cells 40,20";
        REQUIRE(call_frana(folder.path(), first).code == 0);
        const Json whole = json_in(study / "converge.json");
        fs::remove_all(study);
        // As after Ctrl-C on the second cell: a run with a state, and no tables.
        std::string run = avalanche + "--until 20";
        run.replace(run.find("converge"), 8, "run");
        run.replace(run.find("--out study"), 11, "--out study/cell_20 --set grid.cell=20");
        run.replace(run.find("[]"), 2, "[\"geotiff\"]");
        REQUIRE(call_frana(folder.path(), run).code == 0);
        Json stopped = json_in(study / "cell_20" / "run.json");
        stopped["exit_reason"] = "interrupted";
        frana::write_text(study / "cell_20" / "run.json", stopped.dump());
        REQUIRE(call_frana(folder.path(), first + " --resume").code == 0);
        const Json resumed = json_in(study / "converge.json");
        CHECK(resumed["footprint_area"] == whole["footprint_area"]);
        CHECK(resumed["runout"] == whole["runout"]);
    }
    SECTION("and files of other people stay") {
        frana::write_text(study / "converge.json", "mine");
        const Outcome refused = call_frana(folder.path(), avalanche + "--cells 20,40 --overwrite");
        CHECK(refused.code == 2);
        CHECK_THAT(refused.err, Contains("no study left there"));
        CHECK(text_of(study / "converge.json") == "mine");
    }
}

TEST_CASE("converge leaves with 2 and a sentence for cells that cannot be, and touches nothing", "[converge]") {
    const PlaneCase scene;
    for (const char* cells : {"10", "10,10", "10,abc", "10,-5", "10,,5", "10,0", "5,nan", "5,inf", "5m,10m"}) {
        CAPTURE(cells);
        const Outcome outcome = scene.frana(std::string("converge CASE --out study --cells ") + cells);
        CHECK(outcome.code == 2);
        CHECK(outcome.out.empty());
        CHECK_THAT(outcome.err, Catch::StartsWith("--cells: found \"") &&
                                    Contains("expected two or more different cells in metres, each above 0; write them "
                                             "like 10,5,2.5"));
        CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    }
    CHECK(scene.frana("converge CASE --out study").code == 2);
    const Outcome wide = scene.frana("converge CASE --out study --cells 5,500");  // wider than the terrain
    CHECK(wide.code == 2);
    CHECK(wide.out.empty());
    CHECK_FALSE(fs::exists(scene.folder() / "study"));
}

TEST_CASE("A run says how many cells lie across the flow, and which cell would do", "[converge][width]") {
    const PlaneCase scene;  // 40 m wide at the start
    REQUIRE(scene.frana("run CASE --quiet --out fine --set grid.cell=2.5").code == 0);
    const Json fine = json_in(scene.folder() / "fine" / "run.json");
    const double width = fine["results"]["flow_width"].get<double>();
    CHECK(width >= 30.0);  // across or along the release, which is 30 m long
    CHECK(fine["flow_width_cells"].get<double>() == Approx(width / 2.5));
    CHECK_THAT(fine["warnings"].dump(), !Contains("cells wide"));
    CHECK_THAT(text_of(scene.folder() / "fine" / "report.md"), Contains("width of the flow"));
    REQUIRE(scene.frana("run CASE --quiet --out coarse --set grid.cell=10").code == 0);
    const Json coarse = json_in(scene.folder() / "coarse" / "run.json");
    CHECK(coarse["flow_width_cells"].get<double>() < 6.0);
    CHECK_THAT(coarse["warnings"].dump(), Contains("cells wide") && Contains("grid.cell = 5 would do"));
}

// With stage.cell all runs had the same 3D grid, and were said to have converged.
TEST_CASE("converge remarks on a 3D grid that is the same on all cells", "[converge][stages]") {
    const PlaneCase scene;
    const auto said = [&](const std::string& stage) {
        scene.write("[[stage]]\nmodel = \"mpm3d\"\nuntil = 0.05\n" + stage + "[[stage]]\nmodel = \"depth_averaged\"\n");
        const Outcome outcome = scene.frana("converge CASE --out study --cells 10,5 --overwrite --set time.end=0.1");
        REQUIRE(outcome.code == 0);
        return json_in(scene.folder() / "study" / "converge.json")["remarks"].dump();
    };
    CHECK_THAT(said("cell = 2.5\n"), Contains("stage.0.cell is the same on all cells"));
    CHECK_THAT(said(""), !Contains("is the same on all cells"));
}

TEST_CASE("converge tells what its runs remark on their inputs: what all have once", "[converge]") {
    const PlaneCase scene;
    scene.write("[[inflow]]\nname = \"torrent\"\nline = [[60, 40], [60, 60]]\nvolume = 2000\nvelocity = 3\n");
    REQUIRE(scene.frana("converge CASE --out study --cells 5,2.5").code == 0);
    const Json record = json_in(scene.folder() / "study" / "converge.json");
    std::vector<std::string> cut, finer;
    for (const std::string remark : record["remarks"]) {
        if (remark.find("what comes later does not come in") != std::string::npos) cut.push_back(remark);
        if (remark.find("interpolated (cubic) to 2.5 m cells") != std::string::npos) finer.push_back(remark);
    }
    REQUIRE(cut.size() == 1);
    CHECK(cut.front().rfind("inflow torrent: ", 0) == 0);
    REQUIRE(finer.size() == 1);
    CHECK(finer.front().rfind("found in cells of 2.5 m: ", 0) == 0);
    CHECK_THAT(text_of(scene.folder() / "study" / "converge.md"), Contains(cut.front()));
}

TEST_CASE("converge varies particles a cell and the step on the finest cell, and says how far the answers lie apart",
          "[converge]") {
    const FreshFolder folder;
    const std::string command = avalanche + "--cells 40,30 --per-cell 16,4 --cfl 0.25,0.5";
    REQUIRE(call_frana(folder.path(), command).code == 0);
    const fs::path study = folder.path() / "study";
    const Json json = json_in(study / "converge.json");
    REQUIRE(json["variations"].size() == 2);
    const Json &points = json["variations"][0], &steps = json["variations"][1];
    CHECK(points["key"] == "particles.per_cell");
    CHECK(points["values"] == Json({4.0, 16.0}));
    CHECK(points["folders"] == Json({"per_cell_4", "per_cell_16"}));
    CHECK(steps["folders"] == Json({"cfl_0.25", "cfl_0.5"}));
    // 4 points a cell and half a cell a step are the case's own.
    for (const auto& [varied, own] : {std::pair(points, 0), std::pair(steps, 1)}) {
        CHECK(varied["runout"][own] == json["runout"][1]);
        CHECK(varied["iou_with_finest"][own].get<double>() == Approx(1.0));
        const double apart = varied["runout"][0].get<double>() - varied["runout"][1].get<double>();
        // It is another run, but need not cover another cell.
        const auto history = [&](int n) {
            return text_of(study / varied["folders"][n].get<std::string>() / "history.csv");
        };
        CHECK(history(0) != history(1));
        CHECK(varied["spread_cells"].get<double>() == Approx(std::abs(apart) / 30.0).margin(1e-12));
        CHECK_THAT(text_of(study / "converge.md"), Contains(varied["sentence"].get<std::string>()));
    }
    const Outcome wrong = call_frana(folder.path(), avalanche + "--cells 40,30 --per-cell 4 --overwrite");
    CHECK(wrong.code == 2);
    CHECK_THAT(wrong.err,
               Contains("--per-cell: found \"4\"; expected two or more different numbers of particles a cell"));
}
