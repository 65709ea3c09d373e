// The table of plausible values: orders and units, what describe and check make of it, and the page of the manual.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "scene/build_scene.h"
#include "scene/mud_table.h"
#include "scene/parameter_ranges.h"
#include "scene/salm_table.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

std::string case_of(const std::string& kind, const std::string& material) {
    return "[case]\nkind = \"" + kind +
           "\"\n[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
           "[material]\n" +
           material;
}

/// The remarks on a case that name the manual's page.
std::vector<std::string> remarks(const std::string& kind, const std::string& material) {
    std::vector<std::string> found;
    for (const std::string& line : build_scene(CaseFile::parse(case_of(kind, material), "case.toml"), slope_gis()).log)
        if (line.find("cases/PARAMETERS.md") != std::string::npos) found.push_back(line);
    return found;
}

const ParameterRange& row_of(const std::string& key, const std::string& what) {
    const auto& rows = parameter_ranges();
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const ParameterRange& r) {
        return r.key == key && std::string(r.what).find(what) != std::string::npos;
    });
    REQUIRE(row != rows.end());
    return *row;
}

}  // namespace

TEST_CASE("Plausible values lie in order, within what their key allows, and name a year or a source", "[parameters]") {
    const Parameter* kind = find_parameter("case.kind");
    REQUIRE(kind);
    for (const ParameterRange& row : parameter_ranges()) {
        CAPTURE(row.kind, row.key, row.what);
        const Parameter* parameter = find_parameter(row.key);
        REQUIRE(parameter);
        CHECK(row.low > 0.0);
        CHECK(row.low <= row.high);
        CHECK(parameter->range.holds(row.low));
        CHECK(parameter->range.holds(row.high));
        const bool known = !*row.kind || row.kind == std::string(kFreeWater) ||
                           std::count(kind->choices.begin(), kind->choices.end(), row.kind) == 1;
        CHECK(known);
        const std::string source = row.source;
        const bool year = std::any_of(source.begin(), source.end(), [](char c) { return std::isdigit(c); });
        CHECK((source.empty() || year || source.find("github") != std::string::npos ||
               source.find("Avaframe-Workshop") != std::string::npos));
        if (*row.law)
            CHECK(std::count(find_parameter("material.bed.law")->choices.begin(),
                             find_parameter("material.bed.law")->choices.end(), row.law) == 1);
    }
}

TEST_CASE("Units of plausible values are those of their keys: mu without, xi in m/s2, strengths in Pa",
          "[parameters]") {
    // A unit that is not SI is off by ten or more: k = g/xi for xi, dyn/cm2 and poise for mud, t/m3 for densities.
    for (const ParameterRange& row : parameter_ranges()) {
        CAPTURE(row.kind, row.key, row.what);
        const std::string key = row.key;
        const auto within = [&](double low, double high) { CHECK((row.low >= low && row.high <= high)); };
        if (key == "material.bed.mu") within(0.02, 1.0);
        if (key == "material.bed.xi") within(100.0, 10000.0);
        if (key == "material.density") within(100.0, 3000.0);
        if (key == "material.bed.manning_n") within(0.01, 0.3);
    }
    CHECK(find_parameter("material.bed.xi")->unit == "m/s^2");
    CHECK(find_parameter("material.rheology.yield_stress")->unit == "Pa");
    CHECK(find_parameter("material.rheology.viscosity")->unit == "Pa s");
    CHECK(find_parameter("material.density")->unit == "kg/m^3");
}

TEST_CASE("Every kind has a range of densities with its default in the middle", "[parameters]") {
    const std::vector<std::string>& choices = find_parameter("case.kind")->choices;
    REQUIRE(choices == std::vector<std::string>{"snow", "debris_flow", "rock_avalanche", "mud"});
    for (const MassKind& kind : mass_kinds()) {
        CAPTURE(kind.name);
        const auto range = plausible(kind.name, "material.density", "");
        REQUIRE(range);
        CHECK(kind.density == 0.5 * (range->low + range->high));
    }
}

TEST_CASE("Rows that sum up a table have its lowest and highest values", "[parameters]") {
    double low = 1e9, high = 0.0, least = 1e9, most = 0.0;
    for (std::size_t size = 0; size < 4; ++size)
        for (std::size_t ground = 0; ground < 4; ++ground)
            for (std::size_t altitude = 0; altitude < 3; ++altitude) {
                least = std::min(least, salm::xi[size][ground][altitude]);
                most = std::max(most, salm::xi[size][ground][altitude]);
                for (std::size_t period = 0; period < 4; ++period) {
                    low = std::min(low, salm::mu[size][period][ground][altitude]);
                    high = std::max(high, salm::mu[size][period][ground][altitude]);
                }
            }
    CHECK((row_of("material.bed.mu", "all sizes").low == low && row_of("material.bed.mu", "all sizes").high == high));
    CHECK((row_of("material.bed.xi", "all sizes").low == least && row_of("material.bed.xi", "all sizes").high == most));
    double weakest = 1e9, strongest = 0.0, thinnest = 1e9, thickest = 0.0;
    for (const mud::Sample& s : mud::samples)
        for (const double share : {0.3, 0.4}) {
            weakest = std::min(weakest, s.a1 * std::exp(s.b1 * share));
            strongest = std::max(strongest, s.a1 * std::exp(s.b1 * share));
            thinnest = std::min(thinnest, s.a2 * std::exp(s.b2 * share));
            thickest = std::max(thickest, s.a2 * std::exp(s.b2 * share));
        }
    const ParameterRange& strength = row_of("material.rheology.yield_stress", "13 samples");
    const ParameterRange& thickness = row_of("material.rheology.viscosity", "13 samples");
    // The rows are rounded to two or three digits.
    CHECK(strength.low == Approx(weakest).epsilon(0.02));
    CHECK(strength.high == Approx(strongest).epsilon(0.02));
    CHECK(thickness.low == Approx(thinnest).epsilon(0.02));
    CHECK(thickness.high == Approx(thickest).epsilon(0.02));
}

