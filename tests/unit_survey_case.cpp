// [survey] of a case: what stands besides a footprint, and what is refused before the run.
#include <algorithm>

#include <cmath>

#include "scene/build_scene.h"
#include "scene/survey_files.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

const std::string loose = "[erodible]\ndepth = 0.5\nlaw = \"growth\"\ngrowth = 0.01\n";

CaseFile case_of(const std::string& survey) {
    return CaseFile::parse(
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
        "[time]\nend = 20\n" +
            survey,
        "slide/case.toml");
}

FakeGis surveyed_gis() {
    FakeGis gis = slope_gis();
    gis.polygons["footprint.geojson"] = rectangle(1020, 2040, 1100, 2090);
    gis.rasters["dod.tif"] = sampled({8, 6, 1002.5, 2002.5, 5.0}, [](double, double) { return -0.3; });
    gis.rasters["away.tif"] = sampled({8, 6, 9002.5, 2002.5, 5.0}, [](double, double) { return -0.3; });
    gis.lines["far.geojson"] = {{{9000, 2050}, {9100, 2050}}};
    return gis;
}

std::string problem_of(const std::string& survey) {
    return only_problem([&] { build_scene(case_of(survey), surveyed_gis()); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("A change of the bed is surveyed besides a footprint, with a noise of 0.1 m", "[scene][bed_change]") {
    const std::string survey = "[survey]\nfootprint = \"footprint.geojson\"\nbed_change = \"dod.tif\"\n";
    const SurveyFiles files = survey_files(case_of(loose + survey));
    CHECK(files.bed_change == "slide/dod.tif");
    CHECK((files.deposit.empty() && files.path.empty() && files.bed_change_noise == 0.1));
    CHECK(survey_files(case_of(loose + survey + "bed_change_noise = 0.25\n")).bed_change_noise == 0.25);
    CHECK(build_scene(case_of(loose + survey), surveyed_gis()).survey);
    CHECK(survey_files(case_of("")).footprint.empty());
}

TEST_CASE("A change of the bed that cannot be compared is refused before the run", "[scene][bed_change]") {
    const std::string footprint = "[survey]\nfootprint = \"footprint.geojson\"\n";
    CHECK(has(problem_of(footprint + "bed_change = \"dod.tif\"\n"),
              "slide/case.toml:10: survey.bed_change: found beside a bed that does not change; expected [erodible], "
              "[deposition] or [forest] with it"));
    CHECK(has(problem_of(loose + "[survey]\nbed_change = \"dod.tif\"\n"),
              "survey.bed_change: found without survey.footprint; expected the surveyed extent as well"));
    CHECK(has(problem_of(loose + footprint + "bed_change = \"away.tif\"\n"),
              "away.tif: has no value within x 1000 to 1200, y 2000 to 2150, where the run is; expected"));
    CHECK(has(problem_of(loose + footprint + "bed_change = \"gone.tif\"\n"), "gone.tif: no such raster"));
    CHECK(has(problem_of(footprint + "deposit = \"gone.tif\"\n"), "gone.tif: no such raster"));
    CHECK(has(problem_of(footprint + "path = \"none.geojson\"\n"), "none.geojson: holds 0 lines; expected one"));
    CHECK(has(problem_of(footprint + "path = \"far.geojson\"\n"),
              "survey.path: slide/far.geojson: found no point of its line on the terrain; expected the path within x "
              "1000 to 1200, y 2000 to 2150; check its coordinates and its CRS"));
    CHECK(has(problem_of(loose + footprint + "bed_change_noise = -1\n"), "survey.bed_change_noise"));
}

TEST_CASE("Elevations are no deposit", "[scene]") {
    FakeGis gis = surveyed_gis();
    gis.rasters["deposit.tif"] = sampled({8, 6, 1002.5, 2002.5, 5.0}, [](double, double) { return 1.5; });
    const CaseFile file = case_of("[survey]\nfootprint = \"footprint.geojson\"\ndeposit = \"deposit.tif\"\n");
    CHECK_NOTHROW(build_scene(file, gis));
    for (double& value : gis.rasters["deposit.tif"].values) value = 2900.0;
    CHECK(has(only_problem([&] { build_scene(file, gis); }),
              "deposit.tif: found thicknesses of up to 2900 m, on 100 % of the pixels more than 100 m; expected the "
              "thickness of the deposit, not elevations; subtract the ground below it"));
}

TEST_CASE("Elevations are no change of the bed; a change of more than 100 m is a remark", "[scene][bed_change]") {
    FakeGis gis = surveyed_gis();
    const CaseFile file = case_of(loose + "[survey]\nfootprint = \"footprint.geojson\"\nbed_change = \"dod.tif\"\n");
    Raster& change = gis.rasters["dod.tif"];
    change.at(3, 2) = -120.0;
    std::vector<std::string> log;
    read_bed_change(gis, "dod.tif", gis.rasters["dem.tif"].geometry, "", log);
    CHECK(std::any_of(log.begin(), log.end(), [](const std::string& line) {
        return has(line, "dod.tif: found changes of up to 120 m, on 2.08 % of the pixels more than 100 m");
    }));
    for (double& value : change.values) value = 2900.0;
    CHECK(has(only_problem([&] { build_scene(file, gis); }),
              "dod.tif: found changes of up to 2900 m, on 100 % of the pixels more than 100 m; expected the elevations "
              "after the event less those before it, not elevations; subtract them first"));
}
