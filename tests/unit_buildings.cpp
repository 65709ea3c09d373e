// Many buildings as barriers: what a case may have, and what particles do among them.
#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "barrier_ground.h"
#include "catch.h"
#include "checks/verify/box_mesh.h"
#include "coupling/staged_run.h"
#include "coupling/walled_particles.h"
#include "observe/memory_archive.h"
#include "scene/build_scene.h"
#include "scene/joined_barriers.h"
#include "slope_case.h"
#include "terrain/distance_field.h"

using namespace frana;
using namespace frana::test;
using Catch::Contains;

namespace {

std::string with_houses(const std::string& keys, const std::string& rest = "") {
    return "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
           "[material]\ndensity = 1500\n[material.bed]\nlaw = \"coulomb\"\nmu = 0.3\n[[barrier]]\nname = \"house\"\n"
           "outline = \"houses.gpkg\"\n" +
           keys + rest;
}

/// Houses of that side in rows on the slope; the one at `from` first.
Polygons village(int count, double side, double spacing) {
    Polygons all;
    for (int n = 0; n < count; ++n) {
        const double x = 1010 + spacing * (n % 8), y = 2010 + spacing * (n / 8);
        all.parts.push_back(rectangle(x, y, x + side, y + side).parts[0]);
    }
    return all;
}

Scene scene_of(const std::string& text, const FakeGis& gis) {
    return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
}

bool says(const Scene& scene, const std::string& words) {
    for (const std::string& line : scene.log)
        if (line.find(words) != std::string::npos) return true;
    return false;
}

Barrier house(double x, double y, double side) {
    Barrier barrier;
    barrier.name = "house";
    barrier.outline = rectangle(x, y, x + side, y + side);
    barrier.height = 6.0;
    return barrier;
}

/// A stream down a channel along x onto houses; their middles lie on y = 60, about which all is symmetric.
Scene stream(const std::vector<Barrier>& houses) {
    Scene scene = scene_on(120, 61, 2.0, [](double x, double) { return 100 - 0.3 * x; });
    scene.bed_law = bed::Coulomb{0.1};
    fill(scene, [](double x, double y) { return x > 20 && x < 50 && std::abs(y - 60) < 30 ? 2.0 : 0.0; });
    scene.barriers = houses;
    return scene;
}

}  // namespace

TEST_CASE("Particles alone may have hundreds of barriers, 3D points may not", "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = village(64, 12, 17);
    CHECK(scene_of(with_houses("height = 6\neach = true\n"), gis).barriers.size() == 64);
    const std::string stage = "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1020, 2020, 1100, 2100]\n";
    const std::string problem = only_problem([&] { scene_of(with_houses("height = 6\neach = true\n", stage), gis); });
    CHECK_THAT(problem, Contains("found 64 barriers") && Contains("3D points"));
}

TEST_CASE("Each house has the height of its feature, up to 500 m", "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = village(3, 12, 17);
    gis.attributes["h"] = {4.0, 7.5, 5.0};
    const std::string keys = "height_field = \"h\"\neach = true\n";
    const Scene scene = scene_of(with_houses(keys), gis);
    REQUIRE(scene.barriers.size() == 3);
    CHECK((scene.barriers[0].height == 4.0 && scene.barriers[1].height == 7.5 && scene.barriers[2].height == 5.0));
    const auto wrong = [&](const std::string& text) { return only_problem([&] { scene_of(text, gis); }); };
    CHECK_THAT(wrong(with_houses("height = 501\neach = true\n")), Contains("found 501 m") && Contains("up to 500 m"));
    CHECK_THAT(wrong(with_houses("height_field = \"floors\"\neach = true\n")), Contains("no such attribute"));
    CHECK_THAT(wrong(with_houses("height_field = \"h\"\n")), Contains("found without each"));
    CHECK_THAT(wrong(with_houses(keys + "top = 200\n")), Contains("height_field: found together with top"));
    for (const double bad : {0.0, 1720.0}) {
        gis.attributes["h"] = {4.0, bad, 5.0};
        CHECK_THAT(wrong(with_houses(keys)), Contains("polygon 2 of houses.gpkg"));
    }
}

