// [water] of a case: rates as rasters, and what is wrong with them; viscosity; what makes grains settle.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "coupling/structured_run.h"
#include "scene/build_scene.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

const std::string solids =
    "[material]\ndensity = 2650.0\n[material.structure]\nlaw = \"drucker_prager\"\ncohesion = 0\n"
    "fraction = 0\nfriction_angle_deg = 30\nyoung_modulus = 1e6\n[water]\nmodel = \"free\"\n";

double rate(double x, double y) { return 1e-5 * (1.0 + 0.01 * (x - 1000.0) + 0.02 * (y - 2000.0)); }

Scene scene_of(const FakeGis& gis, const std::string& water) {
    return build_scene(
        CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n"
                        "[time]\nend = 20\n" +
                            solids + water,
                        "slide/case.toml"),
        gis);
}

std::string problem_of(const FakeGis& gis, const std::string& water) {
    return only_problem([&] { scene_of(gis, water); });
}

/// The slope with a raster of rates of its size, one value of which is another.
FakeGis with_rates(double odd) {
    FakeGis gis = slope_gis();
    gis.rasters["rain.tif"] = sampled(gis.rasters["dem.tif"].geometry, rate);
    gis.rasters["rain.tif"].at(7, 5) = odd;
    return gis;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("Rain and infiltration are numbers or rasters on the terrain's nodes", "[water][scene]") {
    const FakeGis gis = with_rates(0.0);
    const WaterPhase water = scene_of(gis, "rain = \"rain.tif\"\ninfiltration = 2e-6\n").water.value();
    REQUIRE(water.rain.geometry == gis.rasters.at("dem.tif").geometry);
    CHECK(water.rain.at(7, 5) == 0.0);
    CHECK(water.rain.at(8, 5) == rate(1042.5, 2027.5));
    CHECK((water.infiltration.at(0, 0) == 2e-6 && water.infiltration.at(39, 29) == 2e-6));
    FakeGis dry = gis;
    for (double& one : dry.rasters["rain.tif"].values) one = 0.0;
    CHECK(scene_of(dry, "rain = \"rain.tif\"\n").water->rain.values.empty());
    CHECK(scene_of(dry, "").water->rain.values.empty());
}

TEST_CASE("A raster of rates that does not fit is refused in one sentence", "[water][scene]") {
    const std::string rain = "rain = \"rain.tif\"\n";
    CHECK(has(problem_of(with_rates(-1e-6), rain),
              "rain.tif: found 1 of 1200 pixels such as -1e-06, the first at x 1037.5, y 2027.5; expected rates in "
              "m/s, 0 or more"));
    CHECK(has(problem_of(with_rates(NAN), rain),
              "found 1 of 1200 pixels without a number, the first at x 1037.5, y 2027.5"));
    CHECK(has(problem_of(with_rates(INFINITY), rain), "found 1 of 1200 pixels such as inf"));
    FakeGis part = slope_gis();
    part.rasters["rain.tif"] = sampled({30, 30, 1002.5, 2002.5, 5.0}, rate);
    const std::string said = problem_of(part, "infiltration = \"rain.tif\"\n");
    CHECK(has(said, "water.infiltration: "));
    CHECK(has(said,
              "rain.tif: found 300 of 1200 nodes of the terrain without a number, the first at x 1152.5, y 2002.5; "
              "expected a raster that covers all of the terrain"));
    CHECK(has(problem_of(slope_gis(), rain), "no such raster"));
    CHECK(has(problem_of(slope_gis(), "rain = -1\n"), "water.rain: found -1"));
}

TEST_CASE("A run in the rain of a raster records what it brings and what the ground takes", "[water][mixture]") {
    Scene scene = scene_on(41, 31, 0.5, [](double x, double y) { return 0.2 * std::sin(x) * std::cos(y); });
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 4 && x < 9 && y > 5 && y < 10 ? 0.5 : 0.0; });
    scene.density = 1900.0;
    scene.structure = Structure{};
    scene.structure->material.young = 1e6;
    scene.water = WaterPhase{};
    scene.water->rain = Raster::filled(scene.bed.geometry, 0.0);
    scene.water->infiltration = scene.water->rain;
    double total = 0.0;
    for (Index j = 0; j < 31; ++j)
        for (Index i = 10; i < 41; ++i) {
            total += scene.water->rain.at(i, j) = 1e-3 * (1.0 + 0.1 * static_cast<double>(i));
            scene.water->infiltration.at(i, j) = i < 20 ? 1e-1 : 1e-5 * static_cast<double>(j);
        }
    StructuredRun run(scene);
    const double end = 2.0;
    while (run.status().time < end) run.advance(end);
    const WaterLedger& l = run.water()->status().ledger;
    CHECK(l.rained == Approx(total * 0.25 * end).epsilon(1e-13));
    CHECK(l.infiltrated > 0.01 * l.rained);
    CHECK(std::abs(run.water()->volume_residual()) < 1e-13 * l.rained);
    for (Index j = 0; j < 31; ++j)  // where the ground takes more than falls nothing stays
        CHECK(run.water()->at(12, j).depth < 1e-3);
}

namespace {

std::string said_of(const std::string& water) {
    std::string said;
    for (const std::string& line : scene_of(slope_gis(), water).log) said += line + "\n";
    return said;
}

}  // namespace

