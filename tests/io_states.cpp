// ParaView's states: what is written into them, what they name, and when there are none.
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "base/atomic_file.h"
#include "base/colour.h"
#include "base/error.h"
#include "catch.h"
#include "frana_commands.h"
#include "fresh_folder.h"
#include "observe/table.h"
#include "program.h"
#include "read_polydata.h"
#include "run/folder/look.h"
#include "run/folder/states.h"
#include "vtk_io/figures/offscreen.h"
#include "vtk_io/reader.h"

using namespace frana;
using Catch::Matchers::Contains;
using test::polydata;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

const char* const everything = FRANA_SOURCE_DIR "/tests/states_case/case.toml";

/// The case with all that a state can show, run once for all tests here that only look.
const fs::path& full_run() {
    static const FreshFolder folder;
    static const bool done = [] {
        RunOptions options;
        options.case_file = everything;
        options.out = folder.path() / "run";
        options.quiet = true;
        return run_command(options) == 0;
    }();
    REQUIRE(done);
    static const fs::path run = folder.path() / "run";
    return run;
}

bool ran(const char* name, const fs::path& out) {
    RunOptions options;
    options.case_file = fs::path(FRANA_SOURCE_DIR) / "tests" / "states_case" / name;
    options.out = out;
    options.quiet = true;
    return run_command(options) == 0;
}

/// A small run with 3D points and a wall, which the state of the impact is for.
const fs::path& impact_run() {
    static const FreshFolder folder;
    static const fs::path run = folder.path() / "run";
    static const bool done = ran("impact.toml", run);
    REQUIRE(done);
    return run;
}

/// A small run of a block that breaks, which the state of structure is for.
const fs::path& structure_run() {
    static const FreshFolder folder;
    static const fs::path run = folder.path() / "run";
    static const bool done = ran("structure.toml", run);
    REQUIRE(done);
    return run;
}

/// A small run of grains and water.
const fs::path& phases_run() {
    static const FreshFolder folder;
    static const fs::path run = folder.path() / "run";
    static const bool done = ran("phases.toml", run);
    REQUIRE(done);
    return run;
}

/// The folder of a few short runs.
const fs::path& ensemble_folder() {
    static const FreshFolder folder;
    static const fs::path runs = folder.path() / "runs";
    static const bool done = [] {
        EnsembleOptions options;
        options.file = fs::path(FRANA_SOURCE_DIR) / "tests" / "states_case" / "ensemble.toml";
        options.out = runs;
        options.quiet = true;
        return ensemble_command(options) == 0;
    }();
    REQUIRE(done);
    return runs;
}

/// A run that has the files of a state.
const fs::path& run_for(const std::string& state) {
    return state == "impact"        ? impact_run()
           : state == "structure"   ? structure_run()
           : state == "phases"      ? phases_run()
           : state == "probability" ? ensemble_folder()
                                    : full_run();
}

std::set<std::string> all_matches(const std::string& text, const std::regex& pattern) {
    std::set<std::string> found;
    for (std::sregex_iterator match(text.begin(), text.end(), pattern), none; match != none; ++match)
        found.insert((*match)[1]);
    return found;
}

/// Values of the elements of every property of that name.
std::vector<std::vector<std::string>> values_of(const std::string& text, const std::string& property) {
    std::vector<std::vector<std::string>> found;
    const std::regex block("<Property name=\"" + property + "\"[^>]*>([^]*?)</Property>");
    const std::regex element("<Element index=\"\\d+\" value=\"([^\"]*)\"");
    for (std::sregex_iterator match(text.begin(), text.end(), block), none; match != none; ++match) {
        const std::string body = (*match)[1];
        found.emplace_back();
        for (std::sregex_iterator one(body.begin(), body.end(), element); one != none; ++one)
            found.back().push_back((*one)[1]);
    }
    return found;
}

