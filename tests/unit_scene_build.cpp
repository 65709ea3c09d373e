// From case file to Scene, with files that exist in memory only.
#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <numeric>

#include "base/error.h"
#include "catch.h"
#include "checks/verify/trial.h"
#include "fake_gis.h"
#include "fresh_folder.h"
#include "run/simulation.h"
#include "scene/build_scene.h"
#include "scene/scene_parts.h"
#include "slope_case.h"

using namespace frana;

namespace {

/// 40 x 30 nodes, 5 m apart, on a plane that rises 1 in 2 to the east.
const GridGeometry grid{40, 30, 1002.5, 2002.5, 5.0};
double plane(double x, double) { return 100.0 + 0.5 * (x - 1000.0); }

FakeGis slope_gis() {
    FakeGis gis;
    gis.rasters["dem.tif"] = sampled(grid, plane);
    gis.rasters["dem.tif"].source = "dem.tif";
    gis.polygons["release.geojson"] = rectangle(1050, 2050, 1100, 2080);
    return gis;
}

/// Case text around the keys of one release.
std::string with_release(const std::string& release, const std::string& rest = "") {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\n" + release + "\n[time]\nend = 20\n" + rest;
}

BuiltScene built(const std::string& text, const FakeGis& gis) {
    return build_scene_in_detail(CaseFile::parse(text, "slide/case.toml"), gis);
}

std::vector<std::string> problems_of(const std::string& text, const FakeGis& gis) {
    try {
        built(text, gis);
    } catch (const UserError& error) {
        return error.problems();
    }
    return {};
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Sums of about a thousand terms carry a rounding of some 1e-13 relative.
const double round_off = 1e-12;

}  // namespace

TEST_CASE("A polygon of constant depth becomes particles of that volume", "[scene]") {
    const BuiltScene result =
        built(with_release("outline = \"release.geojson\"\ndepth = 2.0\nvelocity = [1, -3]"), slope_gis());
    const Scene& scene = result.scene;
    CHECK(scene.name == "slide");
    CHECK(scene.bed.geometry == grid);
    CHECK(sum(scene.particles.volume) == Approx(50 * 30 * 2.0).epsilon(round_off));
    CHECK(scene.particles.count() == 50 * 30 / 25 * 4);
    CHECK(scene.particles.vx[7] == 1.0);
    CHECK(scene.particles.vy[7] == -3.0);
    REQUIRE(result.releases.size() == 1);
    CHECK(result.releases[0].name == "release.0 (release.geojson)");
    CHECK(result.releases[0].max_depth == Approx(2.0).epsilon(round_off));
    // atan(1/2); central differences are exact on a plane
    CHECK(result.releases[0].slope_min_deg == Approx(26.56505117707799).epsilon(1e-9));
    CHECK(result.releases[0].slope_max_deg == Approx(26.56505117707799).epsilon(1e-9));
}

TEST_CASE("A thickness normal to the slope is longer along gravity", "[scene]") {
    const BuiltScene result =
        built(with_release("outline = \"release.geojson\"\ndepth = 2.0\nthickness = \"normal\""), slope_gis());
    CHECK(result.releases[0].report.volume == Approx(50 * 30 * 2.0 * std::sqrt(1.25)).epsilon(round_off));
    CHECK(sum(result.scene.particles.volume) == Approx(50 * 30 * 2.0 * std::sqrt(1.25)).epsilon(round_off));
}

TEST_CASE("A depth raster keeps its own pixels, within an outline or without", "[scene]") {
    FakeGis gis = slope_gis();
    const GridGeometry pixels{6, 4, 1045, 2045, 10};  // covers x 1040..1100, y 2040..2080
    gis.rasters["depth.tif"] = sampled(pixels, [](double x, double) { return x > 1075 ? 3.0 : Raster::nodata; });
    CHECK(sum(built(with_release("depth = \"depth.tif\""), gis).scene.particles.volume) ==
          Approx(2 * 40 * 10 * 3.0).epsilon(round_off));  // two columns of pixels begin at x = 1080
    CHECK(
        sum(built(with_release("depth = \"depth.tif\"\noutline = \"release.geojson\""), gis).scene.particles.volume) ==
        Approx(20 * 30 * 3.0).epsilon(round_off));
}

TEST_CASE("A mask says where, in its own pixels, and a number or raster says how deep", "[scene]") {
    FakeGis gis = slope_gis();
    const GridGeometry pixels{3, 2, 1055, 2055, 10};
    gis.rasters["mask.tif"] = sampled(pixels, [](double x, double) { return x < 1070 ? 1.0 : 0.0; });
    gis.rasters["depth.tif"] = sampled(grid, [](double x, double) { return x > 1060 ? 4.0 : 2.0; });
    CHECK(sum(built(with_release("mask = \"mask.tif\"\ndepth = 1.5"), gis).scene.particles.volume) ==
          Approx(20 * 20 * 1.5).epsilon(round_off));
    CHECK(sum(built(with_release("mask = \"mask.tif\"\ndepth = \"depth.tif\""), gis).scene.particles.volume) ==
          Approx(10 * 20 * (2.0 + 4.0)).epsilon(round_off));
}

TEST_CASE("A raster of depths below 0 is a remark where it was resampled, and refused where it is a difference",
          "[scene]") {
    FakeGis gis = slope_gis();
    const auto with_depths = [&](double below) {
        gis.rasters["depth.tif"] = sampled(grid, [=](double x, double) {
            return x > 1060 ? 2.0 : x > 1055 ? below : 0.0;
        });
    };
    with_depths(-0.05);
    const BuiltScene resampled = built(with_release("depth = \"depth.tif\""), gis);
    const auto& log = resampled.scene.log;
    CHECK(std::any_of(log.begin(), log.end(), [](const std::string& remark) {
        return remark.find("pixels below 0 with ") != std::string::npos &&
               remark.find("they are taken as 0") != std::string::npos;
    }));
    with_depths(0.0);
    CHECK(sum(resampled.scene.particles.volume) ==
          Approx(sum(built(with_release("depth = \"depth.tif\""), gis).scene.particles.volume)).epsilon(round_off));
    gis.rasters["depth.tif"] = sampled(grid, [](double x, double) { return x > 1100 ? -3.0 : x < 1060 ? 2.0 : 0.0; });
    CHECK(test::only_problem([&] {
              built(with_release("depth = \"depth.tif\""), gis);
          }).find("expected depths of what is released, 0 or more; of a later surface minus an earlier one") !=
          std::string::npos);
    // Within an outline the rest of a difference does not matter.
    gis.rasters["depth.tif"] = sampled(grid, [](double x, double) { return x < 1045 ? -3.0 : 2.0; });
    CHECK(sum(built(with_release("depth = \"depth.tif\"\noutline = \"release.geojson\""), gis).scene.particles.volume) >
          0.0);
}

TEST_CASE("Particles that a raster of velocities does not tell are a remark", "[scene][remarks]") {
    FakeGis gis = slope_gis();
    gis.rasters["whole.tif"] = sampled(grid, [](double, double) { return 3.0; });
    gis.rasters["half.tif"] = sampled(grid, [](double x, double) { return x > 1060 ? 3.0 : Raster::nodata; });
    const auto said = [&](const std::string& east, const std::string& north) {
        std::string all;
        for (const std::string& line : built(with_release("outline = \"release.geojson\"\ndepth = 2.0\nvelocity = [\"" +
                                                          east + "\", \"" + north + "\"]"),
                                             gis)
                                           .scene.log)
            all += line + "\n";
        return all;
    };
    CHECK(said("whole.tif", "whole.tif").find("velocity") == std::string::npos);
    for (const auto& [east, north] : {std::pair{"half.tif", "whole.tif"}, {"whole.tif", "half.tif"}}) {
        const std::string text = said(east, north);
        CAPTURE(text);
        CHECK(text.find("particles, taken as a velocity of 0; expected one for each; fill the gaps of ") !=
              std::string::npos);
    }
}

TEST_CASE("A lake fills the whole window up to its surface", "[scene]") {
    FakeGis gis;
    gis.rasters["dem.tif"] = sampled({20, 20, 0.5, 0.5, 1.0}, [](double x, double) { return x < 10 ? 8.0 : 12.0; });
    const Scene scene = built(with_release("surface = 10.0"), gis).scene;
    // Material lives between the outer nodes; the pixels of the left half hold 2 m.
    CHECK(sum(scene.particles.volume) == Approx(9.5 * 19 * 2.0).epsilon(round_off));
    for (const double depth : scene.particles.depth) CHECK(depth == Approx(2.0).epsilon(round_off));
}

TEST_CASE("A surface raster over an outline gives depth = surface - bed", "[scene]") {
    FakeGis gis = slope_gis();
    gis.rasters["before.tif"] = sampled(grid, [](double x, double y) { return plane(x, y) + 6.0; });
    const Scene scene = built(with_release("outline = \"release.geojson\"\nsurface = \"before.tif\""), gis).scene;
    CHECK(sum(scene.particles.volume) == Approx(50 * 30 * 6.0).epsilon(1e-12));
}

TEST_CASE("A mass that stands in the DEM is cut out of the bed with its whole volume", "[scene]") {
    const std::string keys = "outline = \"release.geojson\"\ndepth = 2.0\nincluded_in_dem = ";
    const Scene cut = built(with_release(keys + "true"), slope_gis()).scene;
    const Scene whole = built(with_release(keys + "false"), slope_gis()).scene;
    CHECK(cut.particles.x == whole.particles.x);
    CHECK(cut.particles.volume == whole.particles.volume);
    double removed = 0.0;
    for (std::size_t k = 0; k < cut.bed.values.size(); ++k) removed += whole.bed.values[k] - cut.bed.values[k];
    // Elevations of some 150 m lose 1e-14 each; 60 pixels of 2 m are removed.
    CHECK(removed * 25.0 == Approx(50 * 30 * 2.0).epsilon(1e-11));
    CHECK(whole.bed.at(12, 12) - cut.bed.at(12, 12) == Approx(2.0).epsilon(1e-12));
    CHECK(whole.bed.at(2, 2) == cut.bed.at(2, 2));
    REQUIRE(cut.log.size() == whole.log.size() + 1);
    CHECK(cut.log.back() == "release.0: its 3000 m3 are cut out of the bed (included_in_dem)");
}

TEST_CASE("Nodata near the material is an error that names the pixel; elsewhere it is an exit", "[scene]") {
    FakeGis gis = slope_gis();
    const std::string text = with_release("outline = \"release.geojson\"\ndepth = 2.0");
    gis.rasters["dem.tif"].at(0, 1) = Raster::nodata;
    const Scene scene = built(text, gis).scene;
    CHECK(std::isnan(scene.bed.at(0, 1)));
    CHECK(scene.log.front().find("material.bed.law is not given") == 0);
    CHECK(scene.log[2] ==
          "1 of 1200 nodes lie outside of the terrain, without elevation: an exit, mass that enters is "
          "counted as left");

    gis.rasters["dem.tif"].at(12, 18) = Raster::nodata;  // 2 cells north of the edge at y = 2080 (node row 15)
    CHECK(problems_of(text, gis) ==
          std::vector<std::string>{
              "slide/case.toml:3: release.0: found nodata under or within 3 cells of the material at 1 "
              "pixel, the first at "
              "row 11, column 12 (from the north-west, counted from 0; map 1062.5, 2092.5); expected "
              "elevations there; fill "
              "the gaps (gdal_fillnodata.py dem.tif filled.tif), or move the release away from them"});
    gis.rasters["dem.tif"].at(12, 18) = 0.0;
    gis.rasters["dem.tif"].at(12, 20) = Raster::nodata;
    CHECK(problems_of(text, gis).empty());
}

TEST_CASE("A surface over nodata inside its outline is refused, not skipped", "[scene]") {
    FakeGis gis = slope_gis();
    gis.rasters["dem.tif"].at(15, 12) = Raster::nodata;
    const auto problems = problems_of(with_release("outline = \"release.geojson\"\nsurface = 500"), gis);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].find("at 1 pixel, the first at row 17, column 15") != std::string::npos);
}

