// Remarks on cases that run but may not be what was meant: each is made beyond its limit and not within.
#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "catch.h"
#include "fake_gis.h"
#include "scene/build_scene.h"
#include "scene/remarks.h"

using namespace frana;

namespace {

const GridGeometry grid{40, 30, 1002.5, 2002.5, 5.0};

/// A slope that rises to the east by `rise`, from `foot`.
FakeGis slope(double rise, double foot = 100.0) {
    FakeGis gis;
    gis.rasters["dem.tif"] = sampled(grid, [&](double x, double) { return foot + rise * (x - 1000.0); });
    gis.rasters["dem.tif"].source = "dem.tif";
    gis.polygons["release.geojson"] = rectangle(1050, 2050, 1100, 2080);
    return gis;
}

std::string case_of(const std::string& material, const std::string& depth = "2.0", const std::string& rest = "") {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = " + depth +
           "\n[time]\nend = 20\n[material]\n" + material + "\n" + rest;
}

/// The remarks on a case that have the words.
std::vector<std::string> remarks(const std::string& text, const FakeGis& gis, const std::string& words) {
    std::vector<std::string> found;
    for (const std::string& line : build_scene(CaseFile::parse(text, "slide/case.toml"), gis).log)
        if (line.find(words) != std::string::npos) found.push_back(line);
    return found;
}

std::string remark(const std::string& text, const FakeGis& gis, const std::string& words) {
    const std::vector<std::string> found = remarks(text, gis, words);
    REQUIRE(found.size() == 1);
    return found.front();
}

const std::string coulomb = "density = 1500\nbed.law = \"coulomb\"\n";

}  // namespace

TEST_CASE("A density that is missing, or of no mass that slides, is remarked upon", "[scene][remarks]") {
    const auto of = [](const std::string& density) { return case_of(density + "\nbed.law = \"none\""); };
    CHECK(remark(of(""), slope(0.5), "density") ==
          "slide/case.toml:8: material.density: not given, so it is 1000 kg/m3; expected the density of the mass; give "
          "it");
    CHECK(remark(of("density = 1.8"), slope(0.5), "density").find("found 1.8 kg/m3; expected 100 to 4000") !=
          std::string::npos);
    CHECK(remark(of("density = 4001"), slope(0.5), "density").find("found 4001 kg/m3") != std::string::npos);
    for (const char* fit : {"density = 100", "density = 4000"}) CHECK(remarks(of(fit), slope(0.5), "density").empty());
}

TEST_CASE("A density of loose ground or of water in another unit is remarked upon", "[scene][remarks]") {
    const auto loose = [](const std::string& density) {
        return case_of("density = 1500\nbed.law = \"none\"", "2.0",
                       "[erodible]\nlaw = \"shear\"\ndepth = 1.0\ndensity = " + density + "\n");
    };
    CHECK(remark(loose("1.9"), slope(0.5), "erodible.density").find("found 1.9 kg/m3; expected 100 to 4000") !=
          std::string::npos);
    CHECK(remarks(loose("1900"), slope(0.5), "erodible.density").empty());
    const auto wet = [](const std::string& density) {
        return "[terrain]\ndem = \"dem.tif\"\n[time]\nend = 20\n[water]\nmodel = \"free\"\nlevel = 120\ndensity = " +
               density + "\n";
    };
    CHECK(remark(wet("1"), slope(0.5), "water.density").find("found 1 kg/m3") != std::string::npos);
    CHECK(remarks(wet("1030"), slope(0.5), "water.density").empty());
}

TEST_CASE("Friction that no ground has is remarked upon, as an angle", "[scene][remarks]") {
    const auto of = [](const std::string& friction) { return case_of(coulomb + "bed." + friction); };
    CHECK(remark(of("friction_angle_deg = 1.5"), slope(0.5), "friction angle of")
              .find("bed.friction_angle_deg: found a friction angle of 1.5 degrees; expected 2 to 60") !=
          std::string::npos);
    // atan 3 = 71.6 degrees
    CHECK(remark(of("mu = 3"), slope(0.5), "friction angle of").find("71.6 degrees") != std::string::npos);
    for (const char* fit : {"friction_angle_deg = 2", "friction_angle_deg = 60", "mu = 0.4"})
        CHECK(remarks(of(fit), slope(0.5), "friction angle of").empty());
    const auto manning = [](const std::string& mu) {
        return case_of("density = 1500\nbed.law = \"manning\"\nbed.manning_n = 0.05\nbed.mu = " + mu);
    };
    CHECK(remarks(manning("0"), slope(0.5), "friction angle of").empty());  // Manning's term alone
    CHECK(remarks(manning("0.01"), slope(0.5), "friction angle of").size() == 1);
}

