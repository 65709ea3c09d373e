// [deposition] of a case, and what is wrong with it.
#include "compare/deposit.h"
#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

Scene scene_of(const std::string& more, const std::string& bed = "[material.bed]\nlaw = \"coulomb\"\nmu = 0.4\n") {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                       "depth = 2\n[time]\nend = 20\n[material]\ndensity = 1900\n" +
                                           bed + "[deposition]\n" + more,
                                       "slide/case.toml"),
                       slope_gis());
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string problem_of(const std::string& more) {
    return only_problem([&] { scene_of(more); });
}

}  // namespace

TEST_CASE("Deposition is chosen by its law and has a time", "[deposition][scene]") {
    CHECK_FALSE(scene_of("").deposition);
    CHECK_FALSE(scene_of("law = \"none\"\n").deposition);
    CHECK(scene_of("law = \"rest\"\n").deposition.value().rest == 10.0);
    CHECK(scene_of("law = \"rest\"\ntime = 0\n").deposition.value().rest == 0.0);
    CHECK(scene_of("law = \"rest\"\n").bed_evolves());
}

TEST_CASE("Over a bed that holds nothing at rest nothing becomes bed", "[deposition][scene]") {
    const Scene scene = scene_of("law = \"rest\"\n", "[material.bed]\nlaw = \"none\"\n");
    REQUIRE(scene.deposition);
    CHECK_FALSE(scene.deposition->rest);
    std::string all;
    for (const std::string& remark : scene.log) all += remark + "\n";
    CHECK(has(all, "deposition.law: the bed law holds nothing at rest, so nothing becomes bed"));
    const std::string yields = "[material.bed]\nlaw = \"bingham\"\nyield_stress = 100\nviscosity = 10\n";
    CHECK(scene_of("law = \"rest\"\n", yields).deposition->rest);
}

TEST_CASE("What is wrong with [deposition] is said in one sentence", "[deposition][scene]") {
    CHECK(has(problem_of("time = 5\n"), "found, but deposition.law = \"none\" does not use it"));
    CHECK(has(problem_of("law = \"rest\"\ntime = -1\n"), "-1"));
    CHECK(has(problem_of("law = \"settle\"\n"), "settle"));
    CHECK(has(problem_of("law = \"rest\"\n[erodible]\nlaw = \"jump\"\ndepth = 1\nbed_evolves = false\n"),
              "expected true: what is left behind raises the ground"));
    CHECK(has(problem_of("law = \"rest\"\n[scheme]\nshape = \"cubic\"\n"), "the shapes that share out a bed"));
}

TEST_CASE("What lies at the end is flow and what has become bed", "[deposition][compare]") {
    const GridGeometry g{3, 1, 0.0, 0.0, 1.0};
    Raster depth = Raster::filled(g, 0.5), bed = Raster::filled(g, 0.0);
    bed.values = {1.0, NAN, 0.0}, depth.values[2] = NAN;
    CHECK(with_deposit(depth, nullptr).values[0] == 0.5);
    const Raster lying = with_deposit(depth, &bed);
    CHECK((lying.values[0] == 1.5 && lying.values[1] == 0.5 && std::isnan(lying.values[2])));
    Raster peak = Raster::filled(g, 0.75);
    const Raster cover = deepest_cover(peak, lying);
    CHECK((cover.values[0] == 1.5 && cover.values[1] == 0.75 && cover.values[2] == 0.75));
    peak.values[0] = NAN;
    CHECK(deepest_cover(peak, lying).values[0] == 1.5);
}
