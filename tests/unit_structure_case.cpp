// [material.structure]: from the case file to the scene, and what is refused before the first step.
#include "base/error.h"
#include "catch.h"
#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

FakeGis gis() {
    FakeGis files = slope_gis();
    files.rasters["holed.tif"] = files.rasters["dem.tif"];
    files.rasters["holed.tif"].at(3, 3) = Raster::nodata;
    files.polygons["wall.geojson"] = rectangle(1030, 2040, 1035, 2090);
    Polygons turned = files.polygons["wall.geojson"];
    turned.parts.front().rings.front().front().x() -= 2.0;
    files.polygons["askew.geojson"] = turned;
    return files;
}

const std::string structure =
    "[material.structure]\nlaw = \"drucker_prager\"\ncohesion = 2e4\nfriction_angle_deg = 30\nyoung_modulus = 1e8\n";

Scene scene_of(const std::string& rest, const std::string& terrain = "") {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n" + terrain +
                                           "[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\n"
                                           "end = 20\n" +
                                           rest,
                                       "slide/case.toml"),
                       gis());
}

std::string problem_of_structure(const std::string& rest, const std::string& terrain = "") {
    return only_problem([&] { scene_of(rest, terrain); });
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("A structure's keys reach the scene", "[structured]") {
    CHECK_FALSE(scene_of("").structure.has_value());
    const Structure plain = scene_of(structure).structure.value();
    CHECK(plain.cohesion == 2e4);
    CHECK(plain.share == 1.0);
    CHECK(plain.material.friction == Approx(std::acos(-1.0) / 6.0).epsilon(1e-15));
    CHECK(plain.material.poisson == 0.3);
    CHECK(plain.material.critical_strain == 0.1);
    CHECK(StructuredMaterial{}.critical_strain == 0.1);  // one default, whoever asks for it
    CHECK(StructuredMaterial{}.poisson == 0.3);
    CHECK(plain.material.yield == StructuredYield::compression);
    CHECK(plain.material.damage_by == DamageBy::dilation);
    CHECK_FALSE(plain.unrolled);
    CHECK_FALSE(plain.hydrostatic);
    // Cells of 5 m: half the strain of cells of 2.5 m opens a crack by the same way.
    const Structure other = scene_of(structure +
                                         "cone = \"plane_strain\"\nbulk_modulus = 1e8\nfraction = 0.8\n"
                                         "earth_pressure = \"hydrostatic\"\n"
                                         "dilatancy_angle_deg = 10\ndamage = \"strain\"\nonset = 0.02\n"
                                         "critical_strain = 0.08\ncritical_length = 2.5\ncfl = 0.3\n",
                                     "unrolled = true\n")
                                .structure.value();
    CHECK(other.hydrostatic);
    CHECK(other.material.critical_strain == Approx(0.04).epsilon(1e-15));
    CHECK(other.material.poisson == Approx((3e8 - 1e8) / 6e8).epsilon(1e-15));
    CHECK(other.material.yield == StructuredYield::plane_strain);
    CHECK(other.material.damage_by == DamageBy::strain);
    CHECK(other.material.onset == 0.02);
    CHECK(other.share == 0.8);
    CHECK(other.cfl == 0.3);
    CHECK(other.unrolled);
    std::string hexagon = structure;
    hexagon.replace(hexagon.find("drucker_prager"), 14, "mohr_coulomb");
    CHECK(scene_of(hexagon).structure->material.yield == StructuredYield::hexagon);
}

TEST_CASE("Water with a structure reaches the scene, and what does not fit it is refused", "[structured][mixture]") {
    const std::string density = "[material]\ndensity = 1900.0\n", free = "[water]\nmodel = \"free\"\n";
    CHECK_FALSE(scene_of(structure).water.has_value());
    const WaterPhase water = scene_of(density + structure + "confined_water = 0.25\n" + free +
                                      "share = 0.3\nlevel = 12\nrain = 1e-5\nfriction = \"manning\"\nmanning_n = 0.04\n"
                                      "drag_power = 1\ndrag = \"unsplit\"\nvirtual_mass = \"bounded\"\n")
                                 .water.value();
    CHECK(water.share == 0.3);
    CHECK(water.level.value() == 12.0);
    CHECK((water.rain.values.size() == 1200 && water.rain.values[7] == 1e-5));
    CHECK(water.infiltration.values.empty());
    CHECK(water.friction.law == WaterFriction::Law::manning);
    CHECK(water.friction.coefficient == 0.04);
    CHECK(water.exchange.material.power == 1);
    CHECK_FALSE(water.exchange.material.split);
    CHECK(scene_of(density + structure + free).water->exchange.material.split);
    CHECK(water.exchange.virtual_mass == VirtualMass::bounded);
    CHECK(water.exchange.void_ratio == 0.67);
    CHECK(WaterExchange{}.void_ratio == 0.67);  // one default, whoever asks for it
    CHECK(water.exchange.material.solid_density == Approx((1900.0 - 250.0) / 0.75).epsilon(1e-15));
    CHECK(
        has(problem_of_structure(density + free),
            "found 1900 with water.model = \"free\" and without material.structure; expected none: what is released"));
    CHECK(has(problem_of_structure(density + structure + "confined_water = 0.2\n"), "found 0.2 without free water"));
    CHECK(has(problem_of_structure("[material]\ndensity = 1000.0\n" + structure + free),
              "expected grains denser than water.density = 1000"));
    CHECK(has(problem_of_structure(structure + free),
              "material.density: not given with water.model = \"free\"; expected the density of grains with their "
              "confined water"));
    CHECK(has(problem_of_structure(density + structure + free + "share = 1.0\n"), "water.share: found 1"));
    CHECK(
        has(problem_of_structure(density + structure + "confined_water = 1.5\n" + free), "confined_water: found 1.5"));
    CHECK(has(problem_of_structure(density + structure + free, "unrolled = true\n"), "where water finds its level"));
    CHECK(
        has(problem_of_structure(density + structure + free + "[[barrier]]\noutline = \"wall.geojson\"\nheight = 3\n"),
            "found a barrier with water.model"));
    CHECK(has(problem_of_structure(density + structure + "fraction = 0.0\nconfined_water = 0.2\n" + free),
              "found 0.2 with fraction = 0"));
}

TEST_CASE("A kind's density is that of what flows, and with water the grains' own is required",
          "[structured][mixture]") {
    const std::string kind = "[case]\nkind = \"debris_flow\"\n", free = "[water]\nmodel = \"free\"\n";
    CHECK(has(problem_of_structure(kind + structure + free), "material.density: not given with water.model"));
    const auto ranges = [&](const std::string& rest) {
        const Scene scene = scene_of(kind + "[material]\ndensity = 2650.0\n" + structure + rest);
        return std::count_if(scene.log.begin(), scene.log.end(), [](const std::string& line) {
            return has(line, "material.density: ") && has(line, "for debris_flow");
        });
    };
    CHECK(ranges("") == 1);
    CHECK(ranges(free) == 0);
}

TEST_CASE("The resolved case of a structure leaves out keys without use, and can be read again", "[structured]") {
    const std::string rest =
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
        "[time]\nend = 20\n";
    const std::string resolved = resolved_toml(CaseFile::parse(rest + structure, "slide/case.toml"));
    CHECK_FALSE(has(resolved, "stress_cap"));
    CHECK(has(resolved, "filter = 1"));
    CHECK_NOTHROW(CaseFile::parse(resolved, "slide/resolved.toml"));
    CHECK(has(resolved_toml(CaseFile::parse(rest, "slide/case.toml")), "stress_cap = 0.25"));
}

TEST_CASE("What does not fit a structure is refused in one sentence", "[structured]") {
    CHECK(has(problem_of_structure("[material.structure]\ncohesion = 2e4\n"),
              "material.structure.cohesion: found, but material.structure.law = \"none\" does not use it"));
    CHECK(has(problem_of_structure(structure + "fraction = 1.2\n"), "material.structure.fraction: found 1.2"));
    CHECK(has(problem_of_structure(structure + "fraction = -0.1\n"), "material.structure.fraction: found -0.1"));
    CHECK(
        has(problem_of_structure(structure + "poisson_ratio = 0.5\n"), "material.structure.poisson_ratio: found 0.5"));
    CHECK(has(problem_of_structure(structure + "poisson_ratio = 0\n"), "material.structure.poisson_ratio: found 0"));
    CHECK(has(problem_of_structure(structure + "bulk_modulus = 1e7\n"), "which no solid can have"));
    CHECK(has(problem_of_structure(structure + "bulk_modulus = 3e7\n"), "a negative Poisson ratio"));
    CHECK(has(problem_of_structure(structure + "dilatancy_angle_deg = 31\n"),
              "expected at most friction_angle_deg = 30"));
    const auto steep = [](const char* angle) {
        return "[material.structure]\nlaw = \"drucker_prager\"\ncohesion = 2e4\nyoung_modulus = "
               "1e8\nfriction_angle_deg = " +
               std::string(angle) + "\n";
    };
    CHECK(has(
        problem_of_structure(steep("60.5")),
        "material.structure.friction_angle_deg: found 60.5; expected at most 60 with earth_pressure = \"rankine\""));
    CHECK(scene_of(steep("60")).structure.has_value());
    CHECK(scene_of(steep("75") + "earth_pressure = \"hydrostatic\"\n").structure.has_value());
    CHECK(has(problem_of_structure(structure + "onset = 0.1\n"), "material.structure.onset: found, but"));
    CHECK(has(problem_of_structure(structure + "[material.rheology]\nlaw = \"newtonian\"\nviscosity = 1\n"),
              "material.rheology.law: found \"newtonian\" with material.structure.law"));
    CHECK(
        has(problem_of_structure(structure, "curvature = \"inertia\"\n"), "terrain.curvature: found \"inertia\" with"));
    CHECK(has(problem_of_structure(structure, "unrolled = true\ncurvature = \"full\"\n"),
              "terrain.unrolled: found true with terrain.curvature = \"full\""));
    CHECK(scene_of(structure).curvature == Curvature::full);
    CHECK(has(problem_of_structure(structure + "[boundary]\nsides = \"mirror\"\n"),
              "boundary.sides: found \"mirror\" beside material.structure"));
    CHECK(scene_of(structure, "unrolled = true\n").curvature == Curvature::none);
    CHECK(has(problem_of_structure(structure + "[scheme]\nshape = \"cubic\"\n"), "scheme.shape: found \"cubic\" with"));
    CHECK(has(problem_of_structure("", "unrolled = true\n"), "terrain.unrolled: found true"));
    CHECK(has(problem_of_structure(structure + "[[stage]]\nmodel = \"mpm3d\"\n"), "found a stage with"));
    CHECK(has(problem_of_structure(structure + "[[barrier]]\noutline = \"askew.geojson\"\nheight = 3\n"),
              "expected an outline that is one rectangle along x and y"));
    CHECK(scene_of(structure + "[[barrier]]\noutline = \"wall.geojson\"\nheight = 3\n").barriers.size() == 1);
    const auto holed = [](const std::string& rest) {
        return build_scene(
            CaseFile::parse("[terrain]\ndem = \"holed.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
                            "[time]\nend = 20\n" +
                                structure + rest,
                            "slide/case.toml"),
            gis());
    };
    CHECK(has(
        only_problem([&] { holed(""); }),
        "boundary.holes: found \"wall\" beside material.structure with 1 node without elevation inside the terrain"));
    CHECK_FALSE(holed("[boundary]\nholes = \"open\"\n").hole_top.has_value());
    CHECK(has(problem_of_structure("[[insitu]]\nname = \"a\"\nkind = \"figure\"\nfield = \"damage\"\n"),
              "in a case without structure"));
}

TEST_CASE("A barrier's box that is widened, or that a release lies in, is told", "[structured][barriers]") {
    const auto said = [&](const std::string& outline, double height) {
        std::string all;
        FakeGis files = gis();
        files.polygons["thick.geojson"] = rectangle(1030, 2040, 1045, 2090);
        files.polygons["within.geojson"] = files.polygons["release.geojson"];
        const Scene scene = build_scene(
            CaseFile::parse(
                "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\n"
                "end = 20\n" +
                    structure + "[[barrier]]\noutline = \"" + outline + "\"\nheight = " + std::to_string(height) + "\n",
                "slide/case.toml"),
            files);
        for (const std::string& remark : scene.log) all += remark + "\n";
        return all;
    };
    const std::string thin = said("wall.geojson", 8.0);
    CHECK(has(thin,
              "barriers: found 1 of 1 thinner than 3 cells of 5 m, the thinnest \"barrier_1\" with 5 m; structured "
              "particles would go through those, and meet boxes 15 m wide about their middles"));
    CHECK_FALSE(has(thin, "stands on the cells that it cuts"));
    CHECK_FALSE(has(said("thick.geojson", 8.0), "thinner than 3 cells"));
    CHECK(has(said("within.geojson", 8.0), "m3 of releases within it"));
    CHECK_FALSE(has(thin, "of releases within it"));
}