TEST_CASE("A turbulence coefficient that is none of Voellmy's is remarked upon", "[scene][remarks]") {
    const auto of = [](const std::string& xi) {
        return case_of("density = 300\nbed.law = \"voellmy\"\nbed.mu = 0.2\nbed.xi = " + xi);
    };
    CHECK(remark(of("19"), slope(0.5), ".xi").find("found 19 m/s^2; expected 20 or more") != std::string::npos);
    CHECK(remarks(of("20"), slope(0.5), ".xi").empty());
}

TEST_CASE("A release on a cliff, or as deep as a valley, is remarked upon", "[scene][remarks]") {
    const std::string plain = case_of(coulomb + "bed.mu = 0.4");
    // atan 1.8 = 60.9 degrees, atan 1.7 = 59.5
    CHECK(remark(plain, slope(1.8), "under it").find("release.0: found a bed of up to 60.9 degrees") !=
          std::string::npos);
    CHECK(remarks(plain, slope(1.7), "under it").empty());
    CHECK(remark(case_of(coulomb + "bed.mu = 0.4", "101"), slope(0.5), "found a depth")
              .find("up to 101 m; expected 100 m at most") != std::string::npos);
    CHECK(remarks(case_of(coulomb + "bed.mu = 0.4", "99"), slope(0.5), "found a depth").empty());
}

TEST_CASE("Fields that no frame of the case has are remarked upon", "[scene][remarks]") {
    const auto of = [](const std::string& fields, const std::string& material = "bed.mu = 0.4") {
        return case_of(coulomb + material, "2.0", "[output]\nfields = [" + fields + "]");
    };
    CHECK(
        remark(of("\"stress\""), slope(0.5), "output.fields").find("material.rheology.law = \"none\" has no stress") !=
        std::string::npos);
    CHECK(remark(of("\"water_depth\", \"depth\""), slope(0.5), "output.fields").find("found \"water_depth\"") !=
          std::string::npos);
    CHECK(remarks(of("\"damage\", \"cohesion\", \"eroded_depth\", \"effective_stress\""), slope(0.5), "output.fields")
              .size() == 4);
    CHECK(remarks(of("\"depth\", \"id\", \"arrival_time\""), slope(0.5), "output.fields").empty());
    const std::string viscous =
        "bed.mu = 0.4\nrheology.law = \"bingham\"\nrheology.viscosity = 5\nrheology.yield_stress = 10";
    CHECK(remarks(of("\"stress\", \"effective_stress\"", viscous), slope(0.5), "output.fields").empty());
}

TEST_CASE("A release without an outline is said to be all of the terrain", "[scene][remarks]") {
    const std::string rest = "[time]\nend = 20\n", head = "[terrain]\ndem = \"dem.tif\"\n[[release]]\n";
    const std::string said = remark(head + "depth = 0.01\n" + rest, slope(0.5), "no outline");
    CHECK(said.find("so that all of the terrain is released: ") != std::string::npos);
    CHECK(said.find(" m2; expected an outline; give one") != std::string::npos);
    FakeGis gis = slope(0.5);
    gis.rasters["depth.tif"] = sampled({20, 20, 1005, 2005, 10}, [](double, double) { return 2.0; });
    CHECK(remarks(head + "depth = \"depth.tif\"\n" + rest, gis, "no outline").empty());
    CHECK(remarks(head + "surface = 150\n" + rest, slope(0.5), "no outline").empty());
    // A raster of classes has no 0 around.
    for (const double least : {0.0, 1.0}) {
        gis.rasters["mask.tif"] =
            sampled({20, 20, 1005, 2005, 10}, [=](double x, double) { return x < 1100 ? 2.0 : least; });
        CHECK(remarks(head + "mask = \"mask.tif\"\ndepth = 0.01\n" + rest, gis, "found a mask above 0 everywhere")
                  .size() == (least > 0.0 ? 1 : 0));
    }
    CHECK(remarks(case_of(coulomb + "bed.mu = 0.4"), slope(0.5), "no outline").empty());
}