/// Names of arrays that a state reads: by the properties of ParaView 5.11 that choose one, and in formulas.
std::set<std::string> arrays_named(const std::string& text) {
    std::set<std::string> names;
    for (const char* property : {"SelectInputScalars", "SelectInputVectors", "ColorArrayName", "ThresholdScalars",
                                 "SelectOrientationVectors", "OrientationArray", "ScaleArray"})
        for (const auto& values : values_of(text, property))
            if (values.size() == 5) names.insert(values[4]);
    for (const auto& values : values_of(text, "XArrayName")) names.insert(values.begin(), values.end());
    for (const auto& values : values_of(text, "SeriesVisibility"))
        for (std::size_t k = 0; k + 1 < values.size(); k += 2)
            if (values[k + 1] == "1") names.insert(values[k]);
    const std::set<std::string> functions = {"cos", "sin", "atan2", "sqrt", "abs", "iHat", "jHat"};
    for (const auto& values : values_of(text, "Function"))
        for (const std::string& formula : values)
            for (const std::string& word : all_matches(formula, std::regex("([A-Za-z_]\\w*)")))
                if (functions.count(word) == 0 && formula.find("e+") == std::string::npos)
                    names.insert(std::regex_replace(word, std::regex("_(xx|yy|xy)$"), ""));
    names.erase("");
    return names;
}

void add_arrays(vtkDataSetAttributes* attributes, std::set<std::string>& names) {
    for (int k = 0; k < attributes->GetNumberOfArrays(); ++k) names.insert(attributes->GetArrayName(k));
}

/// Every array of the files in a run that has everything.
std::set<std::string> arrays_written(const fs::path& run) {
    std::set<std::string> names;
    for (const auto& array : read_frame(run, -1).nodes) names.insert(array.first);
    for (const auto& array : read_particles(run, -1).arrays) names.insert(array.first);
    for (const auto& array : read_particles(impact_run(), -1).arrays) names.insert(array.first);
    for (const auto& array : read_frame(structure_run(), -1).nodes) names.insert(array.first);
    for (const auto& array : read_frame(phases_run(), -1).nodes) names.insert(array.first);
    for (const auto& array : read_maps(ensemble_folder()).nodes) names.insert(array.first);
    const auto barriers = polydata(impact_run() / "barriers/barriers_000020.vtp");
    add_arrays(barriers->GetCellData(), names);
    add_arrays(barriers->GetPointData(), names);
    for (const auto& array : read_terrain(run).nodes) names.insert(array.first);
    for (const char* file : {"survey_areas.vtp", "survey_outlines.vtp", "profiles/profiles_000000.vtp"}) {
        const auto data = polydata(run / file);
        add_arrays(data->GetPointData(), names);
        add_arrays(data->GetCellData(), names);
    }
    for (const std::string& column : read_table(run / "history.csv").columns) names.insert(column);
    return names;
}

}  // namespace

TEST_CASE("the templates read only files and arrays that a run writes") {
    const std::set<std::string> written = arrays_written(full_run());
    REQUIRE(state_templates().size() == state_names().size());
    for (const StateTemplate& state : state_templates()) {
        CAPTURE(state.name);
        CHECK(std::count(state_names().begin(), state_names().end(), state.name) == 1);
        const std::set<std::string> files = all_matches(state.text, std::regex("slot=\"file:([^\"]*)\""));
        CHECK(!files.empty());
        for (const std::string& file : files) {
            CAPTURE(file);
            CHECK(fs::exists(run_for(state.name) / file));
        }
        std::set<std::string> known = written;
        for (const auto& values : values_of(state.text, "ResultArrayName")) known.insert(values.begin(), values.end());
        const std::set<std::string> named = arrays_named(state.text);
        CHECK(named.size() >= 3);
        for (const std::string& name : named) {
            CAPTURE(name);
            CHECK(known.count(name) == 1);
        }
    }
}

