// [erodible] of a case: its depth, its outline, its law, and what is wrong with them.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "law/erosion/mechanical.h"
#include "observe/budget.h"
#include "scene/build_scene.h"
#include "shallow/depth_averaged.h"
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

TEST_CASE("Loose ground in the window of a 3D stage and around it is firm, and a remark says so", "[erosion][scene]") {
    const Scene scene = scene_of(slope_gis(),  // nodes at 1002.5, 1007.5, ...
                                 "law = \"growth\"\ngrowth = 1e-3\ndepth = 0.5\n"
                                 "[[stage]]\nmodel = \"depth_averaged\"\nuntil = 5\n"
                                 "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1100, 2000, 1150, 2150]\ncell = 2.5\n");
    const Raster& loose = scene.erodible->depth;
    // Nodes 20 to 29 are in the window. 2 and 3/2 cells, and 3 of 2.5 m, are 5 nodes more on each side.
    CHECK((loose.at(14, 10) == 0.5 && loose.at(15, 10) == 0.0 && loose.at(34, 10) == 0.0 && loose.at(35, 10) == 0.5));
    CHECK(std::any_of(scene.log.begin(), scene.log.end(), [](const std::string& said) {
        return has(said, "erodible: 7500 m3 of loose material in the window of the 3D stage, and around it");
    }));
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

TEST_CASE("What ploughs needs the place of its layer", "[erosion][scene]") {
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

TEST_CASE("Loose ground that seems to be a mistake, or lies outside, is a remark", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["half.geojson"] = rectangle(990, 2010, 1010, 2030);
    const Scene scene = scene_of(gis, "law = \"jump\"\ndepth = 60\noutline = \"half.geojson\"\n");
    std::string all;
    for (const std::string& remark : scene.log) all += remark + "\n";
    CHECK(has(all, "50 % of its area lie outside of the terrain"));  // which ends with its outer pixels
    CHECK(has(all, "up to 60 m deep; is that a depth, and in metres?"));
    CHECK(has(all, "up to 12000 m3 of loose material can be taken up"));
}

TEST_CASE("An outline round all pixels of the terrain leaves none of it", "[erosion][scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["all.geojson"] = rectangle(1000, 2000, 1200, 2150);  // pixels; outer nodes lie 2.5 m farther in
    for (const std::string& remark : scene_of(gis, "law = \"jump\"\ndepth = 1\noutline = \"all.geojson\"\n").log)
        CHECK_FALSE(has(remark, "outside of the terrain"));
}

TEST_CASE("A release that is cut out of the ground uncovers loose material, which it takes down to the rock",
          "[erosion][scene]") {
    const auto scene_with = [](const std::string& erodible) {
        return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\n"
                                           "depth = 2\nincluded_in_dem = true\n[time]\nend = 20\n[material]\n"
                                           "density = 1900\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.2\n" +
                                               erodible,
                                           "slide/case.toml"),
                           slope_gis());
    };
    const Scene scene = scene_with("[erodible]\nlaw = \"growth\"\ngrowth = 0.05\ndepth = 0.3\ndensity = 1500\n");
    DepthAveraged simulation(scene), rock(scene_with(""));
    const Status first = simulation.frame().status;
    while (simulation.status().time < 4.0) simulation.advance(4.0);
    const Frame frame = simulation.frame();
    const Budget left_over = budget(first, frame.status);
    CHECK(std::abs(left_over.mass_error) <= 1e-13);
    CHECK(std::abs(left_over.bed_error) <= 1e-13);
    const double *eroded = frame.node("eroded_depth")->data, *z = frame.node("elevation")->data;
    double most = 0.0, in_scar = 0.0, off = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const Index n = j * frame.grid.nx + i;
            most = std::max(most, eroded[n]);
            if (frame.grid.x(i) > 1055 && frame.grid.x(i) < 1095 && frame.grid.y(j) > 2055 && frame.grid.y(j) < 2075)
                in_scar = std::max(in_scar, eroded[n]);
            off = std::max(off, std::abs(z[n] + eroded[n] - rock.flow().bed.z[rock.flow().grid.at(i, j)]));
        }
    CHECK(in_scar > 0.1);
    CHECK(most <= 0.3);
    CHECK(off <= 1e-12);  // the bed of the start is that without the release
    CHECK(rock.flow().bed.z[rock.flow().grid.at(15, 12)] < slope_gis().rasters["dem.tif"].at(15, 12) - 1.9);
}

TEST_CASE("Laws by which short waves on the bed grow name the viscosity that stops them", "[erosion][scene][remarks]") {
    const auto told = [](const std::string& erodible) {
        Index found = 0;
        for (const std::string& remark : scene_of(slope_gis(), "depth = 1\n" + erodible).log)
            if (has(remark, "without a viscosity")) {
                ++found;
                CHECK(has(remark, "erodible.law: found \""));
                CHECK(has(remark, "0.03 times density, depth and speed (179 Pa s for a depth of 1 m)"));  // 1900 kg/m3
            }
        return found;
    };
    CHECK(told("law = \"jump\"\n") == 1);
    CHECK(told("law = \"energy\"\nenergy = 5000\n") == 1);
    CHECK(told("law = \"jump\"\nbed_evolves = false\n") == 0);
    CHECK(told("law = \"growth\"\ngrowth = 1e-3\n") == 0);
    CHECK(told("law = \"jump\"\n[material.rheology]\nlaw = \"newtonian\"\nviscosity = 200\n") == 0);
}

TEST_CASE("Loose material in a scar only is a remark", "[erosion][scene][remarks]") {
    FakeGis gis = slope_gis();
    gis.polygons["scar.geojson"] = rectangle(1055, 2055, 1095, 2075);
    gis.polygons["gully.geojson"] = rectangle(1030, 2055, 1095, 2075);
    const auto told = [&](const std::string& outline, const std::string& of_release) {
        const Scene scene = build_scene(
            CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n" +
                                of_release + "[time]\nend = 20\n[erodible]\nlaw = \"shear\"\ndepth = 1\noutline = \"" +
                                outline + "\"\n",
                            "slide/case.toml"),
            gis);
        return std::count_if(scene.log.begin(), scene.log.end(), [](const std::string& remark) {
            return has(remark, "erodible.depth: found loose material under releases with included_in_dem only");
        });
    };
    CHECK(told("scar.geojson", "included_in_dem = true\n") == 1);
    CHECK(told("gully.geojson", "included_in_dem = true\n") == 0);
    CHECK(told("scar.geojson", "") == 0);
}

TEST_CASE("The key of the mechanical law says how fast its bed sinks, and what values are in use",
          "[erosion][describe]") {
    const std::string meaning = find_parameter("erodible.shear_velocity")->meaning;
    CHECK(has(meaning, "with 1 the bed sinks at metres a second under a metre of flow"));
    CHECK(has(meaning, "0.03 to 0.1"));
    // What it says: a metre of flow on a slope of 20 degrees with mu = 0.3, on a bed of the same density that holds less.
    erosion::State state{};
    state.density = state.bed_density = 1900.0, state.thickness = 1.0;
    state.normal_gravity = 9.81 * std::cos(20.0 * constants::kDegree);
    state.stress = 0.3 * state.density * state.normal_gravity;
    const double rate = erosion::Mechanical{0.1, 1.0}.rate(state);
    CHECK(rate > 1.0);
    CHECK(rate < 10.0);
}
