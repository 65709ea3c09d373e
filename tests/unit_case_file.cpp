// The case file: what is read, and every complaint word for word.
#include <string>
#include <vector>

#include "base/error.h"
#include "catch.h"
#include "scene/case_file.h"

using namespace frana;

namespace {

const std::string least = R"([terrain]
dem = "dem.tif"
[[release]]
depth = 1.5
[time]
end = 20
)";

std::vector<std::string> problems_of(const std::string& text, const std::vector<std::string>& sets = {}) {
    try {
        CaseFile::parse(text, "case.toml", sets);
    } catch (const UserError& error) {
        return error.problems();
    }
    return {};
}

/// The one problem of a case that has exactly one.
std::string problem_of(const std::string& text, const std::vector<std::string>& sets = {}) {
    const std::vector<std::string> problems = problems_of(text, sets);
    CAPTURE(problems);
    REQUIRE(problems.size() == 1);
    return problems[0];
}

}  // namespace

TEST_CASE("The least case needs a DEM, a release with depth and an end, and the rest has defaults", "[case]") {
    const CaseFile file = CaseFile::parse(least, "slides/vajont/case.toml");
    CHECK(file.name() == "vajont");
    CHECK(CaseFile::parse(least, "slides/north.toml").name() == "north");
    CHECK(file.path("terrain.dem") == std::filesystem::path("slides/vajont/dem.tif"));
    CHECK(file.number("time.end") == 20.0);
    CHECK(file.count("release") == 1);
    CHECK(file.number("release.0.depth") == 1.5);
    CHECK(file.word("release.0.thickness") == "vertical");
    CHECK(file.number("scheme.cfl") == 1.0);
    CHECK(file.word("terrain.curvature") == "full");
    CHECK_FALSE(file.given("scheme.cfl"));
    CHECK_FALSE(file.has("grid.cell"));
}

TEST_CASE("An empty case lists everything that it lacks", "[case]") {
    const std::vector<std::string> expected = {
        "case.toml:1: release: not given; expected at least one [[release]] or [[inflow]], or free water with "
        "water.level; add [[release]] with outline and depth below",
        "case.toml:1: terrain.dem: not given; expected the name of a file in quotes, elevation model: any "
        "GDAL raster, "
        "CRS projected in metres; add dem = ... under [terrain]",
        "case.toml:1: time.end: not given; expected a number above 0 [s], simulated time; add end = ... "
        "under [time]"};
    CHECK(problems_of("") == expected);
}

TEST_CASE("A case with eight mistakes lists all eight, in the order of their lines", "[case]") {
    const std::string text = R"([terrain]
dem = 5
modle = "steep"
[grid]
cell = "5 m"
[[release]]
depth = -1.5
[material.bed]
law = "volmy"
[scheme]
cfl = nan
preset = "papr"
[output]
every = true
[time]
end = 1
)";
    const std::vector<std::string> expected = {
        "case.toml:2: terrain.dem: found 5; expected the name of a file in quotes; put the file's name in "
        "quotes",
        "case.toml:3: terrain.modle: found an unknown key; expected a key of [terrain]: dem, window, model, "
        "curvature, unrolled, "
        "gravity; did you mean terrain.model?",
        "case.toml:5: grid.cell: found the text \"5 m\"; expected a number above 0 [m]; write cell = 5.0, "
        "without quotes "
        "and unit",
        "case.toml:7: release.0.depth: found -1.5; expected a number above 0 [m] or the name of a raster; "
        "choose a value "
        "in this range",
        "case.toml:9: material.bed.law: found the text \"volmy\"; expected one of \"none\", \"coulomb\", "
        "\"voellmy\", "
        "\"manning\", \"bingham\", \"pouliquen\"; did you mean \"voellmy\"?",
        "case.toml:11: scheme.cfl: found nan; expected a number above 0 and at most 1; give a finite number",
        "case.toml:12: scheme.preset: found the text \"papr\"; expected one of \"default\", \"fast\", \"paper\"; did "
        "you mean "
        "\"paper\"?",
        "case.toml:14: output.every: found true; expected a number at least 1e-09 [s]; see `frana describe "
        "output.every`"};
    CHECK(problems_of(text) == expected);
}

TEST_CASE("Text that is not TOML is one problem with the line that breaks it", "[case]") {
    CHECK(problem_of("[grid]\ncell = 5 m\n") ==
          "case.toml:2: TOML: found broken TOML in the key-value pair: expected a comment or whitespace, saw "
          "'m'; "
          "expected key = value; correct this line: cell = 5 m");
    CHECK(problem_of("[grid]\ncell = 5\ncell = 6\n").find("case.toml:3: TOML: found broken TOML") == 0);
}

