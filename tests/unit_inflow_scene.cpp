// [[inflow]] and [[section]] of a case: what they become, and what is refused.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "catch.h"
#include "fresh_folder.h"
#include "scene/build_scene.h"
#include "scene/inflow_facts.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

/// On the slope of 1 in 2, which falls to the west. A line from south to north; no release.
const std::string kLine = "line = [[1100, 2050], [1100, 2080]]\n";

std::string with(const std::string& inflow, const std::string& bed = "law = \"voellmy\"\nmu = 0.1\nxi = 400\n") {
    return "[terrain]\ndem = \"dem.tif\"\n[material.bed]\n" + bed +
           "[time]\nend = 20\n[[inflow]]\nname = \"torrent\"\n" + inflow;
}

Scene built(const std::string& text, const std::filesystem::path& folder = "slide") {
    return build_scene(CaseFile::parse(text, folder / "case.toml"), slope_gis());
}

/// After its place in the case.
std::string problem_of(const std::string& text) {
    return only_problem([&] { built(text); });
}

bool says(const std::string& problem, const std::string& key, const std::string& begin) {
    CAPTURE(problem);
    const std::size_t at = problem.find(": inflow.0." + key + ": " + begin);
    return at != std::string::npos && problem.find("; expected") != std::string::npos;
}

}  // namespace

TEST_CASE("A triangle of discharge has the peak, the beginning and the rise that are given", "[scene][inflow]") {
    const Scene scene = built(with(kLine + "volume = 1000\npeak = 20.0\nat = 5\nrise = 40\n"));
    const InflowFacts facts = facts_of(scene.inflows.at(0), scene.gravity);
    CHECK(facts.volume == Approx(1000.0));
    CHECK(facts.peak == Approx(20.0));
    CHECK(facts.peak_time == Approx(45.0));
    CHECK(facts.end == Approx(105.0));
    CHECK(says(problem_of(with(kLine + "volume = 1000\npeak = 20\nrise = 100\n")), "volume",
               "found a rise of 100 s; expected less than the 100 s"));
    CHECK(says(problem_of(with(kLine + "volume = 1000\npeak = -2\n")), "peak", "found -2"));
}

TEST_CASE("An inflow without a release is a scene", "[scene][inflow]") {
    const Scene scene = built(with(kLine + "volume = 1000\npeak = \"rickenmann\"\n"));
    CHECK(scene.particles.count() == 0);
    REQUIRE(scene.inflows.size() == 1);
    const Inflow& inflow = scene.inflows[0];
    CHECK(inflow.name == "torrent");
    CHECK_FALSE(inflow.to_right);  // to the west of a line to the north
    CHECK(inflow.slope == Approx(0.5));
    CHECK(inflow.spacing == 2.5);
    const InflowFacts facts = facts_of(inflow, scene.gravity);
    CHECK(facts.volume == Approx(1000.0));
    CHECK(facts.peak == Approx(31.6).epsilon(2e-3));
    CHECK(facts.peak_time == Approx(0.1 * facts.end));
    CHECK(facts.width == 30.0);
    // Voellmy: h^3 = q^2 / (xi (sin - mu cos)), q the discharge per width.
    const double cosine = 1.0 / std::sqrt(1.25), q = facts.peak / 30.0;
    CHECK(facts.thickness == Approx(std::cbrt(q * q / (400.0 * (0.5 - 0.1) * cosine))).epsilon(1e-10));
    CHECK(facts.speed == Approx(q / facts.thickness).epsilon(1e-10));
    CHECK(facts.froude == Approx(facts.speed / std::sqrt(9.81 * cosine * facts.thickness)).epsilon(1e-10));
    const auto& log = scene.log;
    CHECK(std::any_of(log.begin(), log.end(), [](const std::string& line) {
        return line.rfind("inflow torrent: 1000 m3 until ", 0) == 0 && line.find("Froude number") != std::string::npos;
    }));
}

