// What other programs read of this one: --progress json and describe --json.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "base/version.h"
#include "catch.h"
#include "plane_case.h"
#include "scene/parameters.h"

namespace fs = std::filesystem;
using Catch::Contains;
using nlohmann::json;

namespace {

/// Every line of standard output, which has to be an object with an event.
std::vector<json> events_of(const std::string& out) {
    std::vector<json> events;
    std::istringstream lines(out);
    for (std::string line; std::getline(lines, line);) {
        events.push_back(json::parse(line));
        REQUIRE(events.back().at("event").is_string());
    }
    REQUIRE(events.size() >= 2);
    return events;
}

std::string names_of(const std::vector<json>& events) {
    std::string names, last;
    for (const json& event : events) {
        const std::string name = event["event"];
        if (name != last) names += (names.empty() ? "" : " ") + name;
        last = name;
    }
    return names;
}

const json& last_of(const std::vector<json>& events, const std::string& name) {
    const auto found =
        std::find_if(events.rbegin(), events.rend(), [&](const json& event) { return event["event"] == name; });
    REQUIRE(found != events.rend());
    return *found;
}

}  // namespace

TEST_CASE("--progress json tells a run in lines of JSON and nothing else", "[cli][progress]") {
    const PlaneCase scene;
    const Outcome run = scene.frana("run CASE --progress json --out r --set 'output.formats=[\"geotiff\"]'");
    REQUIRE(run.code == 0);
    CHECK(run.err.empty());
    const std::vector<json> events = events_of(run.out);
    CHECK(names_of(events) == "start scene progress result end");
    CHECK(events.front()["version"] == FRANA_VERSION);
    CHECK(events.front()["command"] == "run");
    const json kept = json::parse(text_of(scene.folder() / "r/run.json"));
    const json& before = last_of(events, "scene");
    CHECK(before["particles"] == 192);  // 48 cells of 4
    CHECK(before["release_volume"] == 1800.0);
    CHECK(before["folder"] == fs::canonical(scene.folder() / "r").string());
    CHECK_THAT(before["remarks"].dump(), Contains("material.bed.law is not given"));
    double share = 0.0;
    for (const json& event : events) {
        if (event["event"] != "progress") continue;
        CHECK(event["end"] == 2.0);
        CHECK(event["share"] == event["time"].get<double>() / 2.0);
        CHECK(event["share"].get<double>() >= share);
        share = event["share"];
    }
    const json& progress = last_of(events, "progress");
    CHECK(share == 1.0);
    CHECK(progress["step"] == kept["steps"]);
    CHECK(progress["eta"] == 0.0);
    CHECK(last_of(events, "result")["remarks"] == kept["remarks"]);
    CHECK(last_of(events, "result")["frames"] == kept["frames"]);
    CHECK(events.back() == json{{"event", "end"},
                                {"exit_code", 0},
                                {"exit_reason", "end"},
                                {"folder", fs::canonical(scene.folder() / "r").string()}});
}

TEST_CASE("--progress json: the last line says why a run is none", "[cli][progress]") {
    const PlaneCase scene;
    const Outcome run = scene.frana("run CASE --progress json --out r --set grid.cel1=2");
    CHECK(run.code == 2);
    const std::vector<json> events = events_of(run.out);
    CHECK(names_of(events) == "start end");
    CHECK(events.back()["exit_code"] == 2);
    CHECK(events.back()["exit_reason"] == "refused");
    CHECK(events.back()["error"].get<std::string>() + "\n" == run.err);
    const Outcome word = scene.frana("run CASE --progress xml");
    CHECK(word.code == 2);
    CHECK_THAT(word.err, Contains("--progress"));
    CHECK(scene.frana("run CASE --progress json --quiet").code == 2);
}