TEST_CASE("Releases off the terrain or without volume are refused", "[scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["outside.geojson"] = rectangle(1150, 2050, 1250, 2080);
    gis.polygons["outside.geojson"].source = "outside.geojson";
    CHECK(problems_of(with_release("outline = \"outside.geojson\"\ndepth = 1"), gis) ==
          std::vector<std::string>{"slide/case.toml:4: release.0.outline: found 2 of 4 vertices outside the "
                                   "terrain, such as 1250, 2050; expected "
                                   "all within x 1000 to 1200, y 2000 to 2150; correct the outline or its "
                                   "CRS, or widen terrain.window"});
    CHECK(problems_of(with_release("surface = 50"), gis) ==
          std::vector<std::string>{"slide/case.toml:3: release.0: found no material in its depth; expected a "
                                   "volume above 0; check depth or "
                                   "surface, and the CRS and place of the files"});
}

TEST_CASE("A line that crosses the terrain from beyond to beyond is on it; one that passes a corner is not",
          "[scene]") {
    const auto with_profile = [](const std::string& line) {
        return with_release("depth = 1", "[[profile]]\nname = \"p\"\nline = " + line + "\n");
    };
    for (const char* line : {"[[-1000, 2075], [2000, 2075]]", "[[1100, 0], [1100, 9000]]",
                             "[[900, 1950], [1300, 2250]]", "[[0, 0], [900, 2000], [1300, 2100]]"}) {
        CAPTURE(line);
        CHECK(problems_of(with_profile(line), slope_gis()).empty());
    }
    for (const char* line :
         {"[[900, 2100], [1050, 2300]]", "[[1100, 0], [1100, 1900]]", "[[900, 1900], [900, 2300]]"}) {
        CAPTURE(line);
        REQUIRE(problems_of(with_profile(line), slope_gis()).size() == 1);
    }
}