TEST_CASE("Friction by raster gets the remarks that a number gets, by its least and its largest value",
          "[scene][remarks]") {
    FakeGis gis = slope(0.5);
    const auto with = [&](const std::string& friction, double low, double high, const std::string& rest = "") {
        gis.rasters["friction.tif"] = sampled(grid, [&](double x, double) { return x < 1100.0 ? low : high; });
        return case_of("density = 1500\nbed.law = \"voellmy\"\n" + friction, "2.0", rest);
    };
    const std::string angle = "bed.friction_angle_deg = \"friction.tif\"\nbed.xi = 500",
                      mu = "bed.mu = \"friction.tif\"\nbed.xi = 500", xi = "bed.mu = 0.2\nbed.xi = \"friction.tif\"";
    CHECK(remark(with(angle, 0.3, 20.0), gis, "friction angle of")
              .find("bed.friction_angle_deg (the least of its raster): found a friction angle of 0.3 degrees") !=
          std::string::npos);
    CHECK(remark(with(mu, 0.2, 10.0), gis, "friction angle of")
              .find("bed.mu (the largest of its raster): found a friction angle of 84.3 degrees") != std::string::npos);
    CHECK(remarks(with(mu, 0.0, 0.2), gis, "friction angle of 0 degrees").size() == 1);
    CHECK(remark(with(xi, 1.0, 500.0), gis, "found 1 m/s^2").find("bed.xi (the least of its raster)") !=
          std::string::npos);
    CHECK(remarks(with(mu, 0.1, 0.4), gis, "of its raster").empty());
    const std::string snow = "[case]\nkind = \"snow\"\n";
    CHECK(remarks(with(mu, 0.2, 9.0, snow), gis, "found 9; expected ").size() == 1);
    // Where zones give the number the raster does not count.
    gis.polygons["east.geojson"] = rectangle(1100, 2000, 1200, 2150);
    const std::string zone = "[[material.zone]]\noutline = \"east.geojson\"\nmu = 0.3\n";
    CHECK(remarks(with(mu, 0.2, 10.0, zone), gis, "of its raster").empty());
}

TEST_CASE("Releases on the same ground are remarked upon with what adds up there", "[scene][remarks]") {
    FakeGis gis = slope(0.5);
    gis.polygons["other.geojson"] = rectangle(1090, 2050, 1120, 2080);
    const auto with = [&](const std::string& rest) {
        return case_of(coulomb + "bed.mu = 0.4", "2.0",
                       "[[release]]\noutline = \"other.geojson\"\ndepth = 1.5\n" + rest);
    };
    // 10 m by 30 m, where 1.5 m come upon 2 m
    CHECK(
        remark(with(""), gis, "of it on release.0")
            .find(
                "release.1: found about 300 m2 of it on release.0; expected releases side by side, since their depths "
                "add up there, to about 450 m3 more") != std::string::npos);
    CHECK(remarks(with("at = 10\n"), gis, "of it on release.0").empty());
    gis.polygons["other.geojson"] = rectangle(1100, 2050, 1120, 2080);  // beside it
    CHECK(remarks(with(""), gis, "of it on release.0").empty());
}

TEST_CASE("A footprint depth that no release has is remarked upon", "[scene][remarks]") {
    const auto of = [](const std::string& depth) {
        return case_of(coulomb + "bed.mu = 0.4", "2.0", "[output]\nfootprint_depth = " + depth + "\n");
    };
    CHECK(remark(of("3"), slope(0.5), "footprint_depth")
              .find("output.footprint_depth: found 3 m, and releases of 2 m at most") != std::string::npos);
    CHECK(remarks(of("0.1"), slope(0.5), "footprint_depth").empty());
}