TEST_CASE("The side and the speed of an inflow may be given", "[scene][inflow]") {
    const FreshFolder folder;
    std::ofstream(folder.path() / "q.csv") << "t_min, discharge [m3/s], velocity [m/s]\n0, 2, 3\n1, 4, 5\n";
    const Scene up =
        built(with(kLine + "table = \"q.csv\"\nvelocity = \"column\"\ntowards = [1190, 2060]\n"), folder.path());
    CHECK(up.inflows[0].to_right);
    CHECK(up.inflows[0].slope == Approx(-0.5));
    CHECK(up.inflows[0].time == std::vector<double>{0.0, 60.0});
    CHECK(up.inflows[0].speed[1] == Approx(5.0 / std::sqrt(1.25)));
    const auto of_velocities = [](const Scene& scene) {
        return std::count_if(scene.log.begin(), scene.log.end(), [](const std::string& remark) {
            return remark.find("velocities of its table are not used") != std::string::npos;
        });
    };
    CHECK(of_velocities(built(with(kLine + "table = \"q.csv\"\n"), folder.path())) == 1);
    CHECK(of_velocities(built(with(kLine + "table = \"q.csv\"\nvelocity = \"normal\"\n"), folder.path())) == 0);
    const Scene number = built(with(kLine + "table = \"q.csv\"\nvelocity = 7\n"), folder.path());
    CHECK(of_velocities(number) == 0);
    CHECK(number.inflows[0].speed == std::vector<double>(2, 7.0 / std::sqrt(1.25)));
}

TEST_CASE("A table may go on long after the run, but not bring more by its end than the terrain holds",
          "[scene][inflow]") {
    const FreshFolder folder;
    std::ofstream(folder.path() / "river.csv") << "t [s], discharge [m3/s]\n0, 200\n8640000, 200\n";
    std::ofstream(folder.path() / "litres.csv") << "t [s], discharge [m3/s]\n0, 2e6\n8640000, 2e6\n";
    const Scene river = built(with(kLine + "table = \"river.csv\"\n"), folder.path());
    const bool told = std::any_of(river.log.begin(), river.log.end(), [](const std::string& remark) {
        return remark.find("found a table that goes on to 8.64e+06 s") != std::string::npos;
    });
    CHECK(told);
    CHECK(only_problem([&] {
              built(with(kLine + "table = \"litres.csv\"\n"), folder.path());
          }).find("m3 by time.end, more than 100 m") != std::string::npos);
}

TEST_CASE("Of a triangle that outlasts the run the way out is time.end or at, and no table", "[scene][inflow]") {
    const std::string triangle = kLine + "volume = 1000\npeak = 20.0\n";  // takes 100 s
    const Scene scene = built(with(triangle + "at = 5\n"));
    CHECK(std::count(scene.log.begin(), scene.log.end(),
                     "inflow torrent: found that the triangle of volume goes on to 105 s; expected time.end = 20 s or "
                     "less; what comes later does not come in; give a later time.end, or a smaller at") == 1);
    CHECK(says(problem_of(with(triangle + "at = 30\n")), "volume",
               "found that the triangle of volume begins at 30 s; expected a time before time.end = 20 s; give a "
               "smaller at, or a later time.end"));
}