TEST_CASE("a run's states have its files, ranges and cameras, and no slot is left open") {
    const Json look = Json::parse(text_of(full_run() / "states" / "look.json"));
    for (const std::string& name : state_names()) {
        CAPTURE(name);
        const std::string text = text_of(run_for(name) / "states" / (name + ".pvsm"));
        CHECK(text.find("slot=") == std::string::npos);
        for (const auto& property : {"FileName", "FileNames"})
            for (const auto& values : values_of(text, property))
                for (const std::string& file : values) {
                    CHECK(fs::path(file).is_absolute());
                    CHECK(fs::exists(file));
                }
    }
    const auto focal = values_of(text_of(full_run() / "states" / "overview.pvsm"), "CameraFocalPoint");
    REQUIRE(focal.size() == 2);
    for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(std::stod(focal[0][axis]) == look["camera"]["view"]["focal"][axis].get<double>());
}

TEST_CASE("the help of states names all of them", "[states]") {
    const FreshFolder folder;
    const std::string help = call_frana(folder.path(), "states --help").out;
    for (const std::string& name : state_names()) {
        CAPTURE(name);
        CHECK(std::regex_search(help, std::regex("[ ,]" + name + "[,\\s]")));
    }
}

TEST_CASE("slots take numbers, parts of ranges, texts and paths, with XML's own letters escaped") {
    const Json look = {{"range", {{"depth", {2.0, 10.0}}}}, {"title", "rock & \"roll\""}};
    const std::string text =
        "<Element index=\"0\" value=\"1\" slot=\"/range/depth@0.25\" />"
        "<Element index=\"1\" value=\"x\" slot=\"/title\" /><Element value=\"keep\" />"
        "<Element value=\"a.pvd\" slot=\"file:a.pvd\" />";
    CHECK(filled_state(text, look, "/runs/<here>") ==
          "<Element index=\"0\" value=\"4\" /><Element index=\"1\" value=\"rock &amp; &quot;roll&quot;\" />"
          "<Element value=\"keep\" /><Element value=\"/runs/&lt;here&gt;/a.pvd\" />");
    CHECK_THROWS_AS(filled_state("<Element value=\"1\" slot=\"/range/speed/0\" />", look, "/runs"), InternalError);
}

TEST_CASE("a state that the run lacks files for is not written, and asking for it says why") {
    const FreshFolder folder;
    RunOptions options;
    options.case_file = FRANA_SOURCE_DIR "/cases/maungawhau/case.toml";
    options.out = folder.path() / "run";
    options.sets = {"grid.cell=10.0", "time.end=2.0", "output.formats=[\"vtk\"]"};
    options.quiet = true;
    REQUIRE(run_command(options) == 0);
    const auto there = [&](const std::string& name) { return fs::exists(options.out / "states" / (name + ".pvsm")); };
    CHECK(there("overview"));
    CHECK(there("budgets"));
    CHECK(!there("stress"));
    CHECK(!there("survey"));
    CHECK_THROWS_WITH(
        states_command({options.out, {"stress"}}),
        Contains("no state \"stress\": the frames of grid.pvd have no array stress") && Contains("material.rheology"));
    CHECK_THROWS_WITH(states_command({options.out, {"impact"}}), Contains("no 3D points stood before a barrier"));
    CHECK_THROWS_WITH(states_command({options.out, {"structure"}}),
                      Contains("have no array damage; give a [material.structure]"));
    CHECK_THROWS_WITH(states_command({options.out, {"phases"}}), Contains("have no array water_depth; give a [water]"));
    CHECK_THROWS_WITH(states_command({options.out, {"survey"}}), Contains("not held against a survey"));
    CHECK_THROWS_WITH(states_command({options.out, {"strss"}}), Contains("found \"strss\"; expected overview, stress"));
    CHECK_THROWS_AS(states_command({folder.path() / "nothing", {}}), UserError);
}

