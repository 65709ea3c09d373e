// [[insitu]] and [[camera]]: from the case file to the scene, and what is refused before the first step.
#include "base/error.h"
#include "catch.h"
#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

std::string with(const std::string& rest) {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = "
           "20\n" +
           rest;
}

CaseFile read(const std::string& rest, const std::vector<std::string>& sets = {}) {
    return CaseFile::parse(with(rest), "slide/case.toml", sets);
}

std::vector<Insitu> entries(const std::string& rest, const std::vector<std::string>& sets = {}) {
    return build_scene(read(rest, sets), slope_gis()).insitu;
}

/// The one problem of a case that has exactly one; the lines of `rest` begin at 8.
std::string problem_of(const std::string& rest) {
    return only_problem([&] { entries(rest); });
}

const std::string everything = R"([[camera]]
name = "ridge"
projection = "perspective"
position = [1000, 2000, 400]
target = [1100, 2075, 150]
view_angle_deg = 40
[[camera]]
name = "plan"
projection = "map"
window = [1020, 2010, 1120, 2100]
[[insitu]]
name = "cut"
kind = "profile"
line = [[1010, 2075], [1190, 2075]]
fields = ["depth", "velocity_x"]
picture = true
every = 0.5
[[insitu]]
name = "lines"
kind = "contour"
field = "depth"
levels = [0.1, 1, 2]
gis = true
every_steps = 20
[[insitu]]
name = "fast"
kind = "threshold"
of = "particles"
field = "speed"
from = 5
to = 50
[[insitu]]
name = "map"
kind = "figure"
field = "speed"
camera = "plan"
range = [0, 20]
above = 0.5
width = 640
height = 480
[[insitu]]
name = "view"
kind = "figure"
field = "depth"
camera = "ridge"
[[insitu]]
name = "extremes"
kind = "reduce"
)";

std::string figure(const std::string& keys) { return "[[insitu]]\nname = \"a\"\nkind = \"figure\"\n" + keys; }

}  // namespace

TEST_CASE("Every key of [[insitu]] and [[camera]] reaches the scene", "[case][insitu]") {
    const std::vector<Insitu> all = entries(everything);
    REQUIRE(all.size() == 6);
    CHECK(all[0].kind == Insitu::Kind::profile);
    CHECK(all[0].fields == std::vector<std::string>{"depth", "velocity_x"});
    CHECK(all[0].line.size() == 2);
    CHECK(all[0].picture);
    CHECK(all[0].every == 0.5);
    CHECK_FALSE(all[0].every_steps);
    CHECK(all[1].kind == Insitu::Kind::contour);
    CHECK(all[1].levels == std::vector<double>{0.1, 1.0, 2.0});
    CHECK(all[1].gis);
    CHECK(all[1].every_steps == 20);
    CHECK(all[2].kind == Insitu::Kind::threshold);
    CHECK(all[2].of_particles);
    CHECK(all[2].from == 5.0);
    CHECK(all[2].to == 50.0);
    CHECK(all[3].kind == Insitu::Kind::figure);
    CHECK(all[3].range == std::make_pair(0.0, 20.0));
    CHECK(all[3].above == 0.5);
    CHECK(all[3].width == 640);
    CHECK(all[3].height == 480);
    REQUIRE(all[3].camera);
    CHECK_FALSE(all[3].camera->perspective);
    CHECK(all[3].camera->window == std::array<double, 4>{1020, 2010, 1120, 2100});
    REQUIRE(all[4].camera);
    CHECK(all[4].camera->perspective);
    CHECK(all[4].camera->position == std::array<double, 3>{1000, 2000, 400});
    CHECK(all[4].camera->target == std::array<double, 3>{1100, 2075, 150});
    CHECK(all[4].camera->view_angle_deg == 40.0);
    CHECK(all[5].kind == Insitu::Kind::reduce);
    CHECK(all[5].fields == std::vector<std::string>{"depth", "speed"});
    CHECK(entries("").empty());
    CHECK(entries(figure("field = \"depth\""), {"insitu.0.field=speed"})[0].fields[0] == "speed");
}