TEST_CASE("A top below all ground of its outline is told, wherever the corners are", "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = rectangle(1100, 1990, 1120, 2160);  // across the terrain, from beyond it to beyond
    const std::string buried = "nothing meets it";
    CHECK(says(scene_of(with_houses("top = 140\n"), gis), buried));  // the ground is 148.75 m there and higher
    CHECK_FALSE(says(scene_of(with_houses("top = 150\n"), gis), buried));
    gis.polygons["houses.gpkg"] = rectangle(1100, 2010, 1120, 2130);
    CHECK(says(scene_of(with_houses("top = 140\n"), gis), buried));
    gis.rasters["dem.tif"] =  // corners stand on high ground, the middle in a gully
        sampled({40, 30, 1002.5, 2002.5, 5.0}, [](double x, double y) {
            return 100.0 + 0.5 * (x - 1000.0) - (std::abs(y - 2070.0) < 10.0 ? 30.0 : 0.0);
        });
    CHECK_FALSE(says(scene_of(with_houses("top = 140\n"), gis), buried));
}

// Its faces were met through the ground: a barrier 0.5 m below had forces, run-up and what went over it.
TEST_CASE("A top below all ground of its outline is refused where 3D points would meet it", "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = village(2, 12, 17);  // on ground of 103.75 m and more, the second of 113.75 m
    const std::string stage = "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1005, 2000, 1100, 2100]\n";
    const auto problem = [&](const std::string& keys) {
        return only_problem([&] { scene_of(with_houses(keys, stage), gis); });
    };
    CHECK_THAT(problem("top = 100\n"), Contains("barrier.0.top: found 100 m") && Contains("nothing meets it"));
    CHECK_THAT(problem("top = 108\neach = true\n"), Contains("found 108 m") && Contains("nothing meets house_2"));
    CHECK(scene_of(with_houses("top = 108\n", stage), gis).barriers.size() == 1);
}

TEST_CASE("Barriers lower than a cell of a 3D stage are remarked upon, and what is beyond the terrain",
          "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = rectangle(1020, 1980, 1030, 2060);  // the terrain begins at y = 2000
    const auto scene = [&](const std::string& keys, const std::string& cell) {
        return scene_of(with_houses(keys,
                                    "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1005, 2000, 1100, 2100]\n"
                                    "cell = " +
                                        cell + "\n"),
                        gis);
    };
    const std::string low = "house stands 1.5 m high, 0.75 cells of the 3D stage; expected 1 or more";
    CHECK(says(scene("height = 1.5\n", "2.0"), low));
    CHECK(says(scene("height = 1.5\n", "2.0"), "err by a tenth, and moments by more"));
    CHECK(says(scene("height = 0.1\n", "2.0"), "err by half or more, and moments by more"));
    CHECK_FALSE(says(scene("height = 4\n", "2.0"), "m high"));
    CHECK_FALSE(says(scene_of(with_houses("height = 4\n"), gis), "m high"));  // to particles it is ground
    // 10 m of one end and 20 m of both sides, of 180 m around it.
    CHECK(says(scene("height = 4\n", "1.0"), "28 % of the foot of house lie beyond the terrain"));
    const std::string closed = "1.0\n[boundary]\nsides = \"wall\"";  // across a flume, into its side
    CHECK_FALSE(says(scene("height = 4\n", closed), "beyond the terrain"));
    gis.polygons["houses.gpkg"] = rectangle(1020, 1900, 1030, 2060);
    CHECK(says(scene("height = 4\n", closed), "62 % of the foot of house lie beyond the terrain"));
    gis.polygons["houses.gpkg"] = rectangle(1020, 2005, 1030, 2060);
    CHECK_FALSE(says(scene("height = 4\n", "1.0"), "beyond the terrain"));
}

TEST_CASE("A dam whose top lies below all ground along its line is told", "[scene][barriers]") {
    const FakeGis gis = slope_gis();
    const auto dam = [](const char* top) {
        const std::string text = with_houses("");
        return text.substr(0, text.find("[[barrier]]")) +
               "[[barrier]]\nname = \"dam\"\nline = [[1100, 2010], [1100, 2130]]\ntop = " + top + "\n";
    };
    CHECK(says(scene_of(dam("149"), gis), "nothing meets it"));  // the ground is 150 m all along
    CHECK_FALSE(says(scene_of(dam("151"), gis), "nothing meets it"));
}