TEST_CASE("A release that is too fast and a gravity of no planet are remarked upon", "[scene][remarks]") {
    const auto fast = [](const std::string& velocity) {
        return "[[release]]\noutline = \"release.geojson\"\ndepth = 2.0\nvelocity = " + velocity +
               "\n[terrain]\ndem = \"dem.tif\"\n[time]\nend = 20\n[material]\n" + coulomb + "bed.mu = 0.4\n";
    };
    CHECK(remark(fast("[-120, 100]"), slope(0.5), "found a speed")
              .find("release.0.velocity: found a speed of 156.2 m/s; expected 150 m/s at most") != std::string::npos);
    CHECK(remarks(fast("[-120, 0]"), slope(0.5), "found a speed").empty());
    const auto heavy = [](const std::string& gravity) {
        return "[terrain]\ndem = \"dem.tif\"\ngravity = " + gravity +
               "\n[[release]]\noutline = \"release.geojson\"\ndepth = 2.0\n[time]\nend = 20\n[material]\n" + coulomb +
               "bed.mu = 0.4\n";
    };
    for (const char* gravity : {"0.981", "98.1"})
        CHECK(remarks(heavy(gravity), slope(0.5), "terrain.gravity").size() == 1);
    for (const char* gravity : {"1.62", "9.81", "24.8"})
        CHECK(remarks(heavy(gravity), slope(0.5), "terrain.gravity").empty());
}

TEST_CASE("Fewer than 100 particles are remarked upon", "[scene][remarks]") {
    const auto of = [](int count) {
        return case_of(coulomb + "bed.mu = 0.4", "2",
                       "[particles]\nplacement = \"r2\"\ncount = " + std::to_string(count));
    };
    CHECK(remark(of(99), slope(0.5), "particles in all").find("found 99 particles in all; expected 100 or more") !=
          std::string::npos);
    CHECK(remark(of(99), slope(0.5), "particles in all").find("particles.count") != std::string::npos);
    CHECK(remarks(of(100), slope(0.5), "particles in all").empty());
}

TEST_CASE("Pixels of a depth without data are counted where the release claims material", "[scene][remarks]") {
    FakeGis gis = slope(0.5);
    const GridGeometry pixels{20, 20, 1005, 2005, 10};  // the release touches 5 x 3 of them
    gis.rasters["depth.tif"] = sampled(pixels, [](double, double) { return 2.0; });
    const std::string text = case_of(coulomb + "bed.mu = 0.4", "\"depth.tif\"");
    gis.rasters["depth.tif"].at(0, 0) = Raster::nodata;
    CHECK(remarks(text, gis, "taken as no material").empty());
    gis.rasters["depth.tif"].at(7, 6) = Raster::nodata;
    const std::string said = remark(text, gis, "taken as no material");
    CHECK(said.find("release.0.depth: found no data in 1 of 15 ") != std::string::npos);
    const std::string everywhere =
        "[terrain]\ndem = \"dem.tif\"\n[[release]]\ndepth = \"depth.tif\"\n[time]\nend = 20\n";
    CHECK(remark(everywhere, gis, "taken as no material").find("no data in 2 of 400 pixels") != std::string::npos);
}

// Pixels north and east of it, which its edges only meet, were counted as well.
TEST_CASE("Pixels that an outline meets at its edge only need no depth", "[scene][remarks]") {
    FakeGis gis = slope(0.5);
    gis.rasters["depth.tif"] = sampled({20, 20, 1005, 2005, 10}, [](double x, double y) {
        return x > 1050 && x < 1100 && y > 2050 && y < 2080 ? 2.0 : Raster::nodata;
    });
    const std::string text = case_of(coulomb + "bed.mu = 0.4", "\"depth.tif\"");
    CHECK(remarks(text, gis, "taken as no material").empty());
    gis.polygons["release.geojson"] = rectangle(1050, 2050, 1101, 2080);
    CHECK(remark(text, gis, "taken as no material").find("no data in 3 of 18 pixels") != std::string::npos);
}

TEST_CASE("A margin filled with zeros is remarked upon, a coast is not", "[scene][remarks]") {
    const std::string plain = case_of(coulomb + "bed.mu = 0.4");
    FakeGis gis = slope(0.5, 900.0);
    for (Index j = 0; j < grid.ny; ++j)
        for (Index i = 35; i < grid.nx; ++i) gis.rasters["dem.tif"].at(i, j) = 0.0;
    // three cells before the band the slope is 900 m + (162.5 m / 2) high; the release is far from it
    const std::string said = remark(plain, gis, "exactly 0 m");
    CHECK(said.find("slide/case.toml:2: terrain.dem: found 30 nodes of exactly 0 m below cliffs of up to 981.2 m") ==
          0);
    CHECK(said.find("gdal_translate -a_nodata 0 dem.tif dem_nodata.tif") != std::string::npos);
    FakeGis coast = slope(0.5);
    coast.rasters["dem.tif"] = sampled(grid, [](double x, double) { return x < 1030 ? 0.0 : 0.5 * (x - 1030.0); });
    CHECK(remarks(plain, coast, "exactly 0 m").empty());
}

