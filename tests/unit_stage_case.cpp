// [[stage]]: from the case file to the scene, and what is refused before the first step.
#include "base/constants.h"
#include "base/error.h"
#include "catch.h"
#include "checks/verify/box_mesh.h"
#include "scene/build_scene.h"
#include "scene/gap_below.h"
#include "slope_case.h"
#include "terrain/distance_field.h"

using namespace frana;
using namespace frana::test;

namespace {

/// The slope with one node without elevation, and two walls, one of them far away.
FakeGis walled_gis() {
    FakeGis gis = slope_gis();
    gis.rasters["dem.tif"].at(39, 29) = Raster::nodata;
    gis.polygons["wall.geojson"] = rectangle(1030, 2040, 1035, 2090);
    gis.polygons["away.geojson"] = rectangle(3030, 2040, 3035, 2090);
    return gis;
}

std::string text_of(const std::string& rest) {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\n"
           "end = 20\n[material.bed]\nlaw = \"voellmy\"\nmu = 0.2\nxi = 500\n" +
           rest;
}

CaseFile case_of(const std::string& rest) { return CaseFile::parse(text_of(rest), "slide/case.toml"); }

Scene scene_of(const std::string& rest) { return build_scene(case_of(rest), walled_gis()); }

/// The one problem of a case that has exactly one; the lines of `rest` begin at 12.
std::string problem_of(const std::string& rest) {
    return only_problem([&] { scene_of(rest); });
}

const std::string two = "[[stage]]\nmodel = \"depth_averaged\"\nuntil = 8\n[[stage]]\nmodel = \"mpm3d\"\n";
const std::string west = "window = [1005, 2000, 1060, 2100]\n";

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("Mud by the bed law is mud in 3D, which its bed holds or brakes", "[stages]") {
    const auto of = [](const std::string& bed, const std::string& more) {
        const std::string text =
            "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
            "[time]\nend = 20\n[material.bed]\n" +
            bed + "[[stage]]\nmodel = \"mpm3d\"\n" + west + more;
        return build_scene(CaseFile::parse(text, "slide/case.toml"), walled_gis()).solid.value();
    };
    const std::string mud = "law = \"bingham\"\nviscosity = 20\nyield_stress = 300\n";
    const auto law = std::get<solid::Bingham>(of(mud, "").law);
    CHECK(law.viscosity == 20.0);
    CHECK(law.yield_stress == 300.0);
    CHECK(of(mud, "").stuck_where_resolved);  // else the bed law brakes it
    CHECK(of(mud, "").whole_bed_law);
    CHECK(of(mud, "stuck = true\n").stuck);
    for (const char* more : {"stuck = true\n", "stuck = false\n", "law = \"fluid\"\n", "bed_friction = 0.4\n"})
        CHECK_FALSE(of(mud, more).stuck_where_resolved);
    CHECK(of(mud, "stuck = false\n").whole_bed_law);
    CHECK_FALSE(of(mud, "bed_friction = 0.4\n").whole_bed_law);
    CHECK_FALSE(of(mud, "stuck = false\n").stuck);
    CHECK_FALSE(of(mud, "law = \"fluid\"\n").stuck);
    CHECK_FALSE(of(mud, "bed_friction = 0.4\n").stuck);  // it slides, by that coefficient
    CHECK(of(mud, "bed_friction = 0.4\n").bed_friction == 0.4);
    CHECK(std::holds_alternative<solid::Fluid>(of("law = \"none\"\n", "").law));
}

TEST_CASE("A 3D stage has the scene's laws where it gives none of its own", "[stages]") {
    const SolidStage stage = scene_of(two + west).solid.value();
    CHECK(stage.from == 8.0);
    // Nodes stand at 1002.5, 1007.5, ...: those in the window.
    CHECK(stage.window == std::array<Index, 4>{1, 0, 11, 19});
    CHECK(stage.cell == 2.5);
    CHECK(stage.spacing == 1.25);
    CHECK(stage.bed_friction == 0.2);
    // Sand as steep inside as the bed's friction.
    CHECK(stage.of_bed);
    CHECK(std::get<solid::DruckerPrager>(stage.law).alpha == solid::DruckerPrager::of({}, std::atan(0.2), 0.0).alpha);
    CHECK(stage.transfer == Transfer::flip);
    CHECK_FALSE(stage.stuck);
    CHECK(std::holds_alternative<solid::Fluid>(scene_of(two + west + "law = \"fluid\"\n").solid->law));
    CHECK(std::get<solid::Fluid>(scene_of(two + west + "viscosity = 7\n").solid->law).viscosity == 7.0);
    CHECK_FALSE(stage.fluid_by_drag);
    std::string drag_alone = text_of(two + west);
    drag_alone.replace(drag_alone.find("mu = 0.2"), 8, "mu = 0.0");
    const Scene drag = build_scene(CaseFile::parse(drag_alone, "slide/case.toml"), walled_gis());
    CHECK(std::holds_alternative<solid::Fluid>(drag.solid->law));
    CHECK(drag.solid->fluid_by_drag);
    CHECK_FALSE(stage.sound_speed.has_value());
    const Scene bingham = scene_of(
        "[material.rheology]\nlaw = \"bingham\"\nviscosity = 20\nyield_stress = 300\n[[stage]]\nmodel = "
        "\"mpm3d\"\n" +
        west + "viscosity = 30\n");
    CHECK(bingham.solid->from == 0.0);
    const auto& law = std::get<solid::Bingham>(bingham.solid->law);
    CHECK(law.viscosity == 30.0);
    CHECK(law.yield_stress == 300.0);
    CHECK(law.shear == 3e4);
}

TEST_CASE("The former word for 3D points means the same, and resolved cases have today's", "[stages]") {
    const std::string stage = "[[stage]]\nmodel = \"solid_flow\"\n" + west + "bed_friction = 0.4\n";
    const Scene scene = scene_of(stage);
    REQUIRE(scene.solid);
    CHECK(scene.solid->bed_friction == 0.4);
    const std::string resolved = resolved_toml(case_of(stage));
    CHECK(has(resolved, "model = \"mpm3d\""));
    CHECK_FALSE(has(resolved, "solid_flow"));
    CHECK(has(problem_of("[[stage]]\nmodel = \"solid_flaw\"\n"), "mpm3d"));
}

TEST_CASE("A window is closed where the case says so, and where it reaches walls of the terrain", "[stages]") {
    const std::string edge = "window = [1000, 2000, 1060, 2100]\n";
    using Closed = std::array<bool, 4>;
    CHECK(scene_of(two + edge).solid->closed == Closed{false, false, false, false});
    CHECK(scene_of(two + edge + "closed = [\"north\"]\n").solid->closed == Closed{false, false, false, true});
    CHECK(scene_of(two + edge + "[boundary]\nsides = \"wall\"\n").solid->closed == Closed{true, true, false, false});
    // A cell away from a wall points would go on through it.
    const SolidStage near =
        scene_of(two + "window = [1005, 2005, 1060, 2100]\n[boundary]\nsides = \"wall\"\n").solid.value();
    CHECK(near.closed == Closed{true, true, false, false});
    CHECK(near.window == std::array<Index, 4>{0, 0, 11, 19});
}

TEST_CASE("Sides of the terrain that are planes of symmetry are so for points, the window's own are walls",
          "[stages]") {
    const std::string edge = "window = [1000, 2000, 1060, 2100]\nclosed = [\"west\", \"north\"]\n";
    using Sides = std::array<bool, 4>;
    const Scene wall = scene_of(two + edge + "[boundary]\nsides = \"wall\"\n"),
                mirror = scene_of(two + edge + "[boundary]\nsides = \"mirror\"\n");
    for (const Scene* scene : {&wall, &mirror}) CHECK(scene->solid->closed == Sides{true, true, false, true});
    CHECK(wall.solid->mirrors == Sides{});
    CHECK(mirror.solid->mirrors == Sides{true, true, false, false});
}

TEST_CASE("A 3D stage ends where particles follow it", "[stages]") {
    const std::string after = "[[stage]]\nmodel = \"depth_averaged\"\n";
    const SolidStage middle = scene_of(two + west + "until = 12\n" + after).solid.value();
    CHECK(middle.from == 8.0);
    CHECK(middle.until == 12.0);
    CHECK(middle.window == std::array<Index, 4>{1, 0, 11, 19});
    const SolidStage first = scene_of("[[stage]]\nmodel = \"mpm3d\"\nuntil = 5\n" + west + after).solid.value();
    CHECK(first.from == 0.0);
    CHECK(first.until == 5.0);
    CHECK_FALSE(scene_of(two + west).solid->until.has_value());
}

TEST_CASE("A stage of particles to the end changes nothing", "[stages]") {
    CHECK_FALSE(scene_of("[[stage]]\nmodel = \"depth_averaged\"\n").solid.has_value());
    CHECK_FALSE(scene_of("").solid.has_value());
}

TEST_CASE("Stages that cannot be are refused in one sentence", "[stages]") {
    CHECK(has(problem_of(two + "window = [1005, 2000, 1060, 2300]\n"),
              "case.toml:17: stage.1.window: found [1005.0, 2000.0, 1060.0, 2300.0]; expected [xmin, ymin, "
              "xmax, ymax] of "
              "at least 3 x 3 cells of 5 m within x 1000 to 1200, y 2000 to 2150"));
    CHECK(has(problem_of(two), "case.toml:15: stage.1: found no elevation at x 1197.5, y 2147.5"));
    CHECK(has(problem_of(two + west + "top = -50\n"),
              "stage.1.top: found -50 m; expected more than the window's lowest ground"));
    CHECK(has(
        problem_of(two + west + "[[barrier]]\noutline = \"wall.geojson\"\nheight = 2\nstuck = true\nfriction = 0.3\n"),
        "barrier.0.friction: found 0.3 with barrier.stuck = true; expected one of both"));
    const Scene buried = scene_of("[[barrier]]\noutline = \"wall.geojson\"\ntop = -50\n");
    CHECK(std::any_of(buried.log.begin(), buried.log.end(),
                      [](const std::string& one) { return has(one, "barrier.0.top: found -50 m; expected more"); }));
    CHECK(has(problem_of("[[stage]]\nmodel = \"depth_averaged\"\nuntil = 25\n[[stage]]\nmodel = \"mpm3d\"\n" + west),
              "stage.0.until: found 25 s; expected a time before time.end = 20 s"));
    CHECK(has(problem_of("[[stage]]\nmodel = \"depth_averaged\"\n[[stage]]\nmodel = \"mpm3d\"\n" + west),
              "stage.0: not given until, and another stage follows"));
    const std::string particles = "[[stage]]\nmodel = \"depth_averaged\"\n";
    CHECK(has(problem_of(two + west + particles), "stage.1: not given until, and another stage follows"));
    CHECK(has(problem_of(two + west + "until = 8\n" + particles),
              "stage.1.until: found 8 s; expected a time between the stage's begin, 8 s, and time.end = 20 s"));
    CHECK(has(problem_of(two + west + "until = 12\n" + particles + "until = 99\n"),
              "stage.2.until: found 99 s; expected none in the last stage, or time.end = 20 s"));
    CHECK(has(problem_of("[[stage]]\nmodel = \"depth_averaged\"\nuntil = 5\n" + particles),
              "stage.1: found it after the others"));
    CHECK(has(problem_of(two + west + "until = 12\n" + particles + "until = 15\n[[stage]]\nmodel = \"mpm3d\"\n"),
              "stage.3: found it after the others; expected depth_averaged, then mpm3d, then depth_averaged"));
    CHECK(has(problem_of(two + west + "until = 15\n"), "stage.1.until: found 15 s; expected none in the last stage"));
    CHECK(
        has(problem_of(two + west + "spacing = 3\n"), "stage.1.spacing: found 3 m; expected at most the stage's cell"));
    CHECK(has(problem_of(two + west + "cell = 1000\n"),
              "stage.1.cell: found 1000 m; expected at most the window's shorter side, 55 m"));
    CHECK(has(problem_of(two + west + "top = 1e9\n"),
              "stage.1.top: found 1e+09 m; expected at most 10128.8 m, 10 km above the window's ground"));
    CHECK(has(problem_of(two + west + "spacing = 1e-5\n"),
              "stage.spacing: found 3e+18 3D points once all of the release is in the window, which need "));
    CHECK(has(problem_of(two + west + "yield_stress = 3\n"),
              "stage.1.yield_stress: found, but the law \"drucker_prager by the bed's friction\" does not"));
    CHECK(has(problem_of(two + west + "cohesion = 3\n"),
              "stage.1.cohesion: found, but the law \"drucker_prager by the bed's friction\" does not"));
    CHECK(has(problem_of(two + west + "law = \"bingham\"\n"), "stage.1.law: found \"bingham\" without a yield stress"));
    CHECK(has(problem_of(two + west + "law = \"elastic\"\nyoung_modulus = 1e6\nsound_speed = 3\n"),
              "stage.1.sound_speed: found, but the law \"elastic\" does not"));
    CHECK(has(problem_of(two + west + "law = \"drucker_prager\"\nyoung_modulus = 1e6\n"),
              "stage.1.friction_angle_deg: not given, but stage.law = \"drucker_prager\" needs it"));
    CHECK(has(problem_of(two + west + "stuck = true\nbed_friction = 0.3\n"),
              "stage.1.bed_friction: found 0.3 with stage.stuck = true"));
    CHECK(has(problem_of("[[stage]]\nmodel = \"depth_averaged\"\ncell = 2\n"),
              "stage.0.cell: found, but stage.model = \"depth_averaged\" does not use it"));
}

TEST_CASE("Sand is as strong as its angle says in triaxial compression, or by choice in plane strain", "[case]") {
    const std::string sand = two + west + "law = \"drucker_prager\"\nyoung_modulus = 1e6\nfriction_angle_deg = 30\n";
    const auto alpha = [&](const std::string& keys) {
        return std::get<solid::DruckerPrager>(scene_of(sand + keys).solid->law).alpha;
    };
    CHECK(alpha("") == Approx(std::sqrt(2.0 / 3.0) * 6.0 * 0.5 / 2.5).epsilon(1e-12));
    CHECK(alpha("cone = \"plane_strain\"\n") == Approx(std::sqrt(2.0) * 0.5).epsilon(1e-12));
    CHECK(alpha("cone = \"simple_shear\"\n") ==
          Approx(std::sqrt(2.0) * std::tan(30.0 * constants::kPi / 180.0)).epsilon(1e-12));
    CHECK(has(problem_of(two + west + "cone = \"plane_strain\"\n"), "stage.1.cone: found, but"));
}

TEST_CASE("Grains have the mu(I) of their stage, else of the bed", "[case]") {
    const std::string grains = two + west + "law = \"mu_i\"\nyoung_modulus = 1e6\n";
    CHECK(has(problem_of(grains), "found \"mu_i\" without stage.mu_s, stage.mu_2, stage.grain_diameter"));
    const std::string own = grains + "mu_s = 0.4\nmu_2 = 0.7\ngrain_diameter = 0.02\n";
    const SolidStage stage = scene_of(own).solid.value();
    const auto law = std::get<solid::MuI>(stage.law);
    CHECK(law.mu_s == 0.4);
    CHECK(law.mu_2 == 0.7);
    CHECK(law.i0 == 0.3);
    CHECK(law.grain_diameter == 0.02);
    CHECK(law.solid_fraction == 0.6);
    CHECK(stage.transfer == Transfer::flip);
    CHECK(has(problem_of(grains + "mu_s = 0.4\nmu_2 = 0.4\ngrain_diameter = 0.02\n"),
              "found mu_2 = 0.4 with mu_s = 0.4; expected mu_2 above mu_s"));
    const auto of = [](const std::string& more) {
        std::string text = text_of(two + west + more);
        const std::string coulomb = "mu = 0.2";
        const std::size_t law_at = text.find("law = \"voellmy\"");
        REQUIRE(law_at != std::string::npos);
        text.replace(law_at, 15, "law = \"pouliquen\"");
        text.replace(text.find(coulomb), coulomb.size(), "mu_s = 0.3\nmu_2 = 0.6\ni0 = 0.2\ngrain_diameter = 0.05");
        text.erase(text.find("xi = "), text.find('\n', text.find("xi = ")) - text.find("xi = "));
        return build_scene(CaseFile::parse(text, "slide/case.toml"), walled_gis()).solid.value();
    };
    const SolidStage by_bed = of("");
    CHECK(by_bed.of_bed);
    CHECK(std::get<solid::MuI>(by_bed.law).mu_2 == 0.6);
    CHECK(std::get<solid::MuI>(by_bed.law).i0 == 0.2);
    CHECK(std::get<solid::MuI>(of("law = \"mu_i\"\nyoung_modulus = 1e6\nmu_s = 0.25\n").law).mu_s == 0.25);
    CHECK(std::get<solid::MuI>(of("law = \"mu_i\"\nyoung_modulus = 1e6\n").law).grain_diameter == 0.05);
    CHECK(std::holds_alternative<solid::DruckerPrager>(of("bed_friction = 0.5\n").law));
}

TEST_CASE("Cohesion without an angle of friction has no cone, and is refused by its key", "[case]") {
    const std::string clay = two + west + "law = \"drucker_prager\"\nyoung_modulus = 1e6\ncohesion = 5000\n";
    const std::string problem = problem_of(clay + "friction_angle_deg = 0\n");
    CHECK(has(problem, "stage.1.friction_angle_deg: found 0 with stage.cohesion = 5000 Pa; expected an angle above 0"));
    CHECK(has(problem, "give an angle"));
    CHECK(std::get<solid::DruckerPrager>(scene_of(clay + "friction_angle_deg = 1\n").solid->law).tension ==
          Approx(5000.0 / std::tan(constants::kPi / 180.0)));
}

TEST_CASE("Sand retains its velocities unless it is told not to, fluids do not", "[case]") {
    const std::string sand = two + west + "law = \"drucker_prager\"\nyoung_modulus = 1e6\nfriction_angle_deg = 30\n";
    const SolidStage stage = scene_of(sand).solid.value();
    CHECK(stage.transfer == Transfer::flip);
    CHECK(stage.split);  // nor does its thin end break off
    CHECK_FALSE(scene_of(sand + "split = false\n").solid->split);
    CHECK_FALSE(scene_of(two + west + "law = \"fluid\"\n").solid->split);
    CHECK(scene_of(two + west + "law = \"fluid\"\nsplit = true\n").solid->split);
    CHECK(stage.blending == Approx(std::sqrt(2.5 / 9.81)).epsilon(1e-3));
    const std::string fluid = two + west + "law = \"fluid\"\n";
    CHECK(scene_of(fluid).solid->transfer == Transfer::tpic);
    CHECK(scene_of(sand + "transfer = \"tpic\"\n").solid->transfer == Transfer::tpic);
    CHECK(scene_of(two + west + "transfer = \"flip\"\nblending = 0.3\n").solid->blending == 0.3);
    CHECK(has(problem_of(fluid + "blending = 0.3\n"),
              "stage.1.blending: found with a law that has stage.transfer = \"tpic\"; expected it with \"flip\" only"));
}

TEST_CASE("Herschel and Bulkley's mud has its own numbers, and the rheology's yield stress", "[case]") {
    const std::string mud = two + west + "law = \"herschel_bulkley\"\nconsistency = 40\nexponent = 0.4\n";
    const auto law = std::get<solid::HerschelBulkley>(scene_of(mud + "yield_stress = 200\n").solid->law);
    CHECK(law.consistency == 40.0);
    CHECK(law.exponent == 0.4);
    CHECK(law.yield_stress == 200.0);
    CHECK(law.shear == 2e4);
    CHECK(has(problem_of(mud), "stage.1.law: found \"herschel_bulkley\" without a yield stress"));
    CHECK(has(problem_of(mud + "yield_stress = 200\nviscosity = 3\n"), "stage.1.viscosity: found, but the law"));
    CHECK(has(problem_of(two + west + "law = \"herschel_bulkley\"\nyield_stress = 200\nexponent = 0.4\n"),
              "stage.1.consistency: not given, but"));
    CHECK(has(problem_of(two + west + "exponent = 0.4\n"), "stage.1.exponent: found, but"));
}

TEST_CASE("Barriers come with their places and heights", "[barrier]") {
    const Scene scene = scene_of(
        "[[barrier]]\noutline = \"wall.geojson\"\nheight = 4\n[[barrier]]\nname = \"dam\"\nline = "
        "[[1020, 2040], [1020, 2060], [1030, 2080]]\ntop = 130\nwet = \"right\"\nfriction = 0.3\n");
    REQUIRE(scene.barriers.size() == 2);
    const Barrier &wall = scene.barriers[0], &dam = scene.barriers[1];
    CHECK(wall.name == "barrier_1");
    CHECK(wall.height == 4.0);
    CHECK_FALSE(wall.top.has_value());
    CHECK(wall.outline.parts.size() == 1);
    CHECK(dam.name == "dam");
    CHECK(dam.top == 130.0);
    CHECK(dam.line.size() == 3);
    CHECK_FALSE(dam.wet_left);
    CHECK(dam.friction == 0.3);
}

TEST_CASE("What resolved.toml says of a barrier on an outline or of any shape is a case again", "[barrier]") {
    const std::string text =
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
        "[material.bed]\nlaw = \"none\"\n[[barrier]]\n";
    const auto resolved_of = [&](const std::string& keys) {
        return resolved_toml(CaseFile::parse(text + keys, "slide/case.toml"));
    };
    CHECK_NOTHROW(CaseFile::parse(resolved_of("mesh = \"wall.stl\"\n"), "run/resolved.toml"));
    const std::string resolved = resolved_of("outline = \"wall.geojson\"\nheight = 4\n");
    REQUIRE(has(resolved, "wet = \"left\""));
    CHECK(CaseFile::parse(resolved, "run/resolved.toml").number("barrier.0.height") == 4.0);
    CHECK(has(problem_of("[[barrier]]\noutline = \"wall.geojson\"\nheight = 4\nwet = \"right\"\n"),
              "barrier.0.wet: found together with outline; expected it with line only"));
}

TEST_CASE("Barriers that cannot be are refused in one sentence", "[barrier]") {
    const auto barrier = [](const std::string& keys) { return problem_of("[[barrier]]\n" + keys); };
    CHECK(has(barrier("outline = \"away.geojson\"\nheight = 4\n"),
              "case.toml:13: barrier.0.outline: found no point of it on the terrain; expected the barrier "
              "within x 1000 to 1200"));
    CHECK(has(barrier("outline = \"wall.geojson\"\n"), "barrier.0.height: not given, and no top either"));
    CHECK(has(barrier("outline = \"wall.geojson\"\nheight = 4\ntop = 130\n"), "found together with"));
    CHECK(has(barrier("outline = \"wall.geojson\"\nheight = 4\nthickness = 2\n"),
              "barrier.0.thickness: found together with outline; expected it with line only"));
    CHECK(has(barrier("outline = \"none.geojson\"\nheight = 4\n"), "none.geojson: no such polygons"));
    CHECK(has(barrier("height = 4\nline = [[1020, 2040], [1020, 2060], [1021, 2040]]\n"),
              "barrier.0.line: found a turn by more than 120 degrees at (1020, 2060)"));
    CHECK(has(barrier("height = -4\noutline = \"wall.geojson\"\n"), "barrier.0.height: found -4"));
    for (const char* windows :
         {"[]", "[0.1, 0.1]", "[1.0, 0.01]", "[0.0]", "[1e-9]", "[20.0]", "[1, 2, 3, 4, 5, 6, 7, 8, 9]"})
        CHECK(has(barrier(std::string("outline = \"wall.geojson\"\nheight = 4\nwindows = ") + windows + "\n"),
                  "barrier.0.windows: found "));
}

TEST_CASE("A barrier that stands outside of the stage's window is remarked on, one inside it is not", "[barrier]") {
    const auto remarks = [](const std::string& window) {
        std::string all;
        for (const std::string& line :
             scene_of(two + window + "[[barrier]]\noutline = \"wall.geojson\"\nheight = 40\n").log)
            all += line;
        return all;
    };
    CHECK_FALSE(has(remarks(west), "barrier.0"));
    CHECK(has(remarks("window = [1100, 2000, 1160, 2100]\n"),
              "barrier.0.outline: stands outside of stage.window: 3D points do not meet it"));
    // The run said it, `check` did not. Of its 110 m around, 50 are within the window's nodes, up to y = 2062.5.
    CHECK(has(remarks("window = [1005, 2000, 1060, 2065]\n"), "45 % of barrier_1 stand in stage.window"));
}

TEST_CASE("A barrier of any shape comes from a mesh alone, through the reader that the program hands in", "[barrier]") {
    MeshSampling asked;
    std::string asked_file;
    const MeshReader reader = [&](const std::filesystem::path& file, const MeshSampling& sampling) {
        asked = sampling, asked_file = file.string();
        const auto field = std::make_shared<DistanceField>();
        return MeshField{field, Vec3(1020, 2040, 90) + sampling.origin, Vec3(1030, 2060, 130) + sampling.origin};
    };
    const auto scene_with = [&](const std::string& keys) {
        const std::string text =
            "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\n"
            "end = 20\n[material.bed]\nlaw = \"voellmy\"\nmu = 0.2\nxi = 500\n[[barrier]]\n" +
            keys;
        return build_scene(CaseFile::parse(text, "slide/case.toml"), walled_gis(), reader);
    };
    const std::string at_stage = "mesh = \"wall.stl\"\n" + two + west + "cell = 2.0\n";
    REQUIRE(scene_with(at_stage).barriers.size() == 1);
    CHECK(scene_with(at_stage).barriers[0].shape != nullptr);
    CHECK(asked_file == "slide/wall.stl");
    CHECK(asked.spacing == 1.0);
    CHECK(asked.margin >= 3.0 * std::sqrt(3.0) * 2.0);
    CHECK(asked.origin.isZero(0.0));
    scene_with("mesh = \"wall.stl\"\norigin = [5, 6, 7]\n");
    CHECK(asked.spacing == 2.5);  // half a cell of the particles
    CHECK(asked.origin == Vec3(5, 6, 7));

    const auto problem = [&](const std::string& keys) { return only_problem([&] { scene_with(keys); }); };
    CHECK(has(problem("mesh = \"wall.stl\"\nheight = 4\n"),
              "barrier.0.height: found together with mesh; expected the mesh alone"));
    CHECK(has(problem("mesh = \"wall.stl\"\norigin = [5000, 0, 0]\n"),
              "barrier.0.mesh: found no point of it on the terrain"));
    CHECK(has(problem("mesh = \"wall.stl\"\norigin = [0, 0, -200]\n"),
              "barrier.0.mesh: found it from -110 to -70 m, the ground there from"));
    CHECK(has(problem("mesh = \"wall.stl\"\norigin = [0, 0, 200]\n"), "expected a barrier that stands on the ground"));
    CHECK(has(problem("outline = \"wall.geojson\"\nheight = 4\norigin = [5, 6, 7]\n"),
              "barrier.0.origin: found without mesh"));
    CHECK(has(problem_of("[[barrier]]\nmesh = \"wall.stl\"\n"), "barrier.0.mesh: found a mesh"));
}

// Half a metre of flow in a room of a cell below a deck pressed it with 7 MN.
TEST_CASE("A mesh whose foot hangs over the ground is told with the room below it", "[barrier]") {
    const auto box = [](double z) { return verify::box_as_mesh({1020, 2040, z}, {1030, 2060, z + 10}, 2.0); };
    Raster ground = sampled({21, 21, 1000, 2000, 5}, [](double, double) { return 100.0; });
    const auto gap = [&](double z) { return gap_below(box(z), ground, 0.04, 6.0); };
    CHECK(gap(98).share == 0.0);
    CHECK(gap(100).share == 0.0);
    CHECK(gap(101).share == 1.0);
    CHECK(gap(101).height == Approx(1.0).epsilon(0.05));    // distances are linear between samples a cell apart
    CHECK(gap(107).share == 0.0);                           // a bridge
    for (Index j = 0; j < 21; ++j) ground.at(5, j) = 98.0;  // x = 1025, the middle
    CHECK(gap(100).height == Approx(2.0).epsilon(0.05));
    CHECK((gap(100).share > 0.5 && gap(100).share <= 1.0));

    const auto told = [&](double above) {
        constexpr double high = 115.0;  // of the slope below it, which begins at 110 m
        const MeshReader reader = [&](const std::filesystem::path&, const MeshSampling&) {
            const double z = high + above;
            return MeshField{std::make_shared<DistanceField>(box(z)), Vec3(1020, 2040, z), Vec3(1030, 2060, z + 10)};
        };
        return build_scene(
                   case_of(two + "window = [1000, 2000, 1060, 2100]\ncell = 2.0\n[[barrier]]\nmesh = \"wall.stl\"\n"),
                   walled_gis(), reader)
            .log;
    };
    const auto found = [](const std::vector<std::string>& log) {
        return std::count_if(log.begin(), log.end(),
                             [](const std::string& line) { return has(line, "above the ground over"); });
    };
    CHECK(found(told(0.5)) == 1);
    CHECK(found(told(-9.0)) == 0);
}
