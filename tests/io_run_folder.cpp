#include <chrono>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "catch.h"
#include "fresh_folder.h"
#include "run/folder/gauge_table.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_lock.h"
#include "run/folder/run_record.h"

using namespace frana;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

void touch(const fs::path& file) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "text";
}

/// A run.json that says which files the run of the folder made.
void list_as_made(const fs::path& folder, const std::vector<std::string>& files) {
    std::string list;
    for (const std::string& file : files) list += (list.empty() ? "\"" : ", \"") + file + "\"";
    std::ofstream(folder / "run.json") << "{\"exit_reason\": \"end\", \"files\": [" << list << "]}";
}

}  // namespace

TEST_CASE("preparing a run folder removes the files that the earlier run lists and nothing else") {
    const FreshFolder folder;
    const std::vector<std::string> ours = {"report.md",
                                           "history.csv",
                                           "grid.pvd",
                                           "particles/particles_000099.vtp",
                                           "run.h5",
                                           "profiles/x675.csv",
                                           "figures/map_peak_depth.png",
                                           "rasters/peak_depth.tif",
                                           "footprint.geojson",
                                           "compare.json"};
    const std::vector<std::string> theirs = {
        "notes.txt",          "figures/mine.png", "rasters/dem.tif",     "case.toml", "particles/particles_best.vtp",
        "gauges/station.csv", "states/mine.pvsm", "profiles/.hidden.csv"};
    for (const auto& names : {ours, theirs})
        for (const std::string& name : names) touch(folder.path() / name);
    std::vector<std::string> made = ours;
    made.push_back("run.json");
    list_as_made(folder.path(), made);
    prepare_run_folder(folder.path(), {folder.path() / "case.toml"}, Overwrite::yes);
    for (const std::string& name : ours) CHECK_FALSE(fs::exists(folder.path() / name));
    for (const std::string& name : theirs) CHECK(fs::exists(folder.path() / name));
}

TEST_CASE("a run folder that is a file is refused with a way out") {
    const FreshFolder folder;
    touch(folder.path() / "out");
    CHECK_THROWS_WITH(prepare_run_folder(folder.path() / "out"),
                      Catch::Contains("this is a file") && Catch::Contains("--out"));
    CHECK_THROWS_AS(prepare_run_folder(folder.path() / "out" / "deeper"), UserError);
    CHECK(text_of(folder.path() / "out") == "text");
}

TEST_CASE("products are listed by name, frames by their folder and number") {
    const FreshFolder folder;
    for (const char* name : {"grid/grid_000000.vti", "grid/grid_000001.vti", "rasters/final_depth.tif", "run.xdmf",
                             "run.h5", "stranger.txt"})
        touch(folder.path() / name);
    list_as_made(folder.path(), {"grid/grid_000000.vti", "grid/grid_000001.vti", "rasters/final_depth.tif", "run.xdmf",
                                 "run.h5", "run.json"});
    touch(folder.path() / "gauges/station.csv");  // a product's name, but nobody's
    const std::vector<Product> products = products_in(folder.path());
    REQUIRE(products.size() == 5);
    CHECK(products[0].path == "run.json");
    CHECK(products[1].path == "grid/");
    CHECK(products[1].files == 2);
    CHECK(products[2].path == "run.h5");
    CHECK(products[3].path == "run.xdmf");
    CHECK(products[4].path == "rasters/final_depth.tif");
    CHECK(products_in(folder.path() / "nothing").empty());
}

TEST_CASE("a folder with a run's files is refused unless they may be overwritten") {
    const FreshFolder folder;
    touch(folder.path() / "history.csv");
    list_as_made(folder.path(), {"history.csv", "run.json"});
    CHECK_THROWS_WITH(prepare_run_folder(folder.path()),
                      Catch::Contains("run.json, history.csv") && Catch::Contains("--overwrite"));
    CHECK(text_of(folder.path() / "history.csv") == "text");
    prepare_run_folder(folder.path(), {}, Overwrite::yes);
    CHECK_FALSE(fs::exists(folder.path() / "history.csv"));
}

TEST_CASE("a file that no run made is not replaced, whatever the options") {
    const FreshFolder folder;
    for (const char* name : {"case.toml", "footprint.geojson", "rasters/peak_depth.tif"}) {
        touch(folder.path() / name);
        CHECK_THROWS_WITH(prepare_run_folder(folder.path(), {}, Overwrite::yes),
                          Catch::Contains(name) && Catch::Contains("no run left there"));
        CHECK_THROWS_WITH(prepare_run_folder(folder.path()),  // which --overwrite would not cure
                          Catch::Contains("no run left there") && !Catch::Contains("--overwrite"));
        CHECK(text_of(folder.path() / name) == "text");
        fs::remove(folder.path() / name);
    }
}

TEST_CASE("what the case reads is never in its run's way, even when an earlier run made it") {
    const FreshFolder folder;
    touch(folder.path() / "rasters/final_depth.tif");
    list_as_made(folder.path(), {"rasters/final_depth.tif", "run.json"});
    fs::create_symlink(folder.path() / "rasters/final_depth.tif", folder.path() / "link.tif");
    for (const char* input : {"rasters/final_depth.tif", "link.tif"})
        CHECK_THROWS_WITH(
            prepare_run_folder(folder.path(), {folder.path() / "my.toml", folder.path() / input}, Overwrite::yes),
            Catch::Contains("the case reads this file"));
    CHECK(text_of(folder.path() / "rasters/final_depth.tif") == "text");
}

