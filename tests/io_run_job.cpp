#include <fmt/core.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "catch.h"
#include "fake_scene.h"
#include "frana_commands.h"
#include "fresh_folder.h"
#include "io/gdal_writer.h"
#include "observe/table.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_job.h"
#include "scene/case_file.h"
#include "vtk_io/reader.h"

using namespace frana;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

const char* const case_text = R"(
[case]
title = "A hill that slides"
[terrain]
dem = "dem.tif"
[[release]]
outline = "release.geojson"
depth = 2.0
[material]
density = 1000.0
[material.bed]
law = "coulomb"
mu = 0.4
[time]
end = 2.0
[output]
every = 0.5
formats = ["vtk", "xdmf", "geotiff", "png"]
[[profile]]
name = "along"
line = [[1002, 2022], [1030, 2013]]
[[gauge]]
name = "bridge"
point = [1014, 2018]
)";

/// Pictures take most of a run's time here, so only tests that look at them ask for them.
enum class Pictures { no, yes };

/// A run of the fake in a folder of its own.
struct FakeRun {
    FreshFolder folder;
    RunRecord record;
    Scene scene;

    explicit FakeRun(FakeScript script = {}, const Interrupt& interrupt = Interrupt(),
                     Pictures pictures = Pictures::no) {
        FakeSimulation simulation(std::move(script));
        scene = fake_scene(simulation);
        scene.output.png = pictures == Pictures::yes;
        prepare_run_folder(dir());
        const CaseFile file = CaseFile::parse(case_text, "hill/case.toml");
        write_text(dir() / "case.toml", case_text);
        write_text(dir() / "resolved.toml", resolved_toml(file));
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        record = carry_out(scene, simulation, dir(), begin_record(scene, file), interrupt, progress);
    }
    const fs::path& dir() const { return folder.path(); }
    Json json() const { return Json::parse(text_of(dir() / "run.json")); }
};

}  // namespace

TEST_CASE("a run leaves every product, and the report mentions each of them") {
    const FakeRun run({}, Interrupt(), Pictures::yes);
    const std::string report = text_of(run.dir() / "report.md");
    for (const char* name :
         {"history.csv", "particles.pvd", "grid.pvd", "terrain.vti", "run.xdmf", "run.h5", "footprint.geojson",
          "rasters/peak_depth.tif", "rasters/peak_speed.tif", "rasters/peak_pressure.tif", "rasters/arrival_time.tif",
          "rasters/final_depth.tif", "rasters/final_velocity_x.tif", "rasters/final_velocity_y.tif",
          "profiles/along.csv", "gauges/bridge.csv"})
        CHECK(fs::exists(run.dir() / name));
    std::size_t mentioned = 0;
    for (const auto& entry : fs::recursive_directory_iterator(run.dir())) {
        if (!entry.is_regular_file() || entry.path().filename() == "report.md") continue;
        const fs::path path = fs::relative(entry.path(), run.dir());
        const std::string folder = path.parent_path().generic_string();
        const bool frame = folder == "particles" || folder == "grid" ||
                           (folder == "rasters" && path.extension() == ".qml") ||
                           (folder == "profiles" && path.extension() == ".vtp");
        INFO(path);
        CHECK(report.find(frame ? "`" + folder + "/`" : path.generic_string()) != std::string::npos);
        ++mentioned;
    }
    CHECK(mentioned > 20);
    CHECK(report.find("# A hill that slides") == 0);
    CHECK(report.find("| `material.bed.mu` | 0.4 | 1 |") != std::string::npos);
    CHECK(report.find("- a remark | made while building") != std::string::npos);
    CHECK(report.find("## Remarks") < report.find("## Results"));  // on the first page
    for (const DrawnFigure& figure : run.record.figures) {
        CHECK(report.find("](" + figure.path + ")") != std::string::npos);
        CHECK(fs::file_size(run.dir() / figure.path) > 1000);
    }
}