TEST_CASE("Houses beyond the terrain are left out with a remark, the others keep their numbers", "[scene][barriers]") {
    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = village(3, 12, 17);
    gis.polygons["houses.gpkg"].parts[1] = rectangle(9000, 2010, 9012, 2022).parts[0];
    const Scene scene = scene_of(with_houses("height = 6\neach = true\n"), gis);
    REQUIRE(scene.barriers.size() == 2);
    CHECK((scene.barriers[0].name == "house_1" && scene.barriers[1].name == "house_3"));
    CHECK(says(scene, "1 of 3 polygons are not on the terrain"));
}

TEST_CASE("Barriers that overlap, or touch along a side, are named where 3D points meet them", "[scene][barriers]") {
    constexpr double kCell = 0.5;
    const auto joined = [&](const Polygons& one, const Polygons& other) {
        std::vector<Barrier> pair(2);
        pair[0].outline = one, pair[1].outline = other;
        const std::size_t found = joined_barriers(pair, kCell).size();
        std::swap(pair[0], pair[1]);
        CHECK(joined_barriers(pair, kCell).size() == found);
        return found == 1;
    };
    const Polygons wall = rectangle(30, 0, 32, 25);
    CHECK(joined(wall, rectangle(31, 0, 33, 25)));     // one behind the other
    CHECK(joined(wall, rectangle(28, 10, 31, 14)));    // a T
    CHECK(joined(wall, rectangle(28, 10, 30, 14)));    // the same that only touches
    CHECK(joined(wall, rectangle(30.2, 10, 31, 14)));  // within
    CHECK(joined(wall, wall));
    CHECK(joined(rectangle(0, 0, 2, 14), rectangle(0, 10, 2, 25)));  // sides on one line
    CHECK(joined(wall, rectangle(28, 10, 29.99, 14)));               // a gap that no cell resolves
    CHECK(joined(wall, rectangle(28, 10, 29.51, 14)));
    CHECK_FALSE(joined(wall, rectangle(28, 10, 29.5, 14)));  // a cell
    CHECK(joined(wall, rectangle(32, 0, 34, 25)));           // back to back
    CHECK(joined(wall, rectangle(30, 25, 32, 40)));          // end to end
    CHECK(joined(wall, rectangle(32, 25, 34, 40)));          // corner to corner
    std::vector<Barrier> lines(2);  // walls along lines stand 1.5 m thick on their dry side at least
    lines[0].line = {{0, 0}, {0, 10}}, lines[1].line = {{1.4, 0}, {1.4, 10}};
    CHECK(joined_barriers(lines, kCell).size() == 1);
    lines[1].line = {{2.1, 0}, {2.1, 10}};
    CHECK(joined_barriers(lines, kCell).empty());
    lines[1].thickness = 2.0, lines[1].wet_left = false;
    CHECK(joined_barriers(lines, kCell).size() == 1);
    lines[1] = {};
    lines[1].line = {{0, 10}, {0, 20}};  // end to end
    CHECK(joined_barriers(lines, kCell).size() == 1);
    lines[1].line = {{0, 10}, {-10, 10}};  // a corner
    CHECK(joined_barriers(lines, kCell).size() == 1);
    std::vector<Barrier> mesh(2);  // from x = 33 to 35
    mesh[0].outline = wall;
    mesh[1].shape = std::make_shared<DistanceField>(verify::box_as_mesh({33, 5, 0}, {35, 9, 4}, kCell));
    CHECK(joined_barriers(mesh, kCell).empty());
    CHECK(joined_barriers(mesh, 1.5).size() == 1);
    mesh[0].outline = rectangle(30, 0, 33.5, 25);
    CHECK(joined_barriers(mesh, kCell).at(0).apart == 0.0);

    FakeGis gis = slope_gis();
    gis.polygons["houses.gpkg"] = village(3, 12, 17);
    const std::string keys = "height = 6\neach = true\n";
    const std::string stage = "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1020, 2020, 1100, 2100]\n";
    CHECK_FALSE(says(scene_of(with_houses(keys, stage), gis), "overlap"));
    gis.polygons["houses.gpkg"].parts[2] = rectangle(1035, 2015, 1045, 2025).parts[0];
    CHECK(says(scene_of(with_houses(keys, stage), gis), "house_2 and house_3: found barriers that overlap"));
    CHECK_FALSE(says(scene_of(with_houses(keys), gis), "overlap"));  // to particles they are ground
}