TEST_CASE("Problems of several files and places are listed together", "[scene]") {
    const std::string rest =
        "[[release]]\noutline = \"none.geojson\"\ndepth = 1\n[[gauge]]\nname = \"g\"\npoint = [0, 0]\n"
        "[[profile]]\nname = \"p\"\nline = [[0, 0], [1, 1]]\n[survey]\nfootprint = \"gone.geojson\"\n";
    const auto problems = problems_of(with_release("surface = 50", rest), slope_gis());
    CAPTURE(problems);
    REQUIRE(problems.size() == 5);
    CHECK(problems[0].find("slide/case.toml:3: release.0: found no material") == 0);
    CHECK(problems[1].find("slide/case.toml:8: release.1.outline: slide/none.geojson: no such polygons") == 0);
    CHECK(problems[2].find("slide/case.toml:17: survey.footprint: slide/gone.geojson: no such polygons") == 0);
    CHECK(problems[3].find("slide/case.toml:15: profile.0.line: found no point of it on the terrain") == 0);
    CHECK(problems[4] ==
          "slide/case.toml:12: gauge.0.point: found 0, 0 off the terrain; expected it within x 1000 to 1200, "
          "y 2000 to "
          "2150; correct the coordinates, or widen terrain.window");
    CHECK(problems_of("[terrain]\ndem = \"x.tif\"\n[[release]]\ndepth = 1\n[time]\nend = 1\n", slope_gis()) ==
          std::vector<std::string>{"slide/case.toml:2: terrain.dem: slide/x.tif: no such raster"});
}