TEST_CASE("The line of an inflow, and of a section, may be that of a vector file", "[scene][inflow][sections]") {
    FakeGis gis = slope_gis();
    gis.lines["line.geojson"] = {{{1100, 2050}, {1100, 2050}, {1100, 2080}}};  // its first point twice
    gis.lines["two.geojson"] = {{{1100, 2050}, {1100, 2060}}, {{1100, 2070}, {1100, 2080}}};
    gis.lines["dot.geojson"] = {{{1100, 2050}, {1100, 2050}}};
    const auto scene_of = [&](const std::string& file) {
        const std::string text =
            with("line = \"" + file + "\"\nvolume = 1000\n[[section]]\nname = \"a\"\nline = \"" + file + "\"\n");
        return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
    };
    const Scene drawn = built(with(kLine + "volume = 1000\n[[section]]\nname = \"a\"\n" + kLine)),
                read = scene_of("line.geojson");
    CHECK(read.inflows[0].line == drawn.inflows[0].line);
    CHECK(read.inflows[0].speed == drawn.inflows[0].speed);
    CHECK(read.sections[0].line == drawn.sections[0].line);
    CHECK(read.sections[0].to_right == drawn.sections[0].to_right);
    const auto problems_of = [&](const std::string& file) {
        try {
            scene_of(file);
        } catch (const UserError& error) {
            return error.problems();
        }
        return std::vector<std::string>();
    };
    for (const auto& [file, text] :
         {std::pair("two.geojson", "slide/two.geojson: holds 2 lines; expected one"),
          std::pair("dot.geojson", "found a line of one point; expected two that are apart")}) {
        const std::vector<std::string> problems = problems_of(file);
        CAPTURE(problems);
        REQUIRE(problems.size() == 2);
        for (const std::string& problem : problems) CHECK(problem.find(text) != std::string::npos);
        CHECK(problems[0].find("section.0.line: ") != std::string::npos);
        CHECK(problems[1].find("inflow.0.line: ") != std::string::npos);
    }
}

TEST_CASE("What an inflow cannot be is said in a sentence", "[scene][inflow]") {
    const std::string volume = "volume = 1000\n";
    CHECK(says(problem_of(with(kLine)), "table", "not given, and no volume either"));
    CHECK(says(problem_of(with(kLine + "table = \"q.csv\"\npeak = \"rickenmann\"\n")), "peak",
               "found together with table"));
    for (const char* of_volume : {"at", "rise"})
        CHECK(says(problem_of(with(kLine + "table = \"q.csv\"\n" + of_volume + " = 4\n")), of_volume,
                   "found together with table; expected it with volume only"));
    CHECK(says(problem_of(with(kLine + volume + "areal = 3\n")), "areal", "found an unknown key"));
    CHECK(says(problem_of(with(kLine + volume + "velocity = 0\n")), "velocity", "found 0"));
    CHECK(says(problem_of(with("line = [[1100, 2050], [1100, 2053]]\n" + volume)), "line", "found a line of 3 m"));
    CHECK(says(problem_of(with("line = [[900, 2050], [900, 2080]]\n" + volume)), "line",
               "found 900, 2050 outside of the terrain"));
    CHECK(says(problem_of(with("line = [[1010, 2050], [1010, 2080]]\n" + volume)), "line", "found 1010, 2050 outside"));
    CHECK(says(problem_of(with("line = [[1050, 2060], [1100, 2060]]\n" + volume)), "line",
               "found a line that runs down the slope of 26.6 degrees; expected one across the flow; turn it"));
    CHECK(says(problem_of(with(kLine + volume + "towards = [1100, 2200]\n")), "towards", "found towards on the line"));
    CHECK(says(problem_of(with(kLine + volume + "towards = [1190, 2060]\n")), "velocity",
               "found velocity = \"normal\" on ground that rises by 26.6 degrees; expected a slope that the flow goes "
               "down; give velocity = a number [m/s], or correct towards"));
    CHECK(says(problem_of(with(kLine + volume, "law = \"voellmy\"\nmu = 0.6\nxi = 400\n")), "velocity",
               "found velocity = \"normal\" where the material stops"));
    CHECK(says(problem_of(with(kLine + volume, "law = \"coulomb\"\nmu = 0.2\n")), "velocity",
               "found velocity = \"normal\" with a bed law by which the flow gets faster for ever"));
    CHECK(says(problem_of(with(kLine + volume + "velocity = \"column\"\n")), "velocity",
               "found velocity = \"column\" and a table without one"));
    CHECK(says(problem_of(with(kLine + "volume = 1e9\n")), "volume", "found 1e+09 m3, more than 100 m of depth"));
    CHECK(says(problem_of(with(kLine + "table = \"q.csv\"\n")), "table", "slide/q.csv: found no file"));
}

