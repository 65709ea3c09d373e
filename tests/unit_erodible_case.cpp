// [erodible] of a case: its depth, its outline, its law, and what is wrong with them.
#include <cmath>

#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

Scene scene_of(const FakeGis& gis, const std::string& erodible) {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                       "depth = 2\n[time]\nend = 20\n[material]\ndensity = 1900\n[erodible]\n" +
                                           erodible,
                                       "slide/case.toml"),
                       gis);
}

std::string problem_of(const FakeGis& gis, const std::string& erodible) {
    return only_problem([&] { scene_of(gis, erodible); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("A case without [erodible] has a bed of rock", "[erosion][scene]") {
    CHECK_FALSE(scene_of(slope_gis(), "").erodible);
}

TEST_CASE("Loose ground has a depth, a law with its numbers, and the flow's density unless it is given",
          "[erosion][scene]") {
    const Scene scene = scene_of(slope_gis(), "depth = 0.5\nlaw = \"shear\"\nrate = 0.05\nmomentum = 0.25\n");
    const ErodibleBed& bed = scene.erodible.value();
    CHECK(bed.depth.geometry == scene.bed.geometry);
    CHECK((bed.depth.at(0, 0) == 0.5 && bed.depth.at(39, 29) == 0.5));
    CHECK((bed.density == 1900.0 && bed.momentum == 0.25 && bed.min_depth == 0.05 && bed.evolves));
    const erosion::Shear& law = std::get<erosion::Shear>(bed.law);
    CHECK((law.erosion_rate == 0.05 && law.threshold == 1000.0 && law.depth_per_stress == 1e-4));
    const Scene other =
        scene_of(slope_gis(), "depth = 0.5\nlaw = \"growth\"\ngrowth = 2e-3\ndensity = 1500\nbed_evolves = false\n");
    CHECK((other.erodible->density == 1500.0 && !other.erodible->evolves));
    CHECK(std::get<erosion::Growth>(other.erodible->law).growth == 2e-3);
}

TEST_CASE("An outline and a raster say where ground is loose", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["gully.geojson"] = rectangle(1040, 2020, 1060, 2037.5);  // pixels are 1040 to 1045, ..., 2035 to 2040
    gis.rasters["loose.tif"] =
        sampled(gis.rasters["dem.tif"].geometry, [](double x, double) { return x < 1050 ? 0.4 : 0.0; });
    gis.rasters["loose.tif"].at(9, 6) = NAN;
    const std::string law = "law = \"jump\"\noutline = \"gully.geojson\"\n";
    const Raster even = scene_of(gis, law + "depth = 1.0\n").erodible->depth;
    CHECK(even.at(7, 5) == 0.0);
    CHECK(even.at(8, 5) == Approx(1.0));
    CHECK(even.at(8, 7) == Approx(0.5));  // half of the pixel
    const Raster from_file = scene_of(gis, law + "depth = \"loose.tif\"\n").erodible->depth;
    CHECK(from_file.at(8, 5) == Approx(0.4));
    CHECK((from_file.at(9, 6) == 0.0 && from_file.at(11, 5) == 0.0));
}

TEST_CASE("What is wrong with [erodible] is said in one sentence", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    CHECK(has(problem_of(gis, "depth = 0.5\n"), "found, but erodible.law = \"none\" does not use it"));
    CHECK(has(problem_of(gis, "law = \"jump\"\n"), "not given, but erodible.law = \"jump\" needs it"));
    CHECK(has(problem_of(gis, "law = \"growth\"\ndepth = 1\n"), "not given, but erodible.law = \"growth\" needs it"));
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = 1\nrate = 0.1\n"),
              "found, but erodible.law = \"jump\" does not use it"));
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = 1\nmomentum = 1.5\n"), "1.5"));
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = 1\ndensity = 0\n"), "expected a number above 0"));
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = 1\nthreshold = -1\n"), "-1"));
    CHECK(has(problem_of(gis, "law = \"plough\"\ndepth = 1\n"), "plough"));
    gis.rasters["loose.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 1.0; });
    gis.rasters["loose.tif"].at(7, 5) = -0.5;
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = \"loose.tif\"\n"),
              "loose.tif: found 1 pixels below 0, such as -0.5 at x 1037.5, y 2027.5; expected depths of 0 or more"));
    gis.polygons["far.geojson"] = rectangle(5000, 5000, 5100, 5100);
    CHECK(has(problem_of(gis, "law = \"jump\"\ndepth = 1\noutline = \"far.geojson\"\n"),
              "without any of the terrain; expected some of its x "));
}

TEST_CASE("What ploughs has to know where its layer lies", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["gully.geojson"] = rectangle(1040, 2020, 1060, 2037.5);
    gis.rasters["loose.tif"] = sampled(gis.rasters["dem.tif"].geometry, [](double, double) { return 1.0; });
    CHECK(
        has(problem_of(gis, "law = \"front\"\ndepth = 0.5\n"),
            "erodible.law: found \"front\" with loose material on all of the terrain; expected to know where the layer "
            "lies that the flow ploughs; give erodible.outline, or a raster as erodible.depth"));
    for (const char* known : {"depth = 0.5\noutline = \"gully.geojson\"\n", "depth = \"loose.tif\"\n"})
        CHECK(std::holds_alternative<erosion::Front>(
            scene_of(gis, std::string("law = \"front\"\n") + known).erodible->law));
}

TEST_CASE("Loose ground that looks like a mistake, or lies outside, is a remark", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["half.geojson"] = rectangle(990, 2010, 1010, 2030);
    const Scene scene = scene_of(gis, "law = \"jump\"\ndepth = 60\noutline = \"half.geojson\"\n");
    std::string all;
    for (const std::string& remark : scene.log) all += remark + "\n";
    CHECK(has(all, "62.5 % of its area lie outside of the terrain"));  // which ends at its outer nodes
    CHECK(has(all, "up to 60 m deep; is that a depth, and in metres?"));
    CHECK(has(all, "up to 12000 m3 of loose material can be taken up"));
}