TEST_CASE("describe ends with ranges and their sources, angles in degrees", "[parameters][describe]") {
    const std::string xi = describe("material.bed.xi");
    CHECK(xi.find("    snow with voellmy: 900 to 4000 m/s^2, all sizes, grounds and altitudes; Voellmy-Salm") !=
          std::string::npos);
    CHECK(xi.find("    debris_flow with voellmy: 100 to 1000 m/s^2, ") != std::string::npos);
    CHECK(xi.find("; a common range\n") != std::string::npos);
    const std::string last = "    where to begin, never a truth: see cases/PARAMETERS.md\n";
    CHECK(xi.substr(xi.size() - last.size()) == last);
    for (const char* key : {"material.bed.mu", "material.bed.manning_n", "material.bed.yield_stress",
                            "material.rheology.viscosity", "material.density"})
        CHECK(describe(key).find(last) != std::string::npos);
    CHECK(describe("material.bed.friction_angle_deg").find("rock_avalanche with coulomb: 14.04 to 30.11 degree") !=
          std::string::npos);
    CHECK(describe("grid.cell").find("PARAMETERS") == std::string::npos);
}

TEST_CASE("cases/PARAMETERS.md is what describe --parameters writes", "[parameters][describe]") {
    std::ifstream file(FRANA_SOURCE_DIR "/cases/PARAMETERS.md");
    std::stringstream page;
    page << file.rdbuf();
    INFO("frana describe --parameters > cases/PARAMETERS.md");
    CHECK(page.str() == ranges_in_markdown());
}

TEST_CASE("A kind of mass has a density by default, which is said; friction has none", "[parameters][scene]") {
    const auto density = [](const std::string& text) {
        return build_scene(CaseFile::parse(text, "case.toml"), slope_gis()).density;
    };
    CHECK(density(case_of("snow", "")) == 300.0);
    CHECK(density(case_of("mud", "")) == 1600.0);
    CHECK(density(case_of("snow", "density = 250\n")) == 250.0);
    const Scene scene = build_scene(CaseFile::parse(case_of("debris_flow", ""), "case.toml"), slope_gis());
    CHECK(std::count(scene.log.begin(), scene.log.end(),
                     "case.toml:10: material.density: not given, so it is 1900 kg/m3 (case.kind = \"debris_flow\"); "
                     "expected the density of the mass; give it") == 1);
    CHECK_THROWS_WITH(CaseFile::parse(case_of("snow", "bed.law = \"voellmy\"\nbed.xi = 2000\n"), "case.toml"),
                      Catch::Contains("friction_angle_deg: not given"));
    CHECK_THROWS_WITH(CaseFile::parse(case_of("ice", ""), "case.toml"), Catch::Contains("rock_avalanche"));
}

TEST_CASE("Values outside of the kind's ranges are remarked upon, at the limits they are not", "[parameters][scene]") {
    const std::string voellmy = "density = 300\nbed.law = \"voellmy\"\n";
    CHECK(remarks("snow", voellmy + "bed.mu = 0.14\nbed.xi = 4000\n").empty());
    CHECK(remarks("snow", voellmy + "bed.mu = 0.47\nbed.xi = 700\n").empty());
    const auto low = remarks("snow", voellmy + "bed.mu = 0.13\nbed.xi = 699\n");
    REQUIRE(low.size() == 2);
    CHECK(low[0].find("material.bed.mu: found 0.13; expected 0.14 to 0.47 for snow, as in cases/PARAMETERS.md") !=
          std::string::npos);
    CHECK(low[1].find("material.bed.xi: found 699; expected 700 to 4000 m/s^2 for snow") != std::string::npos);
    CHECK(remarks("debris_flow", "density = 300\n").size() == 1);
    CHECK(remarks("mud",
                  "density = 1600\nrheology.law = \"bingham\"\nrheology.viscosity = 50\n"
                  "rheology.yield_stress = 2000\n")
              .size() == 1);
    CHECK(remarks("mud",
                  "density = 1600\nrheology.law = \"bingham\"\nrheology.viscosity = 50\n"
                  "rheology.yield_stress = 200\n")
              .empty());
}