TEST_CASE("Material may come in over an area, at rest", "[scene][inflow][area]") {
    FakeGis gis = slope_gis();
    gis.polygons["breach.geojson"] = rectangle(1100, 2050, 1120, 2070);
    const auto scene_of = [&](const std::string& inflow) {
        return build_scene(CaseFile::parse(with(inflow + "volume = 300\n"), "slide/case.toml"), gis);
    };
    const Scene read = scene_of("area = \"breach.geojson\"\n"),
                drawn = scene_of("area = [[1100, 2050], [1120, 2050], [1120, 2070], [1100, 2070]]\n");
    for (const Scene* scene : {&read, &drawn}) {
        REQUIRE(scene->inflows.size() == 1);
        const Inflow& inflow = scene->inflows[0];
        CHECK(inflow.area == Approx(400.0).epsilon(1e-12));
        double sum = 0.0;
        Vec2 middle(0, 0);
        for (const Inflow::Patch& patch : inflow.patches) sum += patch.share, middle += patch.share * patch.at;
        CHECK(sum == Approx(1.0).epsilon(1e-13));
        CHECK(middle.x() == Approx(1110.0));
        CHECK(middle.y() == Approx(2060.0));
        // 0.75 m in all, in layers of a hundredth of a cell of 5 m would be 15: it is fifty, the last one a half.
        CHECK(inflow.layer == Approx(0.75 / 49.5));
        CHECK(inflow.speed == std::vector<double>(inflow.time.size(), 0.0));
        CHECK(std::any_of(scene->log.begin(), scene->log.end(), [](const std::string& line) {
            return line.rfind("inflow torrent: 300 m3 until ", 0) == 0 &&
                   line.find("at rest over 400 m2") != std::string::npos;
        }));
    }
    CHECK(scene_of("area = \"breach.geojson\"\n").inflows[0].patches.size() == read.inflows[0].patches.size());
}

TEST_CASE("What an area of an inflow cannot be is said in a sentence", "[scene][inflow][area]") {
    const std::string area = "area = [[1100, 2050], [1120, 2050], [1120, 2070]]\n", volume = "volume = 300\n";
    CHECK(says(problem_of(with(volume)), "line", "not given, and no area either"));
    CHECK(says(problem_of(with(kLine + area + volume)), "line", "found together with"));
    CHECK(says(problem_of(with(area + volume + "velocity = 3\n")), "velocity", "found together with area"));
    CHECK(says(problem_of(with(area + volume + "towards = [1100, 2200]\n")), "towards", "found together with area"));
    CHECK(says(problem_of(with("area = [[1100, 2050], [1120, 2050]]\n" + volume)), "area", "found a list of 2 values"));
    for (const char* flat :
         {"[[1100, 2050], [1120, 2050], [1140, 2050]]", "[[1100, 2050], [1120, 2060], [1100, 2050]]"})
        CHECK(says(problem_of(with("area = " + std::string(flat) + "\n" + volume)), "area",
                   "found an outline without area, such as a line; expected the outline of an area"));
    CHECK(says(problem_of(with("area = [[1100, 2050], [1120, 2070], [1120, 2050], [1100, 2070]]\n" + volume)), "area",
               "found an outline that crosses itself"));
    CHECK(says(problem_of(with("area = [[1100, 2050], [1102, 2050], [1102, 2052]]\n" + volume)), "area",
               "found an area of 2 m2"));
    CHECK(says(problem_of(with("area = [[900, 2050], [1120, 2050], [1120, 2070]]\n" + volume)), "area",
               "found 900, 2050 outside of the terrain"));
    FakeGis holed = slope_gis();
    holed.rasters["dem.tif"].at(22, 11) = Raster::nodata;
    const std::string problem =
        only_problem([&] { build_scene(CaseFile::parse(with(area + volume), "slide/case.toml"), holed); });
    CAPTURE(problem);
    CHECK(problem.find(": inflow.0.area: ") != std::string::npos);
}