TEST_CASE("Houses thinner than two cells are remarked upon", "[scene][barriers]") {
    FakeGis gis = slope_gis();  // cells of 5 m
    gis.polygons["houses.gpkg"] = village(3, 9.9, 17);
    gis.polygons["houses.gpkg"].parts[1] = rectangle(1060, 2010, 1071, 2021).parts[0];
    CHECK(says(scene_of(with_houses("height = 6\neach = true\n"), gis), "2 of 3 polygons are thinner than two cells"));
    gis.polygons["houses.gpkg"] = village(3, 10.1, 17);
    CHECK_FALSE(says(scene_of(with_houses("height = 6\neach = true\n"), gis), "thinner"));
}

TEST_CASE("The ground of many houses is that of each alone", "[barriers]") {
    std::vector<Barrier> houses;
    for (int n = 0; n < 40; ++n) houses.push_back(house(30.0 + 20.0 * (n % 8), 10.0 + 20.0 * (n / 8), 7.0));
    const Scene all = stream(houses);
    const Raster ground = with_barriers(all);
    Raster expected = all.bed;
    for (const Barrier& one : houses) {
        const Raster raised = with_barriers(stream({one}));
        for (std::size_t k = 0; k < expected.values.size(); ++k)
            expected.values[k] = std::max(expected.values[k], raised.values[k]);
    }
    CHECK(ground.values == expected.values);  // nodes on whole numbers: the same bits from a part of the ground
    CHECK(ground.values != all.bed.values);
}

TEST_CASE("Houses that the flow does not meet change no bit of it, nor of what is known of others", "[barriers]") {
    const std::vector<Barrier> one{house(80, 56, 8)};
    std::vector<Barrier> many = one;
    for (int n = 0; n < 40; ++n)
        many.push_back(house(190.0 + 10.0 * (n % 4), 4.0 + 11.0 * (n / 4), 4.0));  // beyond its reach
    WalledParticles a(stream(one)), b(stream(many));
    for (WalledParticles* run : {&a, &b}) run_to(*run, 5.0);
    CHECK(a.status().kinetic == b.status().kinetic);
    CHECK(a.loads()->barriers[0].run_up == b.loads()->barriers[0].run_up);
    CHECK(a.loads()->barriers[0].run_up > a.loads()->barriers[0].about.z());  // its foot on the flat
    CHECK(std::isnan(b.loads()->barriers[40].run_up));
    CHECK(b.loads()->barriers[40].overtopped == 0.0);
}

TEST_CASE("What a release places on a barrier is told", "[barriers]") {
    CHECK(WalledParticles(stream({house(80, 56, 8)})).remarks().empty());
    // 8 x 8 m of the slab, 2 m deep; its particles stand half a metre apart and more.
    const std::vector<std::string> told = WalledParticles(stream({house(80, 36, 8), house(30, 56, 8)})).remarks();
    REQUIRE(told.size() == 1);
    CHECK(told.front() ==
          "barriers: found 128 m3 of releases on top of barriers; expected none, since it falls from there; move the "
          "outlines apart");
}