TEST_CASE("the report has a table of gauges, with the largest values of their series") {
    const FakeRun run;
    const Table series = read_table(run.dir() / "gauges" / "bridge.csv");
    const auto& depth = series.column("depth");
    const double deepest = *std::max_element(depth.begin(), depth.end());
    const auto& speed = series.column("speed");
    const double fastest = *std::max_element(speed.begin(), speed.end());
    const auto came =
        std::find_if(depth.begin(), depth.end(), [&](double h) { return h > run.scene.output.footprint_depth; });
    REQUIRE(came != depth.end());
    const double arrival = series.column("t")[static_cast<std::size_t>(came - depth.begin())];
    CHECK(text_of(run.dir() / "report.md")
              .find(fmt::format("| bridge | 1014, 2018 | {:.4g} s | {:.4g} m | {:.4g} m/s |", arrival, deepest,
                                fastest)) != std::string::npos);
}

TEST_CASE("a run that ends with nothing in motion is not at rest while more is to come in") {
    RunRecord record = FakeRun().record;
    record.summary.reason = "end";
    record.summary.motion = {};
    InflowBudget inflow;
    inflow.tables = inflow.expected = inflow.volume = 10.0;
    record.extras.inflow = inflow;
    const auto reason = [&] { return Json::parse(run_json(record))["rest"]["reason"].get<std::string>(); };
    CHECK(reason() == "at rest");
    record.extras.inflow->tables = 12.0;
    CHECK(reason() == "before all material came in");
    CHECK(reason_text(record).find("not all material has come in yet") != std::string::npos);
    record.extras.inflow->tables = 10.0;
    LateEntry late;
    late.at = 30.0;
    record.extras.late = {late};
    CHECK(reason() == "before all material came in");
    record.extras.late.front().entered = 30.0;
    CHECK(reason() == "at rest");
}

TEST_CASE("run.json has the contract's keys with the simulation's numbers") {
    const FakeRun run;
    const Json record = run.json();
    const Status &first = run.record.summary.first, &last = run.record.summary.last;
    CHECK(record["exit_reason"] == "end");
    CHECK(record["rest"]["reason"] == "stopped by the rule");  // the time was over while it moved
    CHECK(record["rest"]["moving_mass_share"] == 1.0);
    const double slow = 0.05 * run.record.summary.extremes.max_speed;  // less than two cells of 1 m in 2 s
    CHECK(record["rest"]["faster_than"].get<double>() == Approx(slow));
    CHECK(record["rest"]["fastest"] == last.max_speed);
    CHECK(text_of(run.dir() / "report.md")
              .find(fmt::format("stopped by the rule time.end, the simulated time is over: "
                                "100 % of the mass is still faster than {:.2g} m/s",
                                slow)) != std::string::npos);
    CHECK(record["case"] == "hill");
    CHECK(record["title"] == "A hill that slides");
    CHECK(record["steps"] == run.record.summary.steps);
    CHECK(record["simulated_time"] == 2.0);
    CHECK(record["host_threads"].get<int>() >= 1);
    CHECK(record["particle_steps"].get<double>() == 25.0 * static_cast<double>(run.record.summary.steps));
    const Json& mass = record["budgets"]["mass"];
    CHECK(mass["initial"] == first.mass);
    CHECK(mass["final"] == last.mass);
    CHECK(mass["left_domain"] == last.mass_left);
    // 0.5e-3 kg/s for 2 s of 25 t; the sums keep 16 digits of 25e3
    CHECK(mass["relative_error"].get<double>() == Approx(4e-8).epsilon(1e-6));
    CHECK(record["budgets"]["momentum"]["residual"][0].get<double>() == Approx(2.0).epsilon(1e-9));
    CHECK(record["budgets"]["momentum"]["residual"][1].get<double>() == Approx(2.0).epsilon(1e-9));
    const Json& energy = record["budgets"]["energy"];
    CHECK(energy["kinetic"] == last.kinetic);
    CHECK(energy["potential"] == last.potential);
    CHECK(energy["dissipated"] == last.dissipated);
    CHECK(energy["residual"].get<double>() == Approx(-8.0).epsilon(1e-6));
    CHECK(record["wall_seconds"]["solver"]["grid update"] == 0.5);
    for (const char* part : {"history", "gauges", "profiles", "frame", "rasters", "figures"})
        CHECK(record["wall_seconds"]["output"].contains(part));
    CHECK(record["wall_seconds"]["output_share"].get<double>() > 0.0);
    CHECK(record["wall_seconds"]["output_share"].get<double>() <= 1.0);
    CHECK(record["remarks"][0] == "a remark | made while building");
    CHECK(record["warnings"] == record["remarks"]);
}