TEST_CASE("Terrain that is as steep or as high as heights in feet is remarked upon", "[scene][remarks]") {
    const std::string plain = case_of(coulomb + "bed.mu = 0.4");
    // slopes of 30 degrees: 1.894 in feet, 62 degrees
    CHECK(remark(plain, slope(0.5774 / 0.3048), "if the heights are feet")
              .find("terrain.dem: found 100 % of the terrain steeper than 60 degrees; expected 33 % at most") !=
          std::string::npos);
    CHECK(remarks(plain, slope(0.5774), "if the heights are feet").empty());
    CHECK(remark(plain, slope(0.5, 9000.0), "if the heights are feet").find("found a height of 9098.75 m") !=
          std::string::npos);
}

TEST_CASE("Holes inside the terrain are remarked upon, as walls or as open, with their number",
          "[scene][remarks][holes]") {
    FakeGis gis = slope(0.5);
    for (const auto& [i, j] : {std::pair<Index, Index>{4, 4}, {4, 5}, {33, 20}, {0, 0}})
        gis.rasters["dem.tif"].at(i, j) = Raster::nodata;
    const std::string plain = case_of(coulomb + "bed.mu = 0.4"), open = plain + "[boundary]\nholes = \"open\"\n";
    const std::string walls = remark(plain, gis, "inside the terrain, the largest");
    CHECK(walls.find("terrain.dem: found 3 nodes without elevation in 2 hole(s) inside the terrain, the largest of 2 "
                     "at x 1022.5, "
                     "y 2022.5; they are walls") != std::string::npos);
    CHECK(remark(open, gis, "inside the terrain, the largest").find("mass leaves there") != std::string::npos);
    CHECK(remark(plain, gis, "outside of the terrain").find("1 of 1200 nodes") == 0);
    const auto built = [&](const std::string& text) {
        return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
    };
    CHECK(built(plain).hole_top == Approx(2 * 5.0 + 2.0));  // two cells and the release's depth
    CHECK_FALSE(built(open).hole_top.has_value());
    CHECK(built(open).holes.nodes == built(plain).holes.nodes);
    CHECK(remarks(plain, slope(0.5), "inside the terrain, the largest").empty());
    CHECK_FALSE(build_scene(CaseFile::parse(plain, "slide/case.toml"), slope(0.5)).hole_top.has_value());
}

TEST_CASE("An inflow faster than any landslide is remarked upon", "[scene][remarks][inflow]") {
    const auto with = [](double velocity) {
        return case_of(coulomb + "bed.mu = 0.4", "2.0",
                       fmt::format("[[inflow]]\nname = \"torrent\"\nline = [[1100, 2050], [1100, 2090]]\nvolume = "
                                   "100\npeak = 10\nvelocity = {}\n",
                                   velocity));
    };
    CHECK(remarks(with(500.0), slope(0.5), "expected 150 m/s at most").size() == 1);
    CHECK(remarks(with(50.0), slope(0.5), "expected 150 m/s at most").empty());
}

// At the line itself it had a half of what came in, two cells on 92 % of it, from there on all.
TEST_CASE("A section within three cells of an inflow is remarked upon", "[scene][remarks][sections]") {
    const auto with = [](const std::string& section, const std::string& inflow) {
        return case_of(coulomb + "bed.mu = 0.4", "2.0",
                       "[[section]]\nname = \"gate\"\nline = " + section + "\n[[inflow]]\nname = \"torrent\"\n" +
                           inflow + "\nvolume = 100\npeak = 10\n");
    };
    const std::string line = "line = [[1100, 2050], [1100, 2090]]\nvelocity = 2",
                      area = "area = [[1080, 2050], [1100, 2050], [1100, 2090], [1080, 2090]]";
    CHECK(
        remark(with("[[1110, 2020], [1110, 2120]]", line), slope(0.5), "from inflow") ==
        "section gate: found it 10 m from inflow torrent; expected 15 m or more, three cells; what comes in beyond it "
        "does not pass it, so that its discharge may be too low; draw it farther away");
    for (const std::string& inflow : {line, area}) {
        CHECK(remarks(with("[[1090, 2060], [1120, 2070]]", inflow), slope(0.5), "from inflow").size() == 1);
        CHECK(remarks(with("[[1116, 2020], [1116, 2120]]", inflow), slope(0.5), "from inflow").empty());
    }
}