TEST_CASE("Laws, scheme, time and output arrive in the scene", "[scene]") {
    const std::string text = R"([case]
title = "All of it"
[terrain]
dem = "dem.tif"
gravity = 9.8
curvature = "inertia"
[[release]]
outline = "release.geojson"
depth = 2
[particles]
count = 100
placement = "r2"
[material]
density = 1291
[material.bed]
law = "voellmy"
friction_angle_deg = 45
xi = 200
[material.rheology]
law = "bingham"
viscosity = 2000
yield_stress = 50
[scheme]
transfer = "flip"
flip_ratio = 0.9
split_length = 0.7
[boundary]
sides = "wall"
[time]
end = 20
stop_at_rest = true
[output]
every = 0.5
formats = ["xdmf"]
fields = ["depth"]
history = "output"
[[gauge]]
name = "bridge"
point = [1100, 2050]
)";
    const Scene scene = built(text, slope_gis()).scene;
    CHECK(scene.title == "All of it");
    CHECK(scene.gravity == 9.8);
    CHECK(scene.curvature == Curvature::inertia);
    CHECK(scene.terrain == TerrainModel::steep);
    CHECK(scene.particles.count() == 100);
    CHECK(scene.density == 1291.0);
    REQUIRE(std::holds_alternative<bed::Voellmy>(scene.bed_law));
    CHECK(std::get<bed::Voellmy>(scene.bed_law).mu == Approx(1.0).epsilon(1e-14));
    CHECK(std::get<bed::Voellmy>(scene.bed_law).xi == 200.0);
    REQUIRE(std::holds_alternative<rheology::Bingham>(scene.rheology));
    CHECK(std::get<rheology::Bingham>(scene.rheology).yield_stress == 50.0);
    CHECK(scene.scheme.transfer == Transfer::flip);
    CHECK(scene.scheme.flip_ratio == 0.9);
    CHECK(scene.scheme.split_length == 0.7);
    CHECK_FALSE(scene.scheme.paper_pressure);
    CHECK(scene.sides == Sides::wall);
    CHECK(scene.end == 20.0);
    CHECK(scene.stop_at_rest);
    CHECK(scene.output.every == 0.5);
    CHECK(scene.output.xdmf);
    CHECK_FALSE(scene.output.vtk);
    CHECK(scene.output.fields == std::vector<std::string>{"depth"});
    CHECK_FALSE(scene.output.history_per_step);
    REQUIRE(scene.gauges.size() == 1);
    CHECK(scene.gauges[0].point == Vec2(1100, 2050));
}

TEST_CASE("A gauge where the terrain has no elevation is refused", "[scene]") {
    FakeGis files = slope_gis();
    files.rasters["dem.tif"].at(3, 3) = Raster::nodata;
    const GridGeometry g = files.rasters["dem.tif"].geometry;
    const auto gauge = [&](double x, double y) {
        return with_release("outline = \"release.geojson\"\ndepth = 2") +
               fmt::format("[[gauge]]\nname = \"pit\"\npoint = [{}, {}]\n", x, y);
    };
    const auto problems = problems_of(gauge(g.x(3), g.y(3)), files);
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems.front(), Catch::Contains("gauge.0.point: found ") &&
                                     Catch::Contains("where the terrain has no elevation; expected ground there"));
    CHECK(built(gauge(g.x(5), g.y(3)), files).scene.gauges.size() == 1);
}