TEST_CASE("rasters read back as the fields of the last frame, with nodata where nothing arrived") {
    const FakeRun run;
    const std::vector<ProductRaster> rasters = read_rasters(run.dir());
    REQUIRE(rasters.size() == 7);
    const Raster& depth = find_product(rasters, "final_depth")->raster;
    const Raster& arrival = find_product(rasters, "arrival_time")->raster;
    const Raster& velocity = find_product(rasters, "final_velocity_y")->raster;
    REQUIRE(depth.geometry == run.scene.bed.geometry);
    int arrived = 0, never = 0;
    for (Index j = 0; j < depth.geometry.ny; ++j)
        for (Index i = 0; i < depth.geometry.nx; ++i) {
            const double exact = FakeSimulation::depth({depth.geometry.x(i), depth.geometry.y(j)}, 2.0);
            // single precision in the file, and the fake's cut below 1e-6 m
            CHECK(depth.at(i, j) == Approx(exact).margin(1.1e-6).epsilon(1e-6));
            if (exact > 1e-3) CHECK(velocity.at(i, j) == FakeSimulation::v);
            if (exact > FakeSimulation::threshold) CHECK(std::isfinite(arrival.at(i, j)));
            std::isnan(arrival.at(i, j)) ? ++never : ++arrived;
        }
    CHECK(never > 100);
    CHECK(arrived > 100);
    CHECK_FALSE(depth.crs_wkt.empty());
    const Raster& peak = find_product(rasters, "peak_depth")->raster;
    CHECK(area_deeper(peak, 0.1) == run.record.footprint_area);
}

TEST_CASE("an interrupted run is whole: frames, tables, rasters and report can be read") {
    Interrupt interrupt;
    FakeScript script;
    script.on_step = [&](Index step) {
        if (step == 30) interrupt.request();
    };
    const FakeRun run(script, interrupt);
    CHECK(run.json()["exit_reason"] == "interrupted");
    const double last = run.record.summary.last.time;
    const std::vector<double> times = frame_times(run.dir());
    REQUIRE(times.size() == 3);
    CHECK(times == std::vector<double>{0.0, 0.5, last});
    CHECK(read_frame(run.dir(), -1).time == last);
    CHECK(read_particles(run.dir(), -1).count == 25);
    CHECK(read_table(run.dir() / "history.csv").column("t").back() == last);
    CHECK(read_table(run.dir() / "gauges" / "bridge.csv").column("t").back() == last);
    CHECK(read_table(run.dir() / "profiles" / "along.csv").column("t").back() == last);
    CHECK(read_rasters(run.dir()).size() == 7);
    CHECK(text_of(run.dir() / "report.md").find("interrupted") != std::string::npos);
}

TEST_CASE("a numerics error leaves the products of its last frame, and run.json says why") {
    FakeScript script;
    script.fail_time = 0.7;
    const FakeRun run(script);
    CHECK(run.record.summary.failure);
    CHECK(run.json()["exit_reason"] == "numerics");
    CHECK(run.json()["failure"] == "step 7: the depth of particle 3 is not finite");
    CHECK(frame_times(run.dir()).back() >= 0.7);
    CHECK(read_rasters(run.dir()).size() == 7);
}

TEST_CASE("a case that is refused on the way has products too, and run.json and the report call it refused") {
    FakeScript script;
    script.on_step = [](Index step) {
        if (step == 30) throw UserError("stage.top: found 3 m; expected more");
    };
    const FakeRun run(script);
    CHECK(run.json()["exit_reason"] == "refused");
    CHECK(run.json()["rest"]["reason"] == "refused");
    CHECK(run.json()["failure"] == "stage.top: found 3 m; expected more");
    CHECK(run.json()["steps"] == 30);
    CHECK(frame_times(run.dir()).back() == run.record.summary.last.time);
    CHECK(text_of(run.dir() / "report.md").find("refused: stage.top: found 3 m") != std::string::npos);
}