TEST_CASE("An unknown key names the one that was meant", "[case]") {
    const auto way_out = [](const std::string& text) {
        const std::string problem = problem_of(least + text);
        return problem.substr(problem.rfind("; ") + 2);
    };
    CHECK(way_out("[scheme]\nshap = \"linear\"\n") == "did you mean scheme.shape?");
    CHECK(way_out("[scheme]\npreste = \"paper\"\n") == "did you mean scheme.preset?");
    CHECK(way_out("[survey]\noutline = \"a.geojson\"\n") == "did you mean survey.footprint?");
    CHECK(way_out("[material]\nxi = 200\n") == "did you mean material.bed.xi?");
    CHECK(way_out("[materal]\ndensity = 1\n") == "did you mean material?");
    CHECK(way_out("[output]\nzzzz = 1\n") == "remove it, or see `frana describe`");
}

TEST_CASE("Tables in the wrong shape are named", "[case]") {
    CHECK(problem_of("[terrain]\ndem=\"a\"\n[release]\ndepth = 1\n[time]\nend=1\n") ==
          "case.toml:3: release: found a table; expected tables that may come several times; write "
          "[[release]] with "
          "double brackets");
    CHECK(problem_of("grid = 5\n" + least) ==
          "case.toml:1: grid: found 5; expected a table; write [grid] once and its keys below; `frana "
          "describe grid` "
          "lists them");
    CHECK(problem_of(least + "[[barrier]]\nheight = 20\n") ==
          "case.toml:7: barrier.0.outline: not given, and no line or mesh either; expected where the barrier stands; "
          "add outline = "
          "..., line = ... or mesh = ... under [[barrier]]");
}

TEST_CASE("A law needs its parameters and refuses those of others", "[case]") {
    CHECK(problem_of(least + "[material.bed]\nlaw = \"coulomb\"\nmu = 0.4\nxi = 200\n") ==
          "case.toml:10: material.bed.xi: found, but material.bed.law = \"coulomb\" does not use it; "
          "expected with voellmy "
          "only; remove it, or choose material.bed.law");
    CHECK(problem_of(least + "[material.bed]\nlaw = \"voellmy\"\nmu = 0.4\n") ==
          "case.toml:7: material.bed.xi: not given, but material.bed.law = \"voellmy\" needs it; expected a "
          "number above 0 "
          "[m/s^2] or the name of a raster, Voellmy's turbulence coefficient: larger runs faster; add xi = ... under "
          "[material.bed]");
    CHECK(problem_of(least + "[material.bed]\nlaw = \"coulomb\"\n") ==
          "case.toml:7: material.bed.friction_angle_deg: not given, but material.bed.law = \"coulomb\" needs "
          "it (or mu); "
          "expected a number at least 0 and below 90 [degree] or the name of a raster, friction angle at the bed; add "
          "friction_angle_deg = ... "
          "under [material.bed]");
    CHECK(problem_of(least + "[material.bed]\nlaw = \"coulomb\"\nmu = 0.4\nfriction_angle_deg = 20\n") ==
          "case.toml:9: material.bed.mu: found together with case.toml:10: material.bed.friction_angle_deg; "
          "expected only "
          "one of the two; remove one of them");
    CHECK(problem_of(least + "[material.bed]\nlaw = \"pouliquen\"\nmu_s = 0.4\nmu_2 = 0.3\ngrain_diameter=1e-3\n") ==
          "case.toml:10: material.bed.mu_2: found 0.3; expected more than mu_s = 0.4; mu_s is the friction "
          "of slow flow, "
          "mu_2 that of fast flow; correct one");
    CHECK(problem_of(least + "[material.rheology]\nlaw = \"newtonian\"\nviscosity = 1\nyield_stress = 1\n")
              .find("case.toml:10: material.rheology.yield_stress: found, but") == 0);
    CHECK(problem_of(least + "[scheme]\nflip_ratio = 0.9\n").find("scheme.transfer = \"tpic\" does not use it") !=
          std::string::npos);
    CHECK(problem_of(least + "[scheme]\nprecision = \"float\"\nshape = \"cubic\"\n") ==
          "case.toml:8: scheme.precision: found \"float\" with another preset, shape or transfer than the default; "
          "expected \"double\", since only the default kernels have the other; remove it, or use the default preset, "
          "shape and transfer");
    CHECK(problem_of(least + "[scheme]\nstill_level = 10\n").find("expected with paper only") != std::string::npos);
    CHECK(problems_of(least + "[material.bed]\nlaw = \"manning\"\nmanning_n = 0.03\n").empty());
}