TEST_CASE("The defaults of the table are the defaults of the scene", "[scene]") {
    const Scene scene = built(with_release("outline = \"release.geojson\"\ndepth = 2"), slope_gis()).scene;
    const Scheme plain;
    CHECK(scene.scheme.shape == plain.shape);
    CHECK(scene.scheme.transfer == plain.transfer);
    CHECK(scene.scheme.flip_ratio == plain.flip_ratio);
    CHECK(scene.scheme.cfl == plain.cfl);
    CHECK(scene.scheme.filter == plain.filter);
    CHECK(scene.scheme.margin_limit == plain.margin_limit);
    CHECK(scene.scheme.viscosity_linear == plain.viscosity_linear);
    CHECK(scene.scheme.viscosity_quadratic == plain.viscosity_quadratic);
    CHECK(scene.scheme.split == plain.split);
    CHECK(scene.scheme.split_length == plain.split_length);
    CHECK(scene.scheme.split_min_mass == plain.split_min_mass);
    CHECK(scene.scheme.mass_fit == plain.mass_fit);
    CHECK(scene.scheme.curvature_length == plain.curvature_length);
    CHECK(scene.scheme.strain_rate_floor == plain.strain_rate_floor);
    CHECK(scene.scheme.stress_cap == plain.stress_cap);
    CHECK(scene.scheme.paper_pressure == plain.paper_pressure);
    const Output output;
    CHECK(scene.output.every == output.every);
    CHECK(scene.output.vtk == output.vtk);
    CHECK(scene.output.xdmf == output.xdmf);
    CHECK(scene.output.geotiff == output.geotiff);
    CHECK(scene.output.png == output.png);
    CHECK(scene.output.footprint_depth == output.footprint_depth);
    CHECK(scene.output.history_per_step == output.history_per_step);
    const Scene empty;
    CHECK(scene.gravity == empty.gravity);
    CHECK(scene.density == empty.density);
    CHECK(scene.rest_fraction == empty.rest_fraction);
    CHECK(scene.stop_at_rest == empty.stop_at_rest);
}

TEST_CASE("resolved.toml gives the same scene as the case it came from", "[scene][resolved]") {
    const std::string text =
        with_release("outline = \"release.geojson\"\ndepth = 2\nthickness = \"normal\"",
                     "[material.bed]\nlaw = \"pouliquen\"\nmu_s = 0.38\nmu_2 = 0.65\ngrain_diameter = 7e-4\n"
                     "[scheme]\npreset = \"paper\"\nstill_level = 0.1\n[[profile]]\nname = \"p\"\nline = "
                     "[[1010, 2010], [1100.1, 2100]]\n");
    const CaseFile file = CaseFile::parse(text, "slide/case.toml");
    const Scene a = build_scene(file, slope_gis());
    const Scene b = build_scene(CaseFile::parse(resolved_toml(file), "out/slide/resolved.toml"), slope_gis());
    CHECK(a.name == b.name);
    CHECK(a.bed.values == b.bed.values);
    CHECK(a.particles.x == b.particles.x);
    CHECK(a.particles.volume == b.particles.volume);
    CHECK(a.bed_law.index() == b.bed_law.index());
    CHECK(std::get<bed::Pouliquen>(a.bed_law).grain_diameter == std::get<bed::Pouliquen>(b.bed_law).grain_diameter);
    CHECK(std::get<bed::Pouliquen>(a.bed_law).i0 == std::get<bed::Pouliquen>(b.bed_law).i0);
    CHECK(a.terrain == b.terrain);
    CHECK(a.curvature == b.curvature);
    CHECK(a.scheme.preset == b.scheme.preset);
    CHECK(a.scheme.cfl == b.scheme.cfl);
    CHECK(a.scheme.shape == b.scheme.shape);
    CHECK(a.scheme.transfer == b.scheme.transfer);
    CHECK(a.scheme.split == b.scheme.split);
    CHECK(a.scheme.still_level == b.scheme.still_level);
    CHECK(a.scheme.paper_pressure == b.scheme.paper_pressure);
    CHECK(a.end == b.end);
    CHECK(a.output.vtk == b.output.vtk);
    CHECK(a.output.xdmf == b.output.xdmf);
    CHECK(a.profiles[0].line == b.profiles[0].line);
}

TEST_CASE("The verification's presets are those of the case file", "[scene]") {
    for (const char* preset : {"default", "fast", "paper"}) {
        const std::string text = std::string("[scheme]\npreset = \"") + preset + "\"\n" +
                                 with_release("outline = \"release.geojson\"\ndepth = 1.0");
        const Scene file = built(text, slope_gis()).scene;
        Scene scene;
        verify::set_preset(scene, preset);
        const Scheme &a = file.scheme, &b = scene.scheme;
        CAPTURE(preset);
        CHECK(file.terrain == scene.terrain);
        CHECK(file.curvature == scene.curvature);
        CHECK(std::tuple(a.preset, a.shape, a.transfer, a.paper_pressure) ==
              std::tuple(b.preset, b.shape, b.transfer, b.paper_pressure));
        CHECK(std::tuple(a.split, a.merge, a.reset_domains, a.mass_fit, a.margin) ==
              std::tuple(b.split, b.merge, b.reset_domains, b.mass_fit, b.margin));
        CHECK(std::tuple(a.cfl, a.filter, a.margin_limit, a.sub_point_reach, a.shock_gate, a.shock_sensor) ==
              std::tuple(b.cfl, b.filter, b.margin_limit, b.sub_point_reach, b.shock_gate, b.shock_sensor));
        CHECK(std::tuple(a.viscosity_linear, a.viscosity_quadratic, a.split_length, a.split_min_mass, a.stress_cap) ==
              std::tuple(b.viscosity_linear, b.viscosity_quadratic, b.split_length, b.split_min_mass, b.stress_cap));
    }
}