TEST_CASE("a state that is not finite leaves no rasters but a report of what was computed before") {
    FakeScript script;
    script.fail_time = 0.7;
    script.fail_with_nan = true;
    const FakeRun run(script);
    CHECK(frame_times(run.dir()).size() == 2);
    CHECK_FALSE(fs::exists(run.dir() / "rasters" / "peak_depth.tif"));
    CHECK(run.json()["failure"].get<std::string>().find("no last frame") != std::string::npos);
    CHECK(text_of(run.dir() / "report.md").find("no last frame") != std::string::npos);
}

TEST_CASE("only the fields that the case names reach the frames") {
    const FreshFolder folder;
    FakeSimulation simulation;
    Scene scene = fake_scene(simulation);
    scene.output.fields = {"depth"};
    scene.output.png = false;
    prepare_run_folder(folder.path());
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    carry_out(scene, simulation, folder.path(), begin_record(scene, CaseFile::parse(case_text, "hill/case.toml")),
              Interrupt(), progress);
    const LoadedFrame frame = read_frame(folder.path(), -1);
    CHECK(frame.has("depth"));
    CHECK(frame.has("elevation"));
    CHECK_FALSE(frame.has("velocity"));
    CHECK_FALSE(fs::exists(folder.path() / "figures"));
}

TEST_CASE("the closing lines are ten and name the report, the pictures and the series") {
    const FakeRun run({}, Interrupt(), Pictures::yes);
    const std::string text = closing_lines(run.record, run.dir());
    CHECK(std::count(text.begin(), text.end(), '\n') == 10);
    for (const char* place : {"report.md", "grid.pvd", "run.qgz", "figures"})
        CHECK(text.find((run.dir() / place).string()) != std::string::npos);
}

TEST_CASE("figures are drawn again from a finished run, and maps at a time on request") {
    const FakeRun run({}, Interrupt(), Pictures::yes);
    if (run.record.figures.empty()) {
        WARN("no renderer here: " << run.record.warnings.back());
        return;
    }
    const fs::path first = run.dir() / run.record.figures.front().path;
    fs::remove_all(run.dir() / "figures");
    FiguresOptions options;
    options.run_dir = run.dir();
    options.time = 1.1;
    options.width = 900;
    options.height = 800;
    CHECK(figures_command(options) == 0);
    CHECK(fs::exists(first));
    CHECK(fs::exists(run.dir() / "figures" / "map_depth_t1s.png"));
    options.run_dir = run.dir() / "figures";
    CHECK_THROWS_WITH(figures_command(options), Catch::Contains("run.json"));
}

TEST_CASE("earlier results survive a run that cannot start") {
    const FakeRun earlier;
    const FreshFolder folder;
    Raster dem = earlier.scene.bed;
    write_geotiff(folder.path() / "dem.tif", dem, "m", "elevation");
    write_text(folder.path() / "release.geojson",
               R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry":
               {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 0]]]}}]})");
    write_text(folder.path() / "case.toml", case_text);
    std::map<std::string, std::string> before;
    for (const auto& entry : fs::recursive_directory_iterator(earlier.dir()))
        if (entry.is_regular_file()) before[entry.path().string()] = text_of(entry.path());

    RunOptions options;
    options.case_file = folder.path() / "case.toml";
    options.out = earlier.dir();
    options.quiet = options.overwrite = true;
    // the terrain can be read, the release lies beside it: only the whole scene shows that nothing can start
    CHECK_THROWS_WITH(run_command(options), Catch::Contains("release"));

    std::map<std::string, std::string> after;
    for (const auto& entry : fs::recursive_directory_iterator(earlier.dir()))
        if (entry.is_regular_file()) after[entry.path().string()] = text_of(entry.path());
    CHECK(before == after);
    CHECK(before.size() > 20);
}