TEST_CASE("What takes up the bed has ranges of its own; a value that stands alone is no limit", "[parameters][scene]") {
    const auto found = [](const std::string& kind, const std::string& erodible) {
        return remarks(
            kind, "density = " + std::string(kind == "snow" ? "300" : "1900") + "\n[erodible]\ndepth = 1\n" + erodible);
    };
    CHECK(found("debris_flow", "law = \"shear\"\nrate = 0.05\nthreshold = 500\ndepth_per_stress = 2e-4\n").empty());
    const auto fast = found("debris_flow", "law = \"shear\"\nrate = 0.5\nthreshold = 1000\n");
    REQUIRE(fast.size() == 1);
    CHECK(fast[0].find("erodible.rate: found 0.5; expected 0.0125 to 0.05 m/s for debris_flow") != std::string::npos);
    CHECK(found("debris_flow", "law = \"growth\"\ngrowth = 1e-3\n").empty());  // its range has no source
    CHECK(found("snow", "law = \"energy\"\nenergy = 9000\n").empty());
    const std::string rate = describe("erodible.rate");
    CHECK(rate.find("debris_flow: 0.0125 to 0.05 m/s, half to twice the published value; Frank et al. 2015") !=
          std::string::npos);
}

TEST_CASE("Ranges go with the bed law, and angles are compared as angles", "[parameters][scene]") {
    const auto rock = [](const std::string& bed) { return remarks("rock_avalanche", "density = 2100\n" + bed); };
    CHECK(rock("bed.law = \"coulomb\"\nbed.friction_angle_deg = 20\n").empty());
    CHECK(rock("bed.law = \"voellmy\"\nbed.friction_angle_deg = 20\nbed.xi = 500\n").size() == 1);  // mu = 0.364
    const auto flat = rock("bed.law = \"coulomb\"\nbed.friction_angle_deg = 10\n");
    REQUIRE(flat.size() == 1);
    CHECK(flat[0].find("found 10; expected 14.04 to 30.11 degree for rock_avalanche") != std::string::npos);
    // No row: nothing is said.
    CHECK(remarks("snow", "density = 300\nbed.law = \"manning\"\nbed.manning_n = 0.9\n").empty());
    const Scene scene = build_scene(
        CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\n"
                        "end = 20\n[material]\ndensity = 300\nbed.law = \"voellmy\"\nbed.mu = 0.9\nbed.xi = 9000\n",
                        "case.toml"),
        slope_gis());
    for (const std::string& line : scene.log) CHECK(line.find("PARAMETERS") == std::string::npos);  // no kind
}

// Nothing was said of them in any range, not of 0.9 nor of a raster.
TEST_CASE("Friction of free water is judged whatever the kind, in zones and rasters too", "[parameters][scene]") {
    const auto found = [](const std::string& water, FakeGis gis, const std::string& rest = "") {
        const std::string text =
            "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
            "[water]\nmodel = \"free\"\n" +
            water + rest;
        std::vector<std::string> said;
        for (const std::string& line : build_scene(CaseFile::parse(text, "case.toml"), gis).log)
            if (line.find("cases/PARAMETERS.md") != std::string::npos) said.push_back(line);
        return said;
    };
    const auto manning = [](const std::string& n) { return "friction = \"manning\"\nmanning_n = " + n + "\n"; };
    const auto darcy = [](const std::string& f) { return "friction = \"darcy_weisbach\"\ndarcy_f = " + f + "\n"; };
    for (const char* fit : {"0.01", "0.03", "0.8"}) CHECK(found(manning(fit), slope_gis()).empty());
    for (const char* fit : {"0.02", "1.0", "100"}) CHECK(found(darcy(fit), slope_gis()).empty());
    const auto rough = found(manning("0.9"), slope_gis());
    REQUIRE(rough.size() == 1);
    CHECK(rough[0].find("water.manning_n: found 0.9; expected 0.008 to 0.8 s/m^(1/3), as in") != std::string::npos);
    CHECK(found(manning("0.002"), slope_gis()).size() == 1);
    CHECK(found(darcy("0.001"), slope_gis()).size() == 1);
    CHECK(found(darcy("200"), slope_gis()).size() == 1);
    const std::string zone = "[[material.zone]]\noutline = \"release.geojson\"\nwater.manning_n = 0.95\n";
    const auto of_zone = found(manning("0.03"), slope_gis(), zone);
    REQUIRE(of_zone.size() == 1);
    CHECK(of_zone[0].find("found 0.95") != std::string::npos);
    FakeGis gis = slope_gis();
    gis.rasters["n.tif"] =
        sampled(gis.rasters["dem.tif"].geometry, [](double x, double) { return x < 1100.0 ? 0.03 : 0.9; });
    const auto of_raster = found(manning("\"n.tif\""), gis);
    REQUIRE(of_raster.size() == 1);
    CHECK(of_raster[0].find("(the largest of its raster): found 0.9") != std::string::npos);
    const std::string told = describe("water.darcy_f");
    CHECK(told.find("    water: 0.005 to 10, channels, from smooth ones to beds of boulders; a common range\n") !=
          std::string::npos);
}