TEST_CASE("An outline's layer is named apart or with it, and its file is found without it", "[scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["outlines.gpkg|layername=scar"] = gis.polygons["release.geojson"];
    for (const char* keys : {"outline = \"outlines.gpkg\"\nlayer = \"scar\"\ndepth = 2.0",
                             "outline = \"outlines.gpkg|layername=scar\"\ndepth = 2.0"})
        CHECK(sum(built(with_release(keys), gis).scene.particles.volume) == Approx(50 * 30 * 2.0).epsilon(round_off));
    const auto twice = problems_of(with_release("outline = \"a.gpkg|layername=b\"\nlayer = \"c\"\ndepth = 2.0"), gis);
    REQUIRE(twice.size() == 1);
    CHECK(twice[0].find("release.0.layer: found, but outline names a layer as well") != std::string::npos);
    REQUIRE(problems_of(with_release("layer = \"c\"\ndepth = 2.0"), gis).size() == 1);

    const FreshFolder folder;
    std::ofstream(folder.path() / "dem.tif") << "not looked into";
    std::ofstream(folder.path() / "case.toml") << with_release("outline = \"a.gpkg|layername=b\"\ndepth = 2.0");
    CHECK_THROWS_WITH(CaseFile::read(folder.path() / "case.toml"),
                      Catch::Contains("found no file") && Catch::Contains("a.gpkg\""));
    std::ofstream(folder.path() / "a.gpkg") << "not looked into";
    const auto inputs = CaseFile::read(folder.path() / "case.toml").inputs();
    CHECK(std::count(inputs.begin(), inputs.end(), folder.path() / "a.gpkg") == 1);
}

TEST_CASE("Each polygon of an outline has the depth of its attribute", "[scene]") {
    FakeGis gis = slope_gis();
    Polygons& scars = gis.polygons["scars.gpkg"];
    scars = rectangle(1050, 2050, 1070, 2080);
    for (const double x : {1080.0, 1110.0}) scars.parts.push_back(rectangle(x, 2050, x + 20, 2080).parts[0]);
    gis.attributes["thickness_m"] = {3.0, 1.5, 3.0};
    const std::string keys = "outline = \"scars.gpkg\"\ndepth = \"field:thickness_m\"";
    const BuiltScene result = built(with_release(keys), gis);
    REQUIRE(result.releases.size() == 2);
    CHECK(result.releases[0].report.volume == Approx(20 * 30 * 1.5).epsilon(round_off));
    CHECK(result.releases[1].report.volume == Approx(2 * 20 * 30 * 3.0).epsilon(round_off));
    CHECK(result.releases[1].max_depth == Approx(3.0).epsilon(round_off));
    const BuiltScene normal = built(with_release(keys + "\nthickness = \"normal\""), gis);
    CHECK(sum(normal.scene.particles.volume) == Approx(20 * 30 * 7.5 * std::sqrt(1.25)).epsilon(round_off));
    const Scene cut = built(with_release(keys + "\nincluded_in_dem = true"), gis).scene;
    double removed = 0.0;
    for (std::size_t k = 0; k < cut.bed.values.size(); ++k)
        removed += gis.rasters["dem.tif"].values[k] - cut.bed.values[k];
    CHECK(removed * 25.0 == Approx(20 * 30 * 7.5).epsilon(1e-11));

    const auto refusal = [&](const std::string& text) {
        const auto problems = problems_of(with_release(text), gis);
        REQUIRE(problems.size() == 1);
        return problems[0];
    };
    CHECK(refusal("outline = \"scars.gpkg\"\ndepth = \"field:h\"").find("no such attribute") != std::string::npos);
    gis.attributes["thickness_m"][1] = 0.0;
    CHECK(refusal(keys).find("release.0.depth: found a depth of 0 m in ") != std::string::npos);
    CHECK(refusal("depth = \"field:thickness_m\"").find("an attribute without an outline") != std::string::npos);
}