TEST_CASE("states written again after a move name the files where they lie now") {
    const FreshFolder folder;
    const fs::path moved = folder.path() / "a run & more";
    fs::copy(full_run(), moved, fs::copy_options::recursive);
    CHECK(text_of(moved / "states" / "overview.pvsm").find(moved.filename().string()) == std::string::npos);
    REQUIRE(states_command({moved, {}}) == 0);
    CHECK(!fs::exists(moved / "states" / "impact.pvsm"));  // it has no 3D points
    for (const std::string& name : state_names()) {
        if (name == "impact" || name == "structure" || name == "phases" || name == "probability")
            continue;  // not of this run
        const std::string text = text_of(moved / "states" / (name + ".pvsm"));
        CHECK(text.find(folder.path().string() + "/a run &amp; more/") != std::string::npos);
        CHECK(text.find(full_run().string()) == std::string::npos);
    }
    fs::remove(moved / "profiles.pvd");
    REQUIRE(states_command({moved, {}}) == 0);
    CHECK(!fs::exists(moved / "states" / "profiles.pvsm"));
}

TEST_CASE("the states of an impact have its time, the points' size and a camera on it", "[states]") {
    const Json look = Json::parse(text_of(impact_run() / "states" / "look.json"));
    REQUIRE(look["states"]["impact"] == "");
    const std::vector<double> times = barrier_times(impact_run());
    const double at = look["impact_time"].get<double>();
    CHECK(std::find(times.begin(), times.end(), at) != times.end());
    CHECK(look["range"]["pressure"][1].get<double>() > 0.0);
    CHECK(look["range"]["point_speed"][1].get<double>() > 0.0);
    const std::vector<double> frames = particle_times(impact_run());
    const auto frame = std::find(frames.begin(), frames.end(), at);
    REQUIRE(frame != frames.end());
    const LoadedParticles then = read_particles(impact_run(), frame - frames.begin());
    std::vector<double> volumes;
    for (std::size_t k = 0; k < static_cast<std::size_t>(then.count); ++k)
        if (then.arrays.at("model")[k] == 1.0) volumes.push_back(then.arrays.at("volume")[k]);
    std::sort(volumes.begin(), volumes.end());
    REQUIRE(volumes.size() > 100);
    CHECK(look["point_radius"].get<double>() ==
          Approx(0.62 * std::cbrt(volumes[(volumes.size() - 1) / 2])).epsilon(1e-9));
    const Json& camera = look["camera"]["impact"];
    double distance = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        distance = std::hypot(distance, camera["position"][axis].get<double>() - camera["focal"][axis].get<double>());
    CHECK(distance > 10.0);
    CHECK(distance < 200.0);
    CHECK(camera["focal"][0].get<double>() > 5.0);  // the wall stands at 20 m
    CHECK(camera["focal"][0].get<double>() < 22.0);
    CHECK(camera["position"][2].get<double>() > camera["focal"][2].get<double>());
    CHECK(fs::exists(impact_run() / "states" / "impact.pvsm"));
}

TEST_CASE("the states of a profile draw depths a round number of times larger, within a fifth of its relief",
          "[states]") {
    const Json look = Json::parse(text_of(full_run() / "states" / "look.json"));
    const ProfileShape shape = profile_shape(full_run());
    REQUIRE(shape.deepest > 0.5);
    const auto [lowest, highest] = std::minmax_element(shape.elevation.begin(), shape.elevation.end());
    CHECK(shape.elevation.size() > 50);
    CHECK(*highest > *lowest + 10.0);
    CHECK(look["legend"] == 2);  // it rises to a ridge in the middle and ends higher than it began
    const std::string formula = look["profile"]["surface"];
    int times = 0;
    REQUIRE(std::sscanf(formula.c_str(), "initial_elevation+%d*(surface-initial_elevation)", &times) == 1);
    const double fifth = 0.2 * (*highest - *lowest);
    CHECK((times == 1 || times * shape.deepest <= fifth));
    CHECK(2.5 * times * shape.deepest > fifth);  // the next round number would be too large
    CHECK(look["profile"]["title"].get<std::string>().find("depths times") ==
          (times == 1 ? std::string::npos : std::string("Surfaces along the line, ").size()));
}

