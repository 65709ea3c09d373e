// Cases of free water alone: set up by releases, a lake within an outline, inflows and sides; exact answers, budgets, frames,
// the same bits on any threads and when taken up again; what is refused.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "checks/verify/exact_dam_break.h"
#include "coupling/structured_run.h"
#include "fresh_folder.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"
#include "scene/build_scene.h"
#include "slope_case.h"
#include "threads_of_test.h"

namespace frana::flood_test {  // its names are other files' too
using namespace frana::test;

namespace {

using Formula = std::function<double(double, double)>;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Ground by a formula on nodes in the middle of cells, and files around it.
FakeGis ground(Index nx, Index ny, double cell, const Formula& z) {
    FakeGis gis;
    gis.rasters["dem.tif"] = sampled({nx, ny, 0.5 * cell, 0.5 * cell, cell}, z);
    return gis;
}

CaseFile case_of(const std::string& text) {
    return CaseFile::parse(
        "[terrain]\ndem = \"dem.tif\"\ncurvature = \"none\"\n[time]\nend = 1000\n[water]\n"
        "model = \"free\"\n" +
            text,
        "flood/case.toml");
}

Scene scene_of(const FakeGis& gis, const std::string& text) { return build_scene(case_of(text), gis); }

std::string said_of(const FakeGis& gis, const std::string& text) {
    std::string said;
    for (const std::string& line : scene_of(gis, text).log) said += line + "\n";
    return said;
}

std::string problem_of(const FakeGis& gis, const std::string& text) {
    return only_problem([&] { scene_of(gis, text); });
}

void go_to(Simulation& run, double time) {
    while (run.status().time < time) run.advance(time);
}

double flat(double, double) { return 0.0; }

/// A channel with a dam break: 1 m of water up to x = 50 m of 100 m, by a lake within an outline.
FakeGis channel() {
    FakeGis gis = ground(200, 5, 0.5, flat);
    gis.polygons["lake.geojson"] = rectangle(-1.0, -1.0, 50.0, 9.0);
    return gis;
}

const std::string kWalls = "[boundary]\nsides = \"wall\"\n";
const std::string kLake = "level = 1.0\nlevel_within = \"lake.geojson\"\n";

/// Numbers of all fields of nodes, and of the status.
std::vector<double> bits_of(Simulation& run) {
    std::vector<double> bits;
    const Frame frame = run.frame();
    for (const Field& field : frame.nodes)
        bits.insert(bits.end(), field.data, field.data + field.count * field.components);
    const Status& s = frame.status;
    for (const double number : {s.mass, s.mass_in, s.mass_left, s.momentum[0], s.momentum_left[0], s.impulse[0],
                                s.kinetic, s.potential, s.dissipated, s.energy_left, s.front, s.mean_speed})
        bits.push_back(number);
    return bits;
}

}  // namespace

TEST_CASE("A dam break of a case of water alone is Ritter's", "[water][alone]") {
    const Scene scene = scene_of(channel(), kLake + kWalls);
    CHECK(scene.density == 1000.0);
    CHECK(scene.particles.count() == 0);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    const Status first = run->status();
    CHECK(first.mass == Approx(1000.0 * 50.0 * 2.5).epsilon(1e-15));
    const double end = 6.0;
    go_to(*run, end);
    const verify::Ritter wave{1.0};
    double error = 0.0, sum = 0.0, fastest = 0.0;
    const Frame frame = run->frame();
    const Field &depth = *frame.node("depth"), &velocity = *frame.node("velocity");
    for (Index i = 0; i < 200; ++i) {
        const verify::WaveState exact = wave.at((scene.bed.geometry.x(i) - 50.0) / end);
        error += std::abs(depth.data[2 * 200 + i] - exact.depth), sum += exact.depth;
        if (exact.depth > 0.1) fastest = std::max(fastest, std::abs(velocity.data[3 * (400 + i)] - exact.velocity));
    }
    CHECK(error < 4e-3 * sum);  // verification.txt: 3.3e-3 on 200 cells
    CHECK(fastest < 0.1);       // of up to 4.3 m/s, where the fan has its head
    const Budget left = budget(first, run->status());
    CHECK(std::abs(left.mass_error) < 1e-14);
    CHECK(run->status().particles == 0);
}

TEST_CASE("A release is water where there is no structure: all of its volume, with sharp edges and its velocity",
          "[water][alone]") {
    FakeGis gis = channel();
    gis.polygons["release.geojson"] = rectangle(0.0, 0.0, 50.0, 2.5);
    const std::string released = "[[release]]\noutline = \"release.geojson\"\ndepth = 1.0\nvelocity = [0.5, 0.0]\n";
    Scene scene = scene_of(gis, kWalls + released);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    double volume = 0.0;
    for (const double part : scene.particles.volume) volume += part;
    CHECK(volume == Approx(50.0 * 2.5).epsilon(1e-12));  // in whole cells, beyond the outer nodes too
    CHECK_FALSE(has(said_of(gis, kWalls + released), "left out"));
    CHECK(run->status().mass == Approx(1000.0 * 50.0 * 2.5).epsilon(1e-12));
    CHECK(run->status().momentum[0] == Approx(500.0 * 50.0 * 2.5).epsilon(1e-12));
    const Frame frame = run->frame();
    const double* depth = frame.node("depth")->data;
    for (Index j = 0; j < 5; ++j)
        for (Index i = 0; i < 200; ++i) CHECK(depth[j * 200 + i] == Approx(i < 100 ? 1.0 : 0.0).epsilon(1e-12));
    CHECK(has(problem_of(gis, kWalls + released + "at = 5\n"), "what holds together, and water, begin at the start"));
}

TEST_CASE("A release onto a lake adds to what stands there, with its momentum", "[water][alone]") {
    FakeGis gis = channel();
    gis.polygons["release.geojson"] = rectangle(10.0, 0.0, 20.0, 2.5);
    const std::string released = "[[release]]\noutline = \"release.geojson\"\ndepth = ";
    for (const double depth : {0.5, 3.0}) {  // less deep than the lake, and deeper
        const Scene scene =
            scene_of(gis, kLake + kWalls + released + fmt::format("{}\nvelocity = [2.0, 0.0]\n", depth));
        const std::unique_ptr<Simulation> run = make_simulation(scene);
        CHECK(run->status().mass == Approx(1000.0 * (50.0 + 10.0 * depth) * 2.5).epsilon(1e-12));
        CHECK(run->status().momentum[0] == Approx(2000.0 * 10.0 * depth * 2.5).epsilon(1e-12));
    }
}

TEST_CASE("A lake within an outline rests to round-off, and other hollows stay dry", "[water][alone]") {
    // Two hollows of one depth; the outline is around the first.
    const auto z = [](double x, double y) {
        const double first = std::hypot(x - 20.0, y - 20.0), second = std::hypot(x - 60.0, y - 20.0);
        return 1500.0 + std::min({4.0, 0.02 * first * first, 0.02 * second * second}) + 0.1 * std::sin(x) * std::cos(y);
    };
    FakeGis gis = ground(80, 40, 1.0, z);
    gis.polygons["lake.geojson"] = rectangle(0.0, 0.0, 40.0, 40.0);
    const std::string level = "level = 1502.5\n";
    const Scene scene = scene_of(gis, level + "level_within = \"lake.geojson\"\n");
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    double volume = 0.0;
    for (Index j = 0; j < 40; ++j)
        for (Index i = 0; i < 40; ++i) volume += std::max(0.0, 1502.5 - scene.bed.at(i, j));
    const Status first = run->status();
    CHECK(first.mass == Approx(1000.0 * volume).epsilon(1e-13));
    for (int step = 0; step < 200; ++step) run->advance(1e4);
    CHECK(run->status().max_speed_on_map < 1e-11);  // round-off of 1500 m above the sea
    const Frame frame = run->frame();
    const double *depth = frame.node("depth")->data, *surface = frame.node("surface")->data;
    for (Index j = 0; j < 40; ++j)
        for (Index i = 0; i < 80; ++i) {
            const Index n = j * 80 + i;
            if (i >= 40) CHECK(depth[n] == 0.0);
            if (i < 40 && depth[n] > 0.0) CHECK(surface[n] == Approx(1502.5).epsilon(1e-14));
        }
    CHECK(std::abs(budget(first, run->status()).mass_error) < 1e-13);
    const std::string said = said_of(gis, level + "level_within = \"lake.geojson\"\n");
    CHECK(has(said, fmt::format("with {:.4g} m3", volume)));
    CHECK_FALSE(has(said, "its outline cuts it off"));
    // An outline through the lake: what is behind it breaks out.
    gis.polygons["lake.geojson"] = rectangle(0.0, 0.0, 20.0, 40.0);
    CHECK(has(said_of(gis, level + "level_within = \"lake.geojson\"\n"),
              "its outline cuts it off over 22 m, where it breaks out at the start as behind a dam"));
    CHECK(scene_of(gis, level).water->lake.empty());
    // Sides that have keys are held by those.
    const std::string high = "level = 1600\n";
    CHECK(has(said_of(gis, high), "it meets open sides over"));
    CHECK_FALSE(
        has(said_of(gis, high + "[water.sides]\nwest = \"wall\"\neast = 1601\nnorth = \"wall\"\nsouth = \"free\"\n"),
            "it meets open sides over"));
}

TEST_CASE("A release up to one level within its shore rests as water as well", "[water][alone]") {
    const auto z = [](double x, double y) { return std::min(4.0, 0.02 * ((x - 20) * (x - 20) + (y - 20) * (y - 20))); };
    FakeGis gis = ground(41, 41, 1.0, z);
    const Scene scene = scene_of(gis, "[[release]]\nsurface = 2.5\n");
    REQUIRE(scene.still_surface == 2.5);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    CHECK(run->status().mass > 1e5);
    for (int step = 0; step < 100; ++step) run->advance(1e4);
    CHECK(run->status().max_speed_on_map < 1e-12);
}

TEST_CASE("An outline of a lake that is off the terrain, or holds nothing lower, is refused", "[water][alone][scene]") {
    FakeGis gis = channel();
    gis.polygons["far.geojson"] = rectangle(500.0, 0.0, 600.0, 10.0);
    CHECK(has(
        problem_of(gis, "level = 1\nlevel_within = \"far.geojson\"\n"),
        "water.level_within: rectangle: found no node of the terrain inside; expected an outline within x 0 to 100"));
    CHECK(has(problem_of(gis, "level = -1\nlevel_within = \"lake.geojson\"\n"),
              "found no ground below -1 m inside; expected a level above the lowest there, 0 m"));
    CHECK(has(problem_of(gis, "level_within = \"lake.geojson\"\nrain = 1e-5\n"), "found without water.level"));
    CHECK(has(problem_of(gis, "level = 1\nlevel_within = \"none.geojson\"\n"), "no such polygons"));
    CHECK(has(problem_of(gis, ""), "expected at least one [[release]] or [[inflow]], or water.level or water.rain"));
    CHECK_NOTHROW(scene_of(gis, "rain = 1e-5\n"));
    CHECK(has(problem_of(gis, kLake + "share = 0.5\n"), "expected 0: all that is released is water"));
    CHECK(has(problem_of(gis, kLake + "[material]\ndensity = 1900\n"), "give water.density"));
    CHECK(has(problem_of(gis, kLake + "[[barrier]]\noutline = \"lake.geojson\"\nheight = 2\n"),
              "expected none, since water does not know them"));
}

namespace {

/// A plane of 1 in 50 to the east, 80 x 10 m, rough, with a river's table in `folder`.
FakeGis plane() {
    return ground(80, 10, 1.0, [](double x, double) { return 300.0 - 0.02 * x; });
}

const std::string kRough = "friction = \"manning\"\nmanning_n = 0.04\n";

/// A line across all of the plane.
std::string river(const std::string& table) {
    return "[[inflow]]\nname = \"river\"\nline = [[3.5, 0.0], [3.5, 10.0]]\ntable = \"" + table + "\"\n";
}

std::string table_in(const std::filesystem::path& folder, const std::string& rows) {
    std::ofstream(folder / "q.csv") << "t [s],discharge [m3/s]\n" << rows;
    return (folder / "q.csv").string();
}

}  // namespace

TEST_CASE("An inflow down a plane comes to Manning's normal depth and leaves by a free side",
          "[water][alone][inflow]") {
    const FreshFolder folder;
    const Scene scene =
        scene_of(plane(), kRough +
                              "[water.sides]\neast = \"free\"\nwest = \"wall\"\nsouth = \"wall\"\nnorth = "
                              "\"wall\"\n" +
                              river(table_in(folder.path(), "0,5\n2000,5\n")));
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    CHECK(run->status().mass == 0.0);
    CHECK(run->more_comes());
    go_to(*run, 900.0);
    // q = 0.5 m2/s: h^(10/3) = q^2 n^2 / (S cos^(13/3)).
    const double slope = 0.02, cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    const double depth = std::pow(0.25 * 0.0016 / (slope * std::pow(cosine, 13.0 / 3.0)), 0.3);
    const Frame frame = run->frame();
    const double *h = frame.node("depth")->data, *v = frame.node("velocity")->data;
    for (const Index i : {40, 60, 79})
        for (const Index j : {0, 5, 9}) {
            CHECK(h[j * 80 + i] == Approx(depth).epsilon(1e-8));
            CHECK(v[3 * (j * 80 + i)] == Approx(0.5 / depth).epsilon(1e-8));
        }
    const Extras extras = run->extras();
    REQUIRE(extras.inflow.has_value());
    CHECK(extras.inflow->volume == Approx(4500.0).epsilon(1e-12));
    CHECK(extras.inflow->expected == Approx(4500.0).epsilon(1e-14));
    CHECK(extras.inflow->tables == Approx(10000.0).epsilon(1e-14));
    CHECK_FALSE(extras.breakage.has_value());
    const Status now = run->status();
    CHECK(std::abs(now.mass + now.mass_left - now.mass_in) < 1e-12 * now.mass_in);
    CHECK(now.mass_in == Approx(1000.0 * extras.inflow->volume).epsilon(1e-14));
    const double before = now.mass_left;
    run->advance(2000.0);
    CHECK((run->status().mass_left - before) / run->status().dt == Approx(5000.0).epsilon(1e-8));
}

TEST_CASE("Inflows of water: volume of any table, by a bent line, over an area, of a volume with its peak",
          "[water][alone][inflow]") {
    const FreshFolder folder;
    const auto basin = [](double x, double y) { return 50.0 + 0.01 * ((x - 40) * (x - 40) + (y - 5) * (y - 5)); };
    FakeGis gis = ground(80, 30, 1.0, basin);
    const std::string table = table_in(folder.path(), "1,0\n3.3,7\n4,2\n9,0\n");
    const std::string inflows =
        "[[inflow]]\nname = \"bent\"\nline = [[20.2, 3.1], [22.7, 9.9], [21.0, 14.0]]\nvelocity = 1.5\ntowards = [30, "
        "9]\n"
        "table = \"" +
        table + "\"\n[[inflow]]\nname = \"spring\"\narea = [[50, 10], [58, 11], [55, 19]]\ntable = \"" + table +
        "\"\n[[inflow]]\nname = \"pulse\"\nline = [[60, 8], [60, 12]]\nvolume = 40\n";
    const Scene scene = scene_of(gis, kRough + kWalls + inflows);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    const double whole = 2.0 * (8.05 + 3.15 + 5.0) + 40.0;
    while (run->status().time < 50.0) {
        run->advance(50.0);
        const InflowBudget now = run->extras().inflow.value();
        CHECK(std::abs(now.volume - now.expected) < 1e-13 * whole);
    }
    CHECK(run->extras().inflow->volume == Approx(whole).epsilon(1e-13));
    CHECK_FALSE(run->more_comes());
    const Status& now = run->status();
    CHECK(std::abs(now.mass - now.mass_in) < 1e-13 * now.mass_in);
    CHECK(now.mass_left == 0.0);
    const Frame frame = run->frame();
    CHECK(frame.particles.front().count == 0);
    CHECK(frame.node("damage") == nullptr);
    CHECK(frame.node("water_depth") == nullptr);
    double volume = 0.0;
    for (const Field& field : frame.nodes)
        for (Index n = 0; n < field.count * field.components; ++n) REQUIRE(std::isfinite(field.data[n]));
    for (Index n = 0; n < 80 * 30; ++n) volume += frame.node("depth")->data[n];
    CHECK(volume == Approx(whole).epsilon(1e-12));
}

TEST_CASE("What is wrong with an inflow of water is told; without friction it has no normal speed",
          "[water][alone][inflow][scene]") {
    const FreshFolder folder;
    const std::string table = table_in(folder.path(), "0,5\n2000,5\n");
    CHECK(has(problem_of(plane(), river(table)), "water.friction by which the flow gets faster for ever"));
    CHECK(has(
        problem_of(plane(), kRough + "[[inflow]]\nname = \"a\"\nline = [[3, 5], [3, 40]]\ntable = \"" + table + "\"\n"),
        "outside of the terrain, or at its edge; expected a line on the terrain; move it inwards"));
    const Scene scene = scene_of(plane(), kRough + river(table));
    const double slope = 0.02, cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    const double depth = std::pow(0.25 * 0.0016 / (slope * std::pow(cosine, 13.0 / 3.0)), 0.3);
    CHECK(scene.inflows.at(0).speed.front() == Approx(0.5 / depth).epsilon(1e-9));
    const Scene darcy = scene_of(plane(), "friction = \"darcy_weisbach\"\ndarcy_f = 0.08\n" + river(table));
    // s^2 f kappa / (8 h cos) = g_z S
    const double q = 0.5, h = std::cbrt(q * q * 0.08 / (8.0 * 9.81 * slope * std::pow(cosine, 4.0)));
    CHECK(darcy.inflows.at(0).speed.front() == Approx(q / h).epsilon(1e-9));
}

// It was that of the grains' bed law, by which the material stopped there, or got faster for ever.
TEST_CASE("Water that flows into a mixture has the normal speed of its own friction",
          "[water][inflow][scene][mixture]") {
    const FreshFolder folder;
    const std::string table = table_in(folder.path(), "0,5\n2000,5\n");
    const double alone = scene_of(plane(), kRough + river(table)).inflows.at(0).speed.front();
    FakeGis gis = plane();
    gis.polygons["grains.geojson"] = rectangle(60.0, 3.0, 70.0, 7.0);
    for (const char* law : {"law = \"coulomb\"\nmu = 0.4\n", "law = \"coulomb\"\nmu = 0.001\n",
                            "law = \"voellmy\"\nmu = 0.001\nxi = 90\n"}) {
        INFO(law);
        const std::string grains =
            "[material]\ndensity = 1900\n[material.bed]\n" + std::string(law) +
            "[material.structure]\nlaw = \"drucker_prager\"\nfraction = 0.0\ncohesion = 0.0\n"
            "friction_angle_deg = 32\nyoung_modulus = 1e6\n[[release]]\noutline = \"grains.geojson\"\ndepth = 0.5\n";
        CHECK(scene_of(gis, kRough + river(table) + grains).inflows.at(0).speed.front() == alone);
    }
}

TEST_CASE("A case of water alone has the same bits on any threads, and when taken up again within a hydrograph",
          "[water][alone][inflow][threads]") {
    const FreshFolder folder;
    const auto z = [](double x, double y) { return 80.0 - 0.03 * x + 0.3 * std::sin(0.7 * x) * std::cos(0.9 * y); };
    FakeGis gis = ground(90, 40, 1.0, z);
    gis.polygons["lake.geojson"] = rectangle(0.0, 10.0, 20.0, 30.0);
    const Scene scene = scene_of(
        gis, kRough + "level = 80.5\nlevel_within = \"lake.geojson\"\n[water.sides]\neast = 77.6\n" +
                 "north = \"wall\"\n[[inflow]]\nname = \"river\"\nline = [[30, 12], [33, 24]]\ntowards = [40, 15]\n" +
                 "table = \"" + table_in(folder.path(), "0,2\n4,30\n9,10\n20,0\n") + "\"\n");
    const auto end_of = [&](int count) {
        const Threads threads(count);
        const std::unique_ptr<Simulation> run = make_simulation(scene);
        go_to(*run, 12.0);
        return bits_of(*run);
    };
    const std::vector<double> one = end_of(1);
    CHECK(end_of(4) == one);
    StructuredRun straight(scene), resumed(scene, Start::resumed);
    while (straight.status().time < 5.0) straight.advance(12.0);
    MemoryArchive kept;
    straight.serialize(kept);
    resumed.serialize(kept.rewind());
    CHECK(bits_of(straight) == bits_of(resumed));
    go_to(straight, 12.0), go_to(resumed, 12.0);
    CHECK(bits_of(straight) == bits_of(resumed));
    const WaterLedger& l = straight.water()->status().ledger;
    CHECK((l.left > 0.0 && l.entered > 0.0));
    const Status now = straight.status(), first = make_simulation(scene)->status();
    const Budget left = budget(first, now);
    CHECK(std::abs(left.mass_error) < 1e-13);
    const double scale = 1000.0 * (l.ground.norm() + l.walls.norm() + l.friction.norm());
    CHECK(std::hypot(left.momentum_residual[0], left.momentum_residual[1]) < 1e-12 * scale);
}

// Half pixels along the edge were as deep as those inside of the outer nodes, wherever an outline began in them.
TEST_CASE("A release of water whose outline begins within the outer pixels has the outline's volume",
          "[water][alone]") {
    FakeGis gis = channel();
    gis.polygons["release.geojson"] = rectangle(0.125, 0.0, 50.0, 2.5);
    const std::string released = "[[release]]\noutline = \"release.geojson\"\ndepth = 1.0\n[particles]\n";
    for (const char* placed :
         {"per_cell = 4\n", "per_cell = 1\n", "per_cell = 7\n", "placement = \"r2\"\n", "placement = \"slope\"\n"}) {
        CAPTURE(placed);
        const std::unique_ptr<Simulation> run = make_simulation(scene_of(gis, kWalls + released + placed));
        CHECK(run->status().mass == Approx(1000.0 * 49.875 * 2.5).epsilon(1e-12));
    }
}

TEST_CASE("A run of water alone waits for what is to come, and ends when nothing is left or moves",
          "[water][alone][inflow]") {
    const FreshFolder folder;
    const Scene scene = scene_of(plane(), kRough +
                                              "[water.sides]\neast = \"free\"\nwest = \"free\"\nsouth = \"wall\"\n"
                                              "north = \"wall\"\n" +
                                              river(table_in(folder.path(), "5,0\n6,3\n8,0\n")));
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    CHECK_FALSE(run->may_rest());
    go_to(*run, 4.0);
    CHECK(run->status().mass == 0.0);
    CHECK(run->more_comes());
    go_to(*run, 8.0);
    CHECK(run->status().mass == Approx(4500.0).epsilon(1e-12));
    CHECK((run->may_rest() && !run->more_comes()));
    CHECK(run->status().front > 0.0);
    CHECK(run->status().front < 10.0);  // from the line
    const Scene rainy = scene_of(plane(), "rain = 1e-4\n");
    CHECK((!make_simulation(rainy)->may_rest() && make_simulation(rainy)->more_comes()));
    CHECK(has(make_simulation(rainy)->why_not_add({}), "found a case of free water"));
}

// It ended after a step: still water was at rest, whatever went into the ground.
TEST_CASE("Still water is not at rest as long as the ground takes some of it", "[water][alone]") {
    const double depth = 1.0, rate = 0.1;
    const std::string pond = kWalls + "[[release]]\nsurface = 1\n", soaks = "infiltration = 0.1\n";
    CHECK(make_simulation(scene_of(ground(8, 8, 5.0, flat), pond))->may_rest());
    const Scene scene = scene_of(ground(8, 8, 5.0, flat), soaks + pond);
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    CHECK_FALSE(run->may_rest());
    go_to(*run, 0.5 * depth / rate);
    CHECK_FALSE(run->may_rest());
    CHECK(run->status().mass == Approx(0.5 * 1000.0 * 1600.0 * depth).epsilon(1e-12));
    go_to(*run, 1.01 * depth / rate);
    CHECK(run->status().mass == 0.0);
    CHECK(run->may_rest());
    // Where no water is, the ground may take some.
    FakeGis dry = ground(8, 8, 5.0, flat);
    dry.polygons["west.geojson"] = rectangle(-1.0, -1.0, 20.0, 41.0);
    dry.rasters["east.tif"] = sampled({8, 8, 2.5, 2.5, 5.0}, [](double x, double) { return x > 30.0 ? 0.1 : 0.0; });
    const std::string west = "infiltration = \"east.tif\"\nlevel = 1\nlevel_within = \"west.geojson\"\n";
    CHECK(make_simulation(scene_of(dry, west + kWalls))->may_rest());
}

TEST_CASE("Sides of water are read one by one; others are what boundary.sides says", "[water][alone][scene]") {
    const FakeGis gis = plane();
    const std::string level = "level = 300\n";
    using Is = WaterPhase::Side::Is;
    const WaterPhase plain = scene_of(gis, level).water.value();
    for (const WaterPhase::Side& side : plain.sides) CHECK(side.is == Is::as_sides);
    const Scene given = scene_of(gis, level + "[water.sides]\nwest = \"wall\"\neast = 299.5\nsouth = \"free\"\n");
    const auto& sides = given.water->sides;
    CHECK((sides[0].is == Is::wall && sides[1].is == Is::level && sides[2].is == Is::free &&
           sides[3].is == Is::as_sides));
    CHECK(sides[1].level == 299.5);
    const WaterScene made = two_phase_scene(given).water;
    CHECK(made.sides == std::array<WaterSide, 4>{WaterSide::wall, WaterSide::level, WaterSide::free, WaterSide::open});
    CHECK(made.side_levels[1] == 299.5);
    CHECK(has(said_of(gis, level + "[water.sides]\neast = 299.5\n"),
              "water.sides.east: 299.5 m stands over 10 m of that side, 1.09 m deep at most"));
    CHECK(
        has(said_of(gis, level + "[water.sides]\neast = 200\n"), "below all ground there, 298.41 m; water falls out"));
    CHECK(has(problem_of(gis, level + "[water.sides]\neast = \"open\"\n"), "water.sides.east"));
}

}  // namespace frana::flood_test