TEST_CASE("Keys that contradict each other are refused", "[case]") {
    CHECK(problem_of(least + "[particles]\nper_cell = 4\ncount = 100\n").find("together with") != std::string::npos);
    CHECK(problem_of("[terrain]\ndem=\"a\"\nwindow=[0, 0, -1, 5]\n[[release]]\ndepth=1\n[time]\nend=1\n") ==
          "case.toml:3: terrain.window: found [0.0, 0.0, -1.0, 5.0]; expected [xmin, ymin, xmax, ymax] with "
          "xmin < xmax "
          "and ymin < ymax; put the smaller coordinates first");
    CHECK(problem_of("[terrain]\ndem=\"a\"\nmodel=\"shallow\"\ncurvature=\"full\"\n[[release]]\ndepth=1\n["
                     "time]\nend=1\n")
              .find("case.toml:4: terrain.curvature: found \"full\" with terrain.model = \"shallow\"") == 0);
    CHECK(problem_of(least + "[output]\nformats=[\"png\"]\nfilm=\"mp4\"\n") ==
          "case.toml:9: output.film: found \"mp4\" without \"vtk\" in output.formats; expected the frames that a film "
          "is made of; add \"vtk\" to output.formats, or remove film");
    const std::string head = "[terrain]\ndem=\"a\"\n[time]\nend=1\n[[release]]\n";
    CHECK(problem_of(head + "outline=\"a\"\n").find("case.toml:5: release.0.depth: not given, and no surface either") ==
          0);
    CHECK(problem_of(head + "surface=5\nthickness=\"normal\"\n").find("release.0.thickness: found \"normal\"") !=
          std::string::npos);
    CHECK(problem_of(head + "surface=5\nincluded_in_dem=true\n").find("release.0.included_in_dem: found true") !=
          std::string::npos);
    CHECK(problem_of(least + "[[gauge]]\nname=\"a\"\npoint=[0,0]\n[[gauge]]\nname=\"a\"\npoint=[1,1]\n") ==
          "case.toml:11: gauge.1.name: found \"a\" again; expected a name other than that at case.toml:8: "
          "gauge.0.name; "
          "rename one of them");
}

TEST_CASE("Lists are checked value by value", "[case]") {
    CHECK(problem_of(least + "[output]\nformats = [\"vtk\", \"tif\"]\n").find("found the text \"tif\"") !=
          std::string::npos);
    CHECK(problem_of(least + "[[gauge]]\nname = \"a\"\npoint = [1]\n")
              .find("found a list of 1 value; expected a list of 2") != std::string::npos);
    CHECK(problem_of(least + "[[profile]]\nname = \"a b\"\nline = [[0, 0], [1, 1]]\n")
              .find("profile.0.name: found the text \"a b\"; expected a text in quotes of up to 200 letters") !=
          std::string::npos);
    CHECK(problem_of(least + "[[profile]]\nname = \"a\"\nline = [[0, 0], [0, 0]]\n").find("comes twice") !=
          std::string::npos);
    CHECK(problem_of(least + "[[profile]]\nname = \"a\"\nline = [[0, 0]]\n").find("add points") != std::string::npos);
    CHECK(problem_of(least + "[particles]\nper_cell = 2.5\n").find("expected a whole number") != std::string::npos);
    const CaseFile file = CaseFile::parse(least + "[output]\nfields = [\"depth\", \"speed\"]\n", "case.toml");
    CHECK(file.words("output.fields") == std::vector<std::string>{"depth", "speed"});
}