// They were drawn from the bed of their own time: a deposit that became bed lost its exaggeration.
TEST_CASE("the surfaces of a profile are drawn from the bed at the start, which its files have", "[states]") {
    const Json look = Json::parse(text_of(full_run() / "states" / "look.json"));
    for (const char* name : {"surface", "initial_surface"}) {
        const std::string formula = look["profile"][name];
        CHECK(formula.find("initial_elevation+") == 0);
        CHECK(formula.find(std::string("*(") + name + "-initial_elevation)") != std::string::npos);
    }
    const FreshFolder folder;
    const fs::path older = folder.path() / "run";
    fs::copy(full_run(), older, fs::copy_options::recursive);
    for (const fs::directory_entry& entry : fs::directory_iterator(older / "profiles")) {
        std::string text = text_of(entry.path());
        for (std::size_t at = 0; (at = text.find("\"initial_elevation", at)) != std::string::npos;)
            text.replace(at, 18, "\"another_elevation");
        write_text(entry.path(), text);
    }
    CHECK_THROWS_WITH(states_command({older, {"profiles"}}), Contains("without initial_elevation; run the case again"));
}

namespace {

/// A table with another number at a time: in its row, or in those of the steps before and after it.
void set_value(const fs::path& csv, const std::string& column, double time, double value) {
    Table table = read_table(csv);
    const auto at = std::find(table.columns.begin(), table.columns.end(), column) - table.columns.begin();
    std::string text;
    for (std::size_t c = 0; c < table.columns.size(); ++c)
        text += (c > 0 ? "," : "") + table.columns[c] + (table.units[c].empty() ? "" : " [" + table.units[c] + "]");
    text += '\n';
    const std::vector<double> t = table.column("t");
    bool found = false;
    for (std::size_t row = 0; row < t.size(); ++row) {
        const bool after = row > 0 && t[row] > time && t[row - 1] < time - 1e-9,
                   before = row + 1 < t.size() && t[row] < time && t[row + 1] > time + 1e-9,
                   here = std::abs(t[row] - time) < 1e-9 || after || before;
        found |= here;
        if (here) table.values[static_cast<std::size_t>(at)][row] = value;
        for (std::size_t c = 0; c < table.columns.size(); ++c) {
            const double cell = table.values[c][row];
            text += (c > 0 ? "," : "") + (std::isnan(cell) ? std::string() : fmt::format("{}", cell));
        }
        text += '\n';
    }
    REQUIRE(found);
    write_text(csv, text);
}

}  // namespace

// It was that with the largest mean since the output before, while pictures tell another mean.
TEST_CASE("the hardest output of an impact is that with the largest force that pictures tell", "[states]") {
    const FreshFolder folder;
    const fs::path run = folder.path() / "run";
    fs::copy(impact_run(), run, fs::copy_options::recursive);
    const double before = Json::parse(text_of(run / "states" / "look.json"))["impact_time"].get<double>();
    const std::string name = text_of(run / "barriers.csv");
    const std::size_t line = name.find('\n') + 1;
    const fs::path table = run / "barriers" / (name.substr(line, name.find(',', line) - line) + ".csv");
    const std::vector<double> times = barrier_times(run);
    const double other = times[times.size() - 2];
    REQUIRE(other != before);
    set_value(table, "mean_force", other, 1e9);
    REQUIRE(states_command({run, {}}) == 0);
    CHECK(Json::parse(text_of(run / "states" / "look.json"))["impact_time"].get<double>() == other);
}

