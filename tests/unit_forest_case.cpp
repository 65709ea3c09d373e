// [forest] of a case: its detrainment, its outline, its limits, and what is wrong with them.
#include <fmt/format.h>

#include <cmath>

#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

Scene scene_of(const FakeGis& gis, const std::string& forest) {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                       "depth = 2\n[time]\nend = 20\n[material]\ndensity = 300\n[forest]\n" +
                                           forest,
                                       "slide/case.toml"),
                       gis);
}

std::string problem_of(const FakeGis& gis, const std::string& forest) {
    return only_problem([&] { scene_of(gis, forest); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string remarks_of(const Scene& scene) {
    std::string all;
    for (const std::string& remark : scene.log) all += remark + "\n";
    return all;
}

}  // namespace

TEST_CASE("A case has no forest unless it gives a detrainment above 0", "[forest][scene]") {
    CHECK_FALSE(scene_of(slope_gis(), "").forest);
    CHECK_FALSE(scene_of(slope_gis(), "").bed_changes());
    const Scene none = scene_of(slope_gis(), "detrainment = 0\n");
    CHECK_FALSE(none.forest);
    CHECK(has(remarks_of(none), "forest.detrainment: it is 0 everywhere on the terrain: no forest"));
}

TEST_CASE("A detrainment beyond what circulates is remarked upon", "[forest][scene][remarks]") {
    const std::string expected = "expected 5 to 150 Pa, as in cases/PARAMETERS.md";
    for (const char* fit : {"5", "50", "150"})
        CHECK_FALSE(has(remarks_of(scene_of(slope_gis(), fmt::format("detrainment = {}\n", fit))), expected));
    for (const char* far : {"1", "5000"})
        CHECK(has(remarks_of(scene_of(slope_gis(), fmt::format("detrainment = {}\n", far))), expected));
}

TEST_CASE("A forest has its detrainment everywhere, or where its outline or its raster says", "[forest][scene]") {
    FakeGis gis = slope_gis();
    const Scene scene = scene_of(gis, "detrainment = 50\nmax_speed = 6\nmax_depth = 0.6\n");
    const Forest& forest = scene.forest.value();
    CHECK(forest.pressure.geometry == scene.bed.geometry);
    CHECK((forest.pressure.at(0, 0) == 50.0 && forest.pressure.at(39, 29) == 50.0));
    CHECK((forest.law.min_speed == 0.1 && forest.law.max_speed == 6.0 && forest.law.max_depth == 0.6));
    CHECK(scene.bed_evolves());
    CHECK(has(remarks_of(scene), "forest: 3 ha, with a detrainment of 50 Pa"));

    gis.polygons["wood.geojson"] = rectangle(1040, 2020, 1060, 2037.5);  // nodes are 1042.5, ..., 2022.5, ...
    const Raster outlined = scene_of(gis, "detrainment = 50\noutline = \"wood.geojson\"\n").forest->pressure;
    CHECK((outlined.at(8, 4) == 50.0 && outlined.at(11, 6) == 50.0));
    CHECK((outlined.at(7, 4) == 0.0 && outlined.at(12, 6) == 0.0 && outlined.at(8, 3) == 0.0));
    CHECK(std::isinf(scene_of(gis, "detrainment = 50\n").forest->law.max_speed));

    gis.rasters["stands.tif"] =
        sampled(gis.rasters["dem.tif"].geometry, [](double x, double) { return x < 1050 ? 20.0 : 80.0; });
    gis.rasters["stands.tif"].at(9, 6) = NAN;
    const Scene stands = scene_of(gis, "detrainment = \"stands.tif\"\n");
    CHECK((stands.forest->pressure.at(8, 6) == 20.0 && stands.forest->pressure.at(20, 6) == 80.0));
    CHECK(stands.forest->pressure.at(9, 6) == 0.0);
    CHECK(has(remarks_of(stands), "forest.detrainment: 0.0833 % of the terrain's nodes have no data there"));
    CHECK(has(remarks_of(stands), "with a detrainment of 20 to 80 Pa"));
}

TEST_CASE("What is wrong with [forest] is said in one sentence", "[forest][scene]") {
    FakeGis gis = slope_gis();
    CHECK(has(problem_of(gis, "detrainment = -5\n"), "expected a number at least 0 and at most 10000 [Pa]"));
    CHECK(has(problem_of(gis, "detrainment = 50000\n"), "expected a number at least 0 and at most 10000 [Pa]"));
    CHECK(has(problem_of(gis, "detrainment = 50\nmax_speed = 0\n"), "expected a number above 0 [m/s]"));
    CHECK(has(problem_of(gis, "outline = \"wood.geojson\"\n"),
              "forest.outline: found without detrainment; expected it with forest.detrainment only; add detrainment = "
              "... [Pa] under [forest], or remove it"));
    CHECK(has(problem_of(gis, "max_depth = 0.6\n"), "forest.max_depth: found without detrainment"));
    gis.polygons["far.geojson"] = rectangle(5000, 5000, 5100, 5100);
    CHECK(has(problem_of(gis, "detrainment = 50\noutline = \"far.geojson\"\n"),
              "forest.outline: found no node of the terrain in it; expected some; correct the outline or its CRS"));
    gis.rasters["stands.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 50.0; });
    gis.rasters["stands.tif"].at(7, 5) = -0.5;
    CHECK(has(problem_of(gis, "detrainment = \"stands.tif\"\n"),
              "stands.tif: found 1 pixel(s) out of range, such as -0.5 at x 1037.5, y 2027.5; expected numbers"));
    CHECK(has(problem_of(gis, "detrainment = 50\n[scheme]\nshape = \"cubic\"\n"), "the shapes that share out a bed"));
    CHECK(has(problem_of(gis, "detrainment = 50\n[erodible]\nlaw = \"jump\"\ndepth = 1\nbed_evolves = false\n"),
              "expected true: what trees hold back raises the ground"));
}

TEST_CASE("A forest goes together with loose ground and with deposition", "[forest][scene]") {
    const Scene scene = scene_of(slope_gis(),
                                 "detrainment = 50\n[erodible]\nlaw = \"jump\"\ndepth = 1\n[deposition]\nlaw = "
                                 "\"rest\"\n[material.bed]\nlaw = \"voellmy\"\nmu = 0.3\nxi = 1000\n[[material.zone]]\n"
                                 "below = 150\nmu = 0.33\nxi = 400\n");
    CHECK((scene.forest && scene.erodible && scene.deposition && scene.friction));
}

TEST_CASE("A limit of speed below which trees take nothing anyway is refused", "[forest][scene]") {
    CHECK(has(problem_of(slope_gis(), "detrainment = 50\nmax_speed = 0.1\n"),
              "forest.max_speed: found 0.1 m/s; expected more than 0.1 m/s, since slower flow loses nothing to trees; "
              "give a higher speed, or remove it"));
    CHECK(scene_of(slope_gis(), "detrainment = 50\nmax_speed = 0.2\n").forest);
}