TEST_CASE("--progress json: a run that is stopped says so, and goes on from its share", "[cli][progress]") {
    const PlaneCase scene;
    const std::string run =
        "run CASE --progress json --out r --set time.end=1e6 --set boundary.sides='\"wall\"' --set output.every=1e5 "
        "--set "
        "'output.formats=[]'";
    // The program gets SIGTERM as soon as it moves.
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "frana";
    std::string command = run;
    command.replace(command.find("CASE"), 4, scene.file().string());
    command = "cd " + scene.folder().string() + " && { " + program.string() + " " + command +
              " > o.txt 2> e.txt & p=$!; while kill -0 $p && ! grep -q progress o.txt; do sleep 0.02; done 2> w.txt; "
              "kill $p; wait $p; }";
    const int status = std::system(command.c_str());
    INFO(text_of(scene.folder() / "e.txt"));
    CHECK(WEXITSTATUS(status) == 130);
    const std::vector<json> events = events_of(text_of(scene.folder() / "o.txt"));
    CHECK(events.back()["exit_reason"] == "interrupted");
    CHECK(events.back()["exit_code"] == 130);
    const double reached = last_of(events, "result")["time"];
    CHECK(last_of(events, "progress")["share"] == reached / 1e6);
    const Outcome on = scene.frana(run + " --resume --until " + std::to_string(reached + 1.0));
    CHECK(on.code == 0);
    const std::vector<json> further = events_of(on.out);
    for (const json& event : further) {
        if (event["event"] != "progress") continue;
        CHECK(event["time"] >= reached);
    }
}

TEST_CASE("--progress json of an ensemble counts its runs", "[cli][progress]") {
    const PlaneCase scene;
    frana::write_text(scene.folder() / "few.toml",
                      "[ensemble]\ncase = \"case.toml\"\nsamples = 3\n[[ensemble.vary]]\nkey = \"release.0.depth\"\n"
                      "range = [1.0, 2.0]\n");
    const Outcome ran = scene.frana("ensemble few.toml --out e --threads 1 --progress json");
    REQUIRE(ran.code == 0);
    const std::vector<json> events = events_of(ran.out);
    CHECK(names_of(events) == "start progress end");
    const json& progress = last_of(events, "progress");
    CHECK(progress["done"] == 3);
    CHECK(progress["runs"] == 3);
    CHECK(progress["failed"] == 0);
    CHECK(progress["share"] == 1.0);
    CHECK(events.back()["folder"] == fs::canonical(scene.folder() / "e").string());
    const Outcome again = scene.frana("ensemble few.toml --out e --progress json");
    CHECK(again.code == 2);
    CHECK(names_of(events_of(again.out)) == "start end");
}

TEST_CASE("describe --json is the table of keys", "[cli][describe]") {
    const PlaneCase scene;
    const Outcome all = scene.frana("describe --json");
    REQUIRE(all.code == 0);
    const json table = json::parse(all.out);
    CHECK(table["version"] == FRANA_VERSION);
    REQUIRE(table["keys"].size() == frana::parameters().size());
    std::size_t i = 0;
    for (const frana::Parameter& parameter : frana::parameters()) {
        const json& entry = table["keys"][i++];
        CAPTURE(parameter.key);
        CHECK(entry["key"] == parameter.key);
        CHECK(entry["unit"] == parameter.unit);
        CHECK(entry["help"] == parameter.meaning);
        CHECK(entry["value"] == parameter.expected());
        CHECK(entry["required"] == parameter.required);
        CHECK(entry.contains("default") == parameter.fallback.has_value());
        CHECK(entry.contains("choices") == !parameter.choices.empty());
        CHECK(entry.contains("range") == !parameter.range.is_all());
    }
    const json xi = json::parse(scene.frana("describe xi --json").out)["keys"][0];
    CHECK(xi["key"] == "material.bed.xi");
    CHECK(xi["switch"] == "material.bed.law");
    CHECK(xi["used_by"] == json{"voellmy"});
    CHECK(xi["range"] == json{{"low", 0.0}, {"low_open", true}});
    const json density = json::parse(scene.frana("describe material.density --json").out)["keys"][0];
    CHECK(density["otherwise"][0] == json{{"when", "case.kind"}, {"is", "snow"}, {"default", 300.0}});
    CHECK(scene.frana("describe grid.cel1 --json").code == 2);
    CHECK(scene.frana("describe --json --markdown").code == 2);
}