TEST_CASE("What an inflow lets in on top of a barrier is told", "[barriers]") {
    Scene scene = stream({house(80, 56, 8)});
    scene.particles = {};
    Inflow line;
    line.name = "torrent";
    line.line = {{84, 36}, {84, 76}};
    line.time = {0.0, 10.0, 20.0}, line.discharge = {20.0, 20.0, 0.0}, line.speed = {5.0, 5.0, 5.0};
    scene.inflows = {line};
    scene.end = 10.1;
    // The house has 8 m of the 40 m through which 200 m3 come by 10 s. A row of 0.2 s is not whole by the end.
    const std::string torrent =
        "inflow torrent: found 40 m3 of it that enter on top of barriers by time.end; expected none, since it "
        "falls from there; move it off their outlines, or cut them out of its area";
    CHECK(WalledParticles(scene).remarks() == std::vector<std::string>{torrent});
    Inflow area;
    area.name = "spring";
    area.patches = {{{84, 60}, 0.25}, {{100, 60}, 0.75}};
    area.area = 4.0, area.layer = 0.5;
    area.time = {0.0, 8.0}, area.discharge = {2.0, 2.0}, area.speed = {0.0, 0.0};
    scene.inflows.push_back(area);
    SolidStage stage;
    stage.window = {90, 40, 110, 70};
    stage.from = 9.0;
    stage.cell = 1.0, stage.spacing = 0.5;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    const std::vector<std::string> told = StagedRun(scene).remarks();
    CHECK(std::count(told.begin(), told.end(), torrent) == 1);
    CHECK(std::any_of(told.begin(), told.end(), [](const std::string& one) {
        return one.find("inflow spring: found 4 m3 of it that enter on top of barriers") == 0;
    }));
    scene.inflows.front().line = {{100, 36}, {100, 76}};
    scene.inflows.pop_back();
    scene.solid.reset();
    CHECK(WalledParticles(scene).remarks().empty());
}

TEST_CASE("What flows over a buried barrier has not met it", "[barriers]") {
    Barrier buried = house(80, 56, 8), dam = buried;  // on ground of 76 m down to 73.6 m
    buried.height = 0.0, buried.top = 70.0;
    dam.height = 0.0, dam.top = 75.0;  // its upper third is buried
    WalledParticles under(stream({buried})), alone(stream({})), part(stream({dam}));
    for (WalledParticles* run : {&under, &alone, &part}) run_to(*run, 8.0);
    CHECK(std::isnan(under.loads()->barriers[0].run_up));
    CHECK(under.loads()->barriers[0].overtopped == 0.0);
    CHECK(under.status().kinetic == alone.status().kinetic);
    CHECK(part.loads()->barriers[0].overtopped > 0.0);
}

TEST_CASE("The roof of a neighbour is no run-up", "[barriers]") {
    // The second stands beside the first and is 6 m higher up the slope: what comes over its roof passes the first within two
    // cells, as high as ground there.
    WalledParticles run(stream({house(90, 56, 8), house(84, 66, 4)})), alone(stream({house(90, 56, 8)}));
    for (WalledParticles* one : {&run, &alone}) run_to(*one, 5.0);
    const auto& loads = run.loads()->barriers;
    REQUIRE(loads[1].overtopped > 0.0);
    CHECK(loads[0].run_up < loads[1].run_up - 1.0);
    CHECK(loads[0].run_up == Approx(alone.loads()->barriers[0].run_up).margin(1.0));
}

TEST_CASE("Two houses of a symmetric row are met alike, and resume to the last bit", "[barriers]") {
    std::vector<Barrier> row{house(80, 36, 8), house(80, 76, 8)};  // middles 20 m off the axis to both sides
    for (int n = 0; n < 30; ++n) row.push_back(house(190.0 + 10.0 * (n % 3), 4.0 + 11.0 * (n / 3), 4.0));
    const Scene scene = stream(row);
    WalledParticles run(scene);
    run_to(run, 3.0);
    MemoryArchive kept;
    run.serialize(kept);
    WalledParticles resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    for (WalledParticles* one : {&run, &resumed}) run_to(*one, 6.0);
    const auto& loads = run.loads()->barriers;
    CHECK(loads[0].run_up > loads[0].about.z() + 0.1);
    // Sums of nodes run from south to north: mirror images differ by round-off, which steep fronts amplify.
    CHECK(loads[0].run_up == Approx(loads[1].run_up).margin(1e-6));
    for (std::size_t n = 0; n < row.size(); ++n) {
        CHECK((std::isnan(loads[n].run_up) ? std::isnan(resumed.loads()->barriers[n].run_up)
                                           : resumed.loads()->barriers[n].run_up == loads[n].run_up));
        CHECK(resumed.loads()->barriers[n].overtopped == loads[n].overtopped);
    }
}