// They ended below the largest value without a sign.
TEST_CASE("the bar of a state says so where values lie beyond its end", "[states]") {
    const FreshFolder folder;
    const fs::path run = folder.path() / "run";
    fs::copy(full_run(), run, fs::copy_options::recursive);
    const std::vector<double> times = frame_times(run);
    set_value(run / "history.csv", "max_depth", times.back(), 1234.0);
    REQUIRE(states_command({run, {}}) == 0);
    const Json look = Json::parse(text_of(run / "states" / "look.json"));
    CHECK(look["range"]["depth"][1].get<double>() < 1000.0);
    CHECK(look["bar"]["depth"] == "depth [m], up to 1.23e+03");
    for (const char* state : {"overview", "profiles"})
        CHECK(text_of(run / "states" / (std::string(state) + ".pvsm")).find("\"depth [m], up to 1.23e+03\"") !=
              std::string::npos);
    set_value(run / "history.csv", "max_depth", times.back(), 0.0);
    const double end = look["range"]["depth"][1].get<double>();
    double deepest = 0.0;
    for (Index k = 0; k < static_cast<Index>(times.size()); ++k)
        for (const double depth : read_frame(run, k).nodes.at("depth")) deepest = std::max(deepest, depth);
    REQUIRE(states_command({run, {}}) == 0);
    const std::string title = Json::parse(text_of(run / "states" / "look.json"))["bar"]["depth"];
    CHECK((deepest <= end || title.find("depth [m], up to ") == 0));
}

TEST_CASE("a structure of which no cohesion is left says so, and since when", "[states]") {
    const Json look = Json::parse(text_of(structure_run() / "states" / "look.json"));
    const std::string text = look["cohesion_text"];
    const std::vector<double> times = frame_times(structure_run());
    const auto largest = [&](Index number) {
        const std::vector<double> cohesion = read_frame(structure_run(), number).nodes.at("cohesion");
        return *std::max_element(cohesion.begin(), cohesion.end());
    };
    const bool left = largest(static_cast<Index>(times.size()) - 1) > 1e-3 * largest(0);
    CHECK((text.find("none at") == std::string::npos) == left);
    CHECK(text_of(structure_run() / "states" / "structure.pvsm").find('"' + text + '"') != std::string::npos);
}

TEST_CASE("ParaView's colours are those of the pictures", "[states]") {
    const Json presets = Json::parse(text_of(FRANA_SOURCE_DIR "/pvstates/frana_colours.json"));
    const std::map<std::string, Colormap> maps = {{"frana depth", Colormap::depth},
                                                  {"frana speed", Colormap::speed},
                                                  {"frana pressure", Colormap::pressure},
                                                  {"frana signed", Colormap::diverging}};
    REQUIRE(presets.size() == maps.size());
    for (const Json& preset : presets) {
        const std::vector<double> points = preset["RGBPoints"];
        REQUIRE(points.size() >= 4 * 9);
        for (std::size_t k = 0; k + 3 < points.size(); k += 4) {
            const Colour colour = colour_at(maps.at(preset["Name"]), points[k]);
            CHECK(std::abs(255.0 * points[k + 1] - colour.r) < 0.51);
            CHECK(std::abs(255.0 * points[k + 2] - colour.g) < 0.51);
            CHECK(std::abs(255.0 * points[k + 3] - colour.b) < 0.51);
        }
    }
}

TEST_CASE("a run with 3D points draws them, and frana figures does it again", "[space]") {
    const std::vector<std::string> pictures = {"view_impact.png", "section_impact.png", "view_points.png",
                                               "section_points.png"};
    const FreshFolder folder;
    const fs::path copy = folder.path() / "run";
    fs::copy(impact_run(), copy, fs::copy_options::recursive);
    fs::remove_all(copy / "figures");
    FiguresOptions options;
    options.run_dir = copy;
    options.time = 1.0;
    REQUIRE(figures_command(options) == 0);
    CHECK_FALSE(fs::exists(copy / "figures" / "view_points_t1s.png"));  // particles only
    options.time = 2.3;
    REQUIRE(figures_command(options) == 0);
    if (!no_renderer_reason().empty()) return;
    for (const std::string& picture : pictures) CHECK(fs::exists(copy / "figures" / picture));
    CHECK(fs::exists(copy / "figures" / "view_points_t2.3s.png"));
    CHECK(fs::exists(copy / "figures" / "section_points_t2.3s.png"));
}