TEST_CASE("resolved.toml has the in-situ entries and reads back to the same", "[case][insitu][resolved]") {
    const CaseFile file = read(everything);
    const std::string resolved = resolved_toml(file);
    CAPTURE(resolved);
    CHECK(resolved.find("width = 1000.0  # default\n") != std::string::npos);
    CHECK(resolved.find("view_angle_deg = 40.0\n") != std::string::npos);
    const CaseFile again = CaseFile::parse(resolved, "slide/case.toml");
    CHECK(again.count("insitu") == 6);
    CHECK(again.numbers("insitu.1.levels") == file.numbers("insitu.1.levels"));
    CHECK(again.word("insitu.3.camera") == "plan");
    CHECK_FALSE(again.given("insitu.5.levels"));
    CHECK(build_scene(again, slope_gis()).insitu.size() == 6);
}

TEST_CASE("A run may write no frames at all", "[case][insitu]") {
    const Scene scene = build_scene(read("[output]\nformats = []\n"), slope_gis());
    CHECK_FALSE((scene.output.vtk || scene.output.xdmf || scene.output.geotiff || scene.output.png));
    CHECK(resolved_toml(read("[output]\nformats = []\n")).find("formats = []\n") != std::string::npos);
}

TEST_CASE("Outlines of particles for a GIS are refused", "[case][insitu]") {
    CHECK(problem_of("[[insitu]]\nname = \"a\"\nkind = \"threshold\"\nfield = \"depth\"\nfrom = 1\nof = "
                     "\"particles\"\ngis = true\n") ==
          "slide/case.toml:14: insitu.0.gis: found true with insitu.of = \"particles\"; expected the grid, whose "
          "cells have an outline; remove one of them");
}