TEST_CASE("A line across a ridge has no side to flow to", "[scene][inflow]") {
    FakeGis gis = slope_gis();
    gis.rasters["dem.tif"] =
        sampled({40, 30, 1002.5, 2002.5, 5.0}, [](double x, double) { return 200.0 - std::abs(x - 1101.0); });
    const auto problem = only_problem([&] {
        build_scene(CaseFile::parse(with("line = [[1080, 2050], [1125, 2052]]\nvolume = 100\n"), "slide/case.toml"),
                    gis);
    });
    CHECK(says(problem, "line", "found "));
}

TEST_CASE("Ground without a side to flow to is said to be what it is", "[scene][inflow]") {
    const auto problem = [](double (*height)(double, double), const std::string& line) {
        FakeGis gis = slope_gis();
        gis.rasters["dem.tif"] = sampled({40, 30, 1002.5, 2002.5, 5.0}, height);
        return only_problem(
            [&] { build_scene(CaseFile::parse(with("line = " + line + "\nvolume = 100\n"), "slide/case.toml"), gis); });
    };
    const auto ridge = [](double x, double) { return 200.0 - 0.4 * std::abs(x - 1102.5); };
    CHECK(says(problem([](double, double) { return 7.0; }, "[[1080, 2050], [1120, 2050]]"), "line",
               "found flat ground under the line; expected a slope"));
    // Over the ridge, slantwise: what falls to the one side falls to the other.
    CHECK(says(problem(ridge, "[[1072.5, 2042.5], [1132.5, 2102.5]]"), "line",
               "found ground that slopes to one side of the line as much as to the other"));
    CHECK(says(problem(ridge, "[[1102.5, 2050], [1102.5, 2080]]"), "line",
               "found a line along a ridge, which falls to both sides by 21.8 degrees"));
    CHECK(says(problem([](double x, double) { return 200.0 + 0.4 * std::abs(x - 1102.5); },
                       "[[1102.5, 2050], [1102.5, 2080]]"),
               "line", "found a line along a valley's floor, which rises to both sides by 21.8 degrees"));
    CHECK(says(problem(ridge, "[[1112.5, 2050], [1142.5, 2050]]"), "line",
               "found a line that runs down the slope of 21.8 degrees"));
}

TEST_CASE("A flow that is sent up the slope with a speed of its own is a remark", "[scene][inflow][remarks]") {
    const auto told = [](const std::string& towards) {
        const Scene scene = built(with(kLine + "volume = 1000\nvelocity = 5\n" + towards));
        return std::count_if(scene.log.begin(), scene.log.end(), [](const std::string& remark) {
            return remark.find("inflow.0.towards: found a line that the flow leaves up a slope of 26.6 degrees") !=
                   std::string::npos;
        });
    };
    CHECK(told("towards = [1190, 2060]\n") == 1);
    CHECK(told("towards = [1010, 2060]\n") == 0);
    CHECK(told("") == 0);
}

TEST_CASE("A section counts down the slope as positive", "[scene][sections]") {
    const std::string rest = "volume = 1000\n[[section]]\nname = \"a\"\n" + kLine +
                             "[[section]]\nname = \"b\"\nline = [[1100, 2080], [1100, 2050]]\n";
    const Scene scene = built(with(kLine + rest));
    REQUIRE(scene.sections.size() == 2);
    CHECK_FALSE(scene.sections[0].to_right);
    CHECK(scene.sections[1].to_right);
    const std::string problem = only_problem(
        [&] { built(with(kLine + "volume = 1000\n[[section]]\nname = \"a\"\nline = [[0, 0], [1, 0]]\n")); });
    CHECK(problem.find("section.0.line: found no point of it on the terrain; expected it within") != std::string::npos);
}