TEST_CASE("Polygons of other depths that overlap add up, which is remarked upon", "[scene]") {
    FakeGis gis = slope_gis();
    Polygons& scars = gis.polygons["scars.gpkg"];
    scars = rectangle(1050, 2050, 1070, 2080);
    scars.parts.push_back(rectangle(1060, 2050, 1080, 2080).parts[0]);
    const auto remarks = [&](std::vector<double> depths) {
        gis.attributes["h"] = std::move(depths);
        std::string said;
        for (const std::string& line :
             built(with_release("outline = \"scars.gpkg\"\ndepth = \"field:h\""), gis).scene.log)
            if (line.find("overlap") != std::string::npos) said += line + "\n";
        return said;
    };
    const std::string said = remarks({3.0, 1.5});
    CAPTURE(said);
    CHECK(said.find("release.0.depth: polygons of rectangle overlap on about 300 m2; their depths add up there, to "
                    "about 450 m3 more than by the deepest of them") != std::string::npos);
    CHECK(remarks({2.0, 2.0}).find("which is counted once") != std::string::npos);
    scars.parts[1] = rectangle(1070, 2050, 1080, 2080).parts[0];
    CHECK(remarks({3.0, 1.5}).empty());
}

TEST_CASE("A thickness normal to the slope needs no elevations far from its outline", "[scene]") {
    FakeGis gis = slope_gis();
    gis.rasters["dem.tif"].at(1, 1) = Raster::nodata;  // 45 m west of the release
    const std::string keys = "outline = \"release.geojson\"\ndepth = 2.0\nthickness = \"normal\"";
    CHECK(sum(built(with_release(keys), gis).scene.particles.volume) ==
          Approx(50 * 30 * 2.0 * std::sqrt(1.25)).epsilon(round_off));
    gis.rasters["dem.tif"].at(12, 12) = Raster::nodata;  // under it
    const auto problems = problems_of(with_release(keys), gis);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0].find("found nodata under or within 3 cells") != std::string::npos);
}

TEST_CASE("A depth raster is interpolated on finer cells: no steps, each pixel's volume as it was", "[scene]") {
    FakeGis gis = slope_gis();
    const GridGeometry pixels{5, 4, 1060, 2050, 20};  // of four cells each: x 1050 to 1150, y 2040 to 2120
    const auto depth = [](double x, double y) { return 1.0 + 0.01 * (x - 1050) + 0.02 * (y - 2040); };
    gis.rasters["depth.tif"] = sampled(pixels, depth);
    const Seeds seeds = built(with_release("depth = \"depth.tif\""), gis).scene.particles;
    // two particles a cell, and between the outer middles of the pixels the depth is linear: so is each patch's mean
    Index inside = 0;
    for (Index p = 0; p < seeds.count(); ++p) {
        if (seeds.x[p] < 1075 || seeds.x[p] > 1125 || seeds.y[p] < 2065 || seeds.y[p] > 2095) continue;
        ++inside;  // the field is constant within a cell, so a particle is at most a quarter of a cell off its middle
        CHECK(std::abs(seeds.depth[p] - depth(seeds.x[p], seeds.y[p])) <= 1.25 * (0.01 + 0.02) + 1e-9);
    }
    CHECK(inside > 100);
    std::vector<double> volume(20, 0.0);
    for (Index p = 0; p < seeds.count(); ++p) {
        const auto i = static_cast<std::size_t>((seeds.x[p] - 1050) / 20);
        const auto j = static_cast<std::size_t>((seeds.y[p] - 2040) / 20);
        volume[i + 5 * j] += seeds.volume[p];
    }
    for (Index k = 0; k < 20; ++k)
        CHECK(volume[static_cast<std::size_t>(k)] ==
              Approx(400.0 * gis.rasters["depth.tif"].values[static_cast<std::size_t>(k)]).epsilon(round_off));
}

TEST_CASE("Depths of particles stay within those of the raster's pixels around them", "[scene]") {
    FakeGis gis = slope_gis();
    const double pixel = GENERATE(2.5, 5.0, 10.0, 20.0);  // cells are 5 m
    const GridGeometry pixels{5, 4, 1050 + 0.5 * pixel, 2040 + 0.5 * pixel, pixel};
    std::uint64_t dice = 7;
    gis.rasters["depth.tif"] = sampled(pixels, [&](double, double) {
        dice = dice * 6364136223846793005u + 1442695040888963407u;
        return 0.2 + 2.0 * static_cast<double>(dice >> 40) / 16777216.0;
    });
    Raster& depth = gis.rasters["depth.tif"];
    depth.at(2, 1) = 9.0;             // a peak
    depth.at(4, 3) = Raster::nodata;  // and an end
    const Scene scene = built(with_release("depth = \"depth.tif\""), gis).scene;
    const Seeds& seeds = scene.particles;
    CAPTURE(pixel);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    const Field peaks = *run->frame().node("peak_depth");
    CHECK(*std::max_element(peaks.data, peaks.data + peaks.count) <= 9.0 * (1.0 + round_off));
    CHECK(*std::max_element(seeds.depth.begin(), seeds.depth.end()) == Approx(9.0).epsilon(round_off));
    std::vector<double> volume(20, 0.0);
    for (Index p = 0; p < seeds.count(); ++p) {
        const auto i = static_cast<Index>((seeds.x[p] - 1050) / pixel),
                   j = static_cast<Index>((seeds.y[p] - 2040) / pixel);
        double low = depth.at(i, j), high = low;
        for (Index b = std::max<Index>(j - 1, 0); b <= std::min<Index>(j + 1, 3); ++b)
            for (Index a = std::max<Index>(i - 1, 0); a <= std::min<Index>(i + 1, 4); ++a)
                if (depth.at(a, b) > 0.0) low = std::min(low, depth.at(a, b)), high = std::max(high, depth.at(a, b));
        CHECK(seeds.depth[p] <= high * (1.0 + round_off));
        CHECK(seeds.depth[p] >= low * (1.0 - round_off));
        volume[static_cast<std::size_t>(i + 5 * j)] += seeds.volume[p];
    }
    for (std::size_t k = 0; k < volume.size(); ++k)
        CHECK(volume[k] == Approx(depth.values[k] > 0.0 ? pixel * pixel * depth.values[k] : 0.0).epsilon(round_off));
}