TEST_CASE("--set overrides any key, and its mistakes are those of --set", "[case][set]") {
    const std::vector<std::string> sets = {
        "grid.cell=2.5",     "terrain.model = shallow", "release.0.depth=deep.tif", "release.0.velocity=[1, -2]",
        "release.1.depth=3", "case.title=2024"};
    const CaseFile file = CaseFile::parse(least, "case.toml", sets);
    CHECK(file.number("grid.cell") == 2.5);
    CHECK(file.word("terrain.model") == "shallow");
    CHECK(file.word("terrain.curvature") == "none");
    CHECK(file.word("release.0.depth") == "deep.tif");
    CHECK(file.numbers("release.0.velocity") == std::vector<double>{1.0, -2.0});
    CHECK(file.count("release") == 2);
    CHECK(file.word("case.title") == "2024");
    CHECK(file.place("grid.cell") == "--set grid.cell");
    CHECK(CaseFile::parse(least, "case.toml", {"release.0.depth=.5"}).number("release.0.depth") == 0.5);
    CHECK(CaseFile::parse(least, "case.toml", {"grid.cell=2."}).number("grid.cell") == 2.0);
    CHECK(CaseFile::parse(least, "case.toml", {"case.title=.5"}).word("case.title") == ".5");

    CHECK(problem_of(least, {"grid.cell=-1"}) ==
          "--set grid.cell: found -1; expected a number above 0 [m]; choose a value in this range");
    CHECK(problem_of(least, {"grid.cel=1"}).find("--set grid.cel: found an unknown key; ") == 0);
    const std::string no_table = problem_of(least, {"foo.bar=1"});
    CHECK(no_table.find("--set foo.bar: found an unknown key; expected one of the tables ") == 0);
    CHECK(no_table.find(" terrain, ") != std::string::npos);
    const std::string long_name =
        problem_of(least + "[[gauge]]\npoint = [0, 0]\nname = \"" + std::string(201, 'a') + "\"\n");
    CAPTURE(long_name);
    CHECK(long_name.find("expected a text in quotes of up to 200 letters, digits, - and _") != std::string::npos);
    CHECK(problem_of(least, {"grid.cell"}) ==
          "--set grid.cell: found no key and value; expected key=value; write it like --set grid.cell=2.5");
    CHECK(problem_of(least, {"release.depth=2"}) ==
          "--set release.depth: found no number of the table; expected release.0 to release.1; number the "
          "tables from 0, "
          "such as release.0.depth");
    CHECK(problem_of(least, {"release.5.depth=2"}).find("found number 5; expected release.0 to release.1") !=
          std::string::npos);
    CHECK(problem_of(least, {"time.0.end=2"}).find("--set time.0.end: found a number in the key") == 0);
    CHECK(problem_of(least, {"time.end=1\nextra=2"}).find("found the text") != std::string::npos);
}

TEST_CASE("--set displaces what the file says in another way, and says so", "[case][set]") {
    const std::string voellmy = least + "[material.bed]\nlaw = \"voellmy\"\nmu = 0.4\nxi = 200\n";
    const CaseFile angle = CaseFile::parse(voellmy, "case.toml", {"material.bed.friction_angle_deg=20"});
    CHECK_FALSE(angle.given("material.bed.mu"));
    CHECK(angle.log() ==
          std::vector<std::string>{"case.toml:9: material.bed.mu: replaced by --set material.bed.friction_angle_deg"});
    const CaseFile coulomb = CaseFile::parse(voellmy, "case.toml", {"material.bed.law=coulomb"});
    CHECK_FALSE(coulomb.given("material.bed.xi"));
    CHECK(coulomb.given("material.bed.mu"));
    CHECK(coulomb.log() == std::vector<std::string>{
                               "case.toml:10: material.bed.xi: not used, since --set material.bed.law is \"coulomb\""});
}

TEST_CASE("The paper preset changes defaults, and single keys override it", "[case]") {
    const CaseFile file = CaseFile::parse(least + "[scheme]\npreset = \"paper\"\ncfl = 0.4\n", "case.toml");
    CHECK(file.word("scheme.shape") == "linear");
    CHECK(file.word("scheme.transfer") == "pic");
    CHECK_FALSE(file.flag("scheme.split"));
    CHECK_FALSE(file.flag("scheme.mass_fit"));
    CHECK(file.number("scheme.filter") == 0.0);
    CHECK(file.number("scheme.viscosity_linear") == 0.0);
    CHECK(file.number("scheme.viscosity_quadratic") == 0.0);
    CHECK(file.number("scheme.cfl") == 0.4);
    CHECK(file.word("terrain.model") == "shallow");
    CHECK(file.word("terrain.curvature") == "none");
    const CaseFile plain = CaseFile::parse(least + "[scheme]\npreset = \"paper\"\n", "case.toml");
    CHECK(plain.number("scheme.cfl") == 0.25);
}

TEST_CASE("read() names a case file that is not there, and files that the case names in vain", "[case]") {
    CHECK_THROWS_WITH(CaseFile::read("no/such/case.toml"),
                      Catch::Contains("no/such/case.toml: found no file that can be read"));
    CHECK_THROWS_WITH(CaseFile::read(std::filesystem::temp_directory_path()), Catch::Contains("found a folder"));
}