TEST_CASE("A section beyond the outermost nodes of an open terrain is remarked upon", "[scene][remarks][sections]") {
    const auto with = [](const std::string& line, const std::string& rest = "") {
        return case_of(coulomb + "bed.mu = 0.4", "2.0", "[[section]]\nname = \"gate\"\nline = " + line + "\n" + rest);
    };
    // Nodes from x 1002.5 to 1197.5 and y 2002.5 to 2147.5, cells of 5 m.
    CHECK(remark(with("[[1002, 2010], [1002, 2130]]"), slope(0.5), "outermost nodes") ==
          "section gate: found 120 m of its line beyond the outermost nodes, within half a cell of the terrain's edge; "
          "expected it among them; what leaves the terrain there counts in part; draw it a cell or more farther in");
    CHECK(remark(with("[[1100, 2010], [1100, 2149], [1120, 2149]]"), slope(0.5), "outermost nodes").find("21.5 m") !=
          std::string::npos);
    for (const char* near :
         {"[[1002.5, 2000], [1002.5, 2150]]", "[[1012, 2010], [1012, 2130]]", "[[1100, 2139], [1120, 2139]]"})
        CHECK(remarks(with(near), slope(0.5), "within two cells of the outermost nodes").size() == 1);
    for (const char* fit :
         {"[[1013, 2000], [1013, 2150]]", "[[1000, 2000], [1200, 2150]]", "[[1100, 2000], [1100, 2020]]"})
        CHECK(remarks(with(fit), slope(0.5), "outermost nodes").empty());
    CHECK(remarks(with("[[1002, 2010], [1002, 2130]]", "[boundary]\nsides = \"wall\"\n"), slope(0.5), "outermost nodes")
              .empty());
}

TEST_CASE("A profile that leaves the terrain is remarked upon", "[scene][remarks]") {
    const auto with = [](const std::string& line) {
        return case_of(coulomb + "bed.mu = 0.4", "2.0", "[[profile]]\nname = \"axis\"\nline = " + line + "\n");
    };
    CHECK(remark(with("[[1100, 2010], [1300, 2010]]"), slope(0.5), "profile axis")
              .find("found corners of its line beyond the terrain") != std::string::npos);
    CHECK(remarks(with("[[1100, 2010], [1190, 2010]]"), slope(0.5), "profile axis").empty());
}

TEST_CASE("A case without a source names all kinds of them", "[scene]") {
    try {
        CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[time]\nend = 20\n", "slide/case.toml");
        FAIL("is taken");
    } catch (const UserError& error) {
        CHECK_THAT(error.what(),
                   Catch::Contains("expected at least one [[release]] or [[inflow]], or free water with water.level"));
    }
}

TEST_CASE("Every remark of the table is in the manual of the commands", "[scene][remarks]") {
    std::ifstream file(FRANA_SOURCE_DIR "/apps/README.md");
    std::stringstream text;
    text << file.rdbuf();
    for (const RemarkRow& row : remark_table()) {
        CAPTURE(row.title);
        CHECK(text.str().find(std::string("| ") + row.title + " |") != std::string::npos);
    }
}

TEST_CASE("Remarks on how coordinates are taken are one for all files, and others stay as they are", "[scene]") {
    const std::string local =
        ": coordinates are taken as the terrain's own, since the terrain has no CRS (here X is given)";
    std::vector<std::string> log = {"dem.asc: no CRS; its coordinates are taken as local metres", "a.geojson" + local,
                                    "release.0: found much", "b.geojson" + local, "b.geojson" + local};
    const std::vector<std::string> joined = {log[0], "a.geojson, b.geojson" + local, log[2]};
    join_remarks_on_coordinates(log);
    CHECK(log == joined);
    log.push_back("b.geojson" + local);  // read again
    log.push_back("c.geojson" + local);
    join_remarks_on_coordinates(log);
    CHECK(log == std::vector<std::string>{joined[0], "a.geojson, b.geojson, c.geojson" + local, joined[2]});
}