TEST_CASE("A bad entry is refused with its place, what was found, what is expected and a way out", "[case][insitu]") {
    CHECK(problem_of("[[insitu]]\nname = \"a\"\nkind = \"figur\"\n") ==
          "slide/case.toml:10: insitu.0.kind: found the text \"figur\"; expected one of \"profile\", \"contour\", "
          "\"threshold\", \"figure\", \"reduce\", \"catalyst\"; did you mean \"figure\"?");
    CHECK_THAT(problem_of(figure("field = \"deph\"\n")),
               Catch::StartsWith("slide/case.toml:11: insitu.0.field: found the text \"deph\"; expected one of ") &&
                   Catch::EndsWith("did you mean \"depth\"?"));
    CHECK(problem_of(figure("field = \"stress_xx\"\n")) ==
          "slide/case.toml:11: insitu.0.field: found \"stress_xx\" in a case without stress; expected a field of this "
          "case, since material.rheology.law = \"none\" has no stress; choose another field, or give the mass a "
          "rheology");
    CHECK(problem_of(figure("field = \"water_depth\"\n")) ==
          "slide/case.toml:11: insitu.0.field: found \"water_depth\" in a case without free water; expected a field of "
          "this case, since water.model = \"none\"; choose another field, or set water.model = \"free\"");
    CHECK(problem_of(figure("field = \"mass\"\n")) ==
          "slide/case.toml:11: insitu.0.field: found \"mass\", which nodes do not have; expected a field of the grid; "
          "choose another field; of = \"particles\" with kind = \"threshold\" has it");
    CHECK(problem_of(figure("")) ==
          "slide/case.toml:8: insitu.0.field: not given, but insitu.kind = \"figure\" needs it; expected one of "
          "\"depth\", \"thickness\", \"speed\", \"velocity_x\", \"velocity_y\", \"velocity_z\", \"pressure\", "
          "\"surface\", \"elevation\", \"peak_depth\", \"peak_speed\", \"peak_pressure\", \"arrival_time\", "
          "\"peak_dynamic_pressure\", \"stress_xx\", \"stress_yy\", \"stress_xy\", \"effective_stress_xx\", \"mass\", "
          "\"effective_stress_yy\", \"volume\", \"effective_stress_xy\", \"damage\", \"cohesion\", "
          "\"water_depth\", \"water_speed\", \"water_velocity_x\", \"water_velocity_y\", \"water_velocity_z\", "
          "\"id\", quantity that is looked at, one number a place; add field = ... under [[insitu]]");
    CHECK(problem_of(figure("field = \"depth\"\nlevels = [1]\n")) ==
          "slide/case.toml:12: insitu.0.levels: found, but insitu.kind = \"figure\" does not use it; expected with "
          "contour only; remove it, or choose insitu.kind");
    CHECK(problem_of(figure("field = \"depth\"\nrange = [2, 1]\n")) ==
          "slide/case.toml:12: insitu.0.range: found [2.0, 1.0]; expected [low, high] with low < high; exchange the "
          "two");
    CHECK(problem_of(figure("field = \"depth\"\ncamera = \"ridge\"\n")) ==
          "slide/case.toml:12: insitu.0.camera: found \"ridge\"; expected the name of a [[camera]]; add that "
          "[[camera]], "
          "or correct the name");
    CHECK(problem_of("[[insitu]]\nname = \"a\"\nkind = \"threshold\"\nfield = \"depth\"\n") ==
          "slide/case.toml:8: insitu.0: found a threshold without from and to; expected one of them, or both; add "
          "from = ... or to = ...");
    CHECK(problem_of("[[insitu]]\nname = \"a\"\nkind = \"profile\"\nline = [[0, 0], [1, 1]]\n") ==
          "slide/case.toml:11: insitu.0.line: found no point of it on the terrain; expected it within x 1000 to "
          "1200, y "
          "2000 to 2150; correct the coordinates");
    CHECK(problem_of(figure("field = \"depth\"\n") + figure("field = \"speed\"\n")) ==
          "slide/case.toml:13: insitu.1.name: found \"a\" again; expected a name other than that at "
          "slide/case.toml:9: insitu.0.name; rename one of them");
    CHECK(problem_of(figure("field = \"depth\"\nevery = 0\n")) ==
          "slide/case.toml:12: insitu.0.every: found 0; expected a number above 0 [s]; choose a value in this range");
}

TEST_CASE("A camera that cannot see is refused", "[case][insitu]") {
    CHECK(problem_of("[[camera]]\nname = \"c\"\nprojection = \"perspective\"\ntarget = [1100, 2075, 150]\n") ==
          "slide/case.toml:8: camera.0.position: not given, but camera.projection = \"perspective\" needs it; "
          "expected a "
          "list of 3 numbers [m], where the eye is: [x, y, elevation]; add position = ... under [[camera]]");
    const std::string eye = "[[camera]]\nname = \"c\"\nprojection = \"perspective\"\nposition = [1100, 2075, 140]\n";
    CHECK(problem_of(eye + "target = [1050, 2075, 100]\n") ==
          "slide/case.toml:11: camera.0.position: found 140 m, under the ground; expected an elevation above that "
          "of the "
          "terrain there, 150 m; raise the camera");
    CHECK(problem_of("[[camera]]\nname = \"c\"\nprojection = \"map\"\nwindow = [0, 0, 10, 10]\n") ==
          "slide/case.toml:11: camera.0.window: found [0.0, 0.0, 10.0, 10.0]; expected [xmin, ymin, xmax, ymax] that "
          "meets the terrain, x 1000 to 1200, y 2000 to 2150; correct the coordinates, or remove the window");
    CHECK_THAT(problem_of("[[camera]]\nname = \"c\"\nprojection = \"map\"\nposition = [1, 2, 3]\n"),
               Catch::Contains("camera.projection = \"map\" does not use it"));
}