TEST_CASE("of a run that was killed, what came or changed since it began is its own") {
    const FreshFolder folder;
    touch(folder.path() / "gauges/station.csv");
    touch(folder.path() / "gauges/bridge.csv");
    prepare_run_folder(folder.path(), {}, Overwrite::yes);
    touch(folder.path() / "history.csv");
    fs::last_write_time(folder.path() / "gauges/bridge.csv", fs::file_time_type::clock::now() + std::chrono::hours(1));
    CHECK(files_made(folder.path()) ==
          std::vector<std::string>{"gauges/bridge.csv", "history.csv", "report.md", "run.json"});
    prepare_run_folder(folder.path(), {}, Overwrite::yes);
    CHECK(fs::exists(folder.path() / "gauges/station.csv"));
    CHECK_FALSE(fs::exists(folder.path() / "gauges/bridge.csv"));
    CHECK_FALSE(fs::exists(folder.path() / "history.csv"));
}

TEST_CASE("what a command adds to a finished run is listed with what the run made") {
    const FreshFolder folder;
    touch(folder.path() / "history.csv");
    touch(folder.path() / "gauges/station.csv");
    list_as_made(folder.path(), {"history.csv", "run.json"});
    add_to_files(folder.path(), [&] { touch(folder.path() / "compare.json"); });
    CHECK(files_made(folder.path()) ==
          std::vector<std::string>{"compare.json", "history.csv", "report.md", "run.json"});
}

TEST_CASE("the lock of a run does not follow a link") {
    const FreshFolder folder;
    touch(folder.path() / "letter.txt");
    fs::create_symlink(folder.path() / "letter.txt", folder.path() / ".frana.lock");
    CHECK_THROWS_WITH(RunLock(folder.path()), Catch::Contains("found a link") && Catch::Contains("--out"));
    CHECK(text_of(folder.path() / "letter.txt") == "text");
}

TEST_CASE("the record of a run that breaks off no longer says that the run goes on") {
    const FreshFolder folder;
    const fs::path run = folder.path() / "out", record = run / "run.json";
    const auto reason = [&] { return Json::parse(text_of(record))["exit_reason"].get<std::string>(); };
    prepare_run_folder(run);
    REQUIRE(reason() == "running");
    const std::uintmax_t size = fs::file_size(record);
    {
        const OpenRecord open(run);
        CHECK(reason() == "running");
    }
    CHECK(reason() == "stopped");
    CHECK(fs::file_size(record) == size);  // in place: a full disk allows nothing else
    list_as_made(run, {"history.csv"});
    const std::string whole = text_of(record);
    { const OpenRecord open(run); }
    CHECK(text_of(record) == whole);
    fs::remove(record);
    { const OpenRecord open(run); }
    CHECK_FALSE(fs::exists(record));
}

TEST_CASE("a lock that is held is a run that goes on, a file that was left behind is none") {
    const FreshFolder folder;
    const fs::path run = folder.path() / "out";
    CHECK_FALSE(is_run_going_on(run));
    {
        const RunLock lock(run);
        CHECK(is_run_going_on(run));
    }
    touch(run / ".frana.lock");
    CHECK_FALSE(is_run_going_on(run));
}

TEST_CASE("a film at a gauge has no speed in the report, as it has none among the peaks") {
    const FreshFolder folder;
    fs::create_directories(folder.path() / "gauges");
    std::ofstream(folder.path() / "gauges" / "g.csv") << "t [s],depth [m],speed [m/s]\n1,0.0008,13.3\n2,0.05,2.5\n";
    const std::vector<Gauge> gauges{{"g", Vec2(0, 0)}};
    CHECK_THAT(gauge_section(gauges, 0.1, false, folder.path()), Catch::Contains("| not reached | 0.05 m | 2.5 m/s |"));
    CHECK_THAT(gauge_section(gauges, 1.0, false, folder.path()), Catch::Contains("| not reached | 0.05 m | 0 m/s |"));
    // Rasters have what became bed, the series has not: the report tells them apart.
    CHECK_THAT(gauge_section(gauges, 0.1, false, folder.path()), !Catch::Contains("flow alone"));
    CHECK_THAT(gauge_section(gauges, 0.1, true, folder.path()), Catch::Contains("Depths are of the flow alone"));
}

TEST_CASE("round-off of a total is nothing that left the domain") {
    const FreshFolder folder;
    RunRecord record;
    record.density = 1000.0;
    record.summary.last.mass_left = -7e-10;
    CHECK_THAT(report_markdown(record, folder.path()), Catch::Contains("| left the domain | 0 m3 |"));
    record.summary.first.mass = 2e6;
    record.summary.last.mass_left = 7e-10;  // of 2000 m3
    CHECK_THAT(report_markdown(record, folder.path()), Catch::Contains("| left the domain | 0 m3 |"));
    record.summary.last.mass_left = 2000.0;
    CHECK_THAT(report_markdown(record, folder.path()), Catch::Contains("| left the domain | 2 m3 |"));
}