TEST_CASE("Depths on finer cells are of second order, also at a hill's top", "[scene]") {
    // Means over pixels of waves on [-1, 1]^2. On a hill's highest pixel depths are even. Its slope there is the curvature
    // times a pixel at most, and that times half a pixel the error: 2 size^2 along each axis for a curvature of 4.
    const auto mean_of = [](double middle, double size, double shift) {
        return (std::sin(2.0 * (middle + 0.5 * size) + shift) - std::sin(2.0 * (middle - 0.5 * size) + shift)) /
               (2.0 * size);
    };
    const auto field_of = [&](const GridGeometry& g) {
        Raster field = Raster::filled(g, 0.0);
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i)
                field.at(i, j) = 2.0 + mean_of(g.x(i), g.cell, 0.1) * mean_of(g.y(j), g.cell, -0.2);
        return field;
    };
    for (const Index count : {20, 40, 80, 160}) {
        const double size = 2.0 / static_cast<double>(count);
        const Raster fine =
            finer_field(field_of({count, count, -1.0 + 0.5 * size, -1.0 + 0.5 * size, size}), 0.25 * size);
        REQUIRE(fine.geometry.nx == 4 * count);
        const Raster exact = field_of(fine.geometry);
        double worst = 0.0, sum = 0.0;
        for (Index j = 4; j < fine.geometry.ny - 4; ++j)  // at the edge depths end
            for (Index i = 4; i < fine.geometry.nx - 4; ++i) {
                const double error = std::abs(fine.at(i, j) - exact.at(i, j));
                worst = std::max(worst, error), sum += error;
            }
        CAPTURE(count, worst, sum);
        CHECK(worst < 4.0 * size * size);
        CHECK(sum / static_cast<double>(fine.geometry.size()) < 0.1 * size * size);  // few pixels are the highest
    }
}

TEST_CASE("Each polygon of a barrier's outline can be its own barrier", "[scene]") {
    FakeGis gis = slope_gis();
    gis.polygons["dams.gpkg"] = rectangle(1120, 2050, 1125, 2060);
    gis.polygons["dams.gpkg"].parts.push_back(rectangle(1120, 2070, 1125, 2080).parts[0]);
    const auto barriers = [&](const std::string& keys) {
        return built(with_release("outline = \"release.geojson\"\ndepth = 2.0",
                                  "[[barrier]]\noutline = \"dams.gpkg\"\nheight = 4\n" + keys),
                     gis)
            .scene.barriers;
    };
    REQUIRE(barriers("").size() == 1);
    CHECK(barriers("")[0].outline.parts.size() == 2);
    const std::vector<Barrier> each = barriers("name = \"dam\"\neach = true");
    REQUIRE(each.size() == 2);
    CHECK(each[0].name == "dam_1");
    CHECK(each[1].name == "dam_2");
    REQUIRE(each[1].outline.parts.size() == 1);
    CHECK(each[1].outline.parts[0].rings[0][0] == Vec2(1120, 2070));
    CHECK(each[1].height == 4.0);
    const std::string release = "outline = \"release.geojson\"\ndepth = 2.0";
    const auto line = problems_of(
        with_release(release, "[[barrier]]\nline = [[1120, 2050], [1120, 2060]]\nheight = 4\neach = true\n"), gis);
    REQUIRE(line.size() == 1);
    CHECK(line[0].find("each: found without outline") != std::string::npos);
    const auto same = problems_of(with_release(release,
                                               "[[barrier]]\noutline = \"dams.gpkg\"\nname = \"dam\"\nheight = 4\n"
                                               "each = true\n[[barrier]]\noutline = \"dams.gpkg\"\n"
                                               "name = \"dam_2\"\nheight = 4\n"),
                                  gis);
    REQUIRE(same.size() == 1);
    CHECK(same[0].find("found a barrier \"dam_2\", which barrier.0 has made as well") != std::string::npos);
}