TEST_CASE("A lake's size, or that there is none, and rain that no cloud has are remarked upon", "[water][scene]") {
    const Raster bed = slope_gis().rasters.at("dem.tif");
    const double low = *std::min_element(bed.values.begin(), bed.values.end());
    const std::string none = said_of(fmt::format("level = {}\n", low - 1.0));
    CHECK(has(none, "which floods nothing; expected a level above the lowest ground"));
    double volume = 0.0, area = 0.0;
    for (const double z : bed.values)
        if (z < low + 5.0) volume += 25.0 * (low + 5.0 - z), area += 25.0;
    const std::string level = fmt::format("level = {}\n", low + 5.0);
    CHECK(has(said_of(level),
              fmt::format("floods {:.4g} m2 of the ground with {:.4g} m3, 5 m deep at most", area, volume)));
    CHECK(has(said_of(level), "it meets open sides over "));
    CHECK_FALSE(has(said_of(level + "[boundary]\nsides = \"wall\"\n"), "it meets open sides"));
    CHECK(has(said_of("rain = 30\n"), "water.rain: found up to 30 m/s; expected 0.0001 m/s at most"));
    CHECK_FALSE(has(said_of("rain = 1e-4\n"), "mm/h"));
}

TEST_CASE("Viscosity that no run gets to the end with is refused", "[water][scene]") {
    const std::string mud = "viscous = \"mud\"\nmud_alpha = 1e-3\nmud_concentration = 0.9\nmud_beta = ";
    CHECK(has(problem_of(slope_gis(), mud + "100\n"), "expected 1e+09 steps at most; check mud_alpha"));
    CHECK_NOTHROW(scene_of(slope_gis(), mud + "10\n"));
    CHECK(viscous_step({2.0, 3.0, false, 0.0}, 4.0) == Approx(0.075 * 16.0 / 2.0).epsilon(1e-15));
}

TEST_CASE("Viscosity of the water is off by default; mud is thicker than clear water", "[water][scene]") {
    const auto water = [](const std::string& more) { return scene_of(slope_gis(), more).water.value(); };
    CHECK(water("").viscosity.kinematic == 0.0);
    CHECK(water("").exchange.material.viscosity == 1e-3);
    const WaterPhase clear = water("viscous = \"clear\"\nviscosity = 2e-3\nbed_shear = 2.5\n");
    CHECK(clear.viscosity.kinematic == 2e-6);
    CHECK(clear.viscosity.shear == 2.5);
    CHECK(clear.exchange.material.viscosity == 2e-3);
    const std::string mud =
        "viscous = \"mud\"\nmud_alpha = 3e-3\nmud_beta = 20\nmud_concentration = 0.3\ndensity = 1300\n";
    const WaterPhase thick = water(mud);
    CHECK(thick.exchange.material.viscosity == Approx(3e-3 * std::exp(6.0)).epsilon(1e-15));
    CHECK(thick.viscosity.kinematic == Approx(3e-3 * std::exp(6.0) / 1300.0).epsilon(1e-15));
    CHECK(water("viscous = \"mud\"\nmud_alpha = 1e-9\nmud_beta = 6\nmud_concentration = 0.1\n").viscosity.kinematic ==
          1e-6);
    std::string said;
    for (const std::string& line : scene_of(slope_gis(), mud).log) said += line;
    CHECK(has(said, "its viscosity is 1.21029 Pa s (where tables have poise: 1 poise is 0.1 Pa s)"));
    CHECK(has(problem_of(slope_gis(), "mud_alpha = 1e-3\n"),
              "water.mud_alpha: found, but water.viscous = \"none\" does not use it"));
    CHECK(
        has(problem_of(slope_gis(), "viscous = \"mud\"\nmud_alpha = 1e-3\nmud_beta = 6\n"), "water.mud_concentration"));
}

TEST_CASE("V19: grains settle in the viscosity of the mud, and its drag on them follows", "[water][two_phase]") {
    const auto material = [](const std::string& more) {
        return scene_of(slope_gis(), "grain_diameter = 1e-3\ndrag_power = 1\n" + more).water->exchange.material;
    };
    const TwoPhaseMaterial clear = material(""),
                           mud = material(
                               "viscous = \"mud\"\nmud_alpha = 2e-2\nmud_beta = 10\nmud_concentration = 0.2\n");
    const double eta = 2e-2 * std::exp(2.0);
    CHECK(terminal_velocity(clear, clear.grain) == Approx(0.1176).epsilon(1e-3));
    // So slow a grain is within a tenth of 0.9 of Stokes's, g d^2 (rho_s - rho_f) / (18 eta).
    CHECK(terminal_velocity(mud, mud.grain) == Approx(0.9 * 1650.0 * 9.81 * 1e-6 / (18.0 * eta)).epsilon(0.02));
    // Where next to all is water, drag is the grains' weight in it over their speed.
    const double solids_share = 1e-4;
    const auto speed = [&](const TwoPhaseMaterial& m) {
        return solids_share * (1.0 - solids_share) * 1650.0 * 9.81 / TwoPhaseDrag(m).unsplit(solids_share, 0.0);
    };
    const auto still =
        [&](const TwoPhaseMaterial& m) {  // a power of the share of water, for each Reynolds number its own
            const double u = terminal_velocity(m, m.grain);
            return u * std::pow(1.0 - solids_share, richardson_zaki(1000.0 * m.grain * u / m.viscosity) - 1.0);
        };
    TwoPhaseMaterial sharp_clear = clear, sharp_mud = mud;
    sharp_clear.weighting = sharp_mud.weighting = 50.0;  // of the solid-like part next to nothing is left
    CHECK(speed(sharp_clear) == Approx(still(clear)).epsilon(1e-9));
    CHECK(speed(sharp_mud) == Approx(still(mud)).epsilon(1e-9));
}
