// In-situ in a whole run: pictures and tables without frames, and failures that stop nothing.
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "base/atomic_file.h"
#include "base/constants.h"
#include "base/error.h"
#include "catch.h"
#include "fake_scene.h"
#include "fresh_folder.h"
#include "io_figures_scene.h"
#include "observe/table.h"
#include "read_layer.h"
#include "run/folder/run_folder.h"
#include "run/folder/run_insitu.h"
#include "run/folder/run_job.h"
#include "scene/case_file.h"
#include "small_disk.h"
#include "vtk_io/pvd.h"
#include "vtk_read.h"

using namespace frana;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

Insitu entry(const char* name, Insitu::Kind kind, std::vector<std::string> fields) {
    Insitu result;
    result.name = name;
    result.kind = kind;
    result.fields = std::move(fields);
    return result;
}

/// A run of the fake for 2 s with an output every 0.5 s, without frames, rasters and final figures.
struct BareRun {
    FreshFolder folder;
    RunRecord record;

    explicit BareRun(std::vector<Insitu> insitu, const std::function<void(const fs::path&)>& prepare = {}) {
        FakeSimulation simulation;
        Scene scene = fake_scene(simulation);
        scene.output.vtk = scene.output.xdmf = scene.output.geotiff = scene.output.png = false;
        scene.insitu = std::move(insitu);
        prepare_run_folder(dir());
        if (prepare) prepare(dir());
        const CaseFile file = CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\ndepth = 2\n[time]\nend = 2\n",
                                              "hill/case.toml");
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        record = carry_out(scene, simulation, dir(), begin_record(scene, file), Interrupt(), progress);
    }
    const fs::path& dir() const { return folder.path(); }
    Json json() const { return Json::parse(text_of(dir() / "run.json")); }
    std::ptrdiff_t files(const char* sub) const {
        const fs::path path = dir() / sub;
        return fs::exists(path) ? std::distance(fs::directory_iterator(path), fs::directory_iterator()) : 0;
    }
};

/// Strongly coloured pixels: how many, and their middle [px].
struct Blot {
    double count = 0.0;
    Vec2 sum{0, 0};
    explicit Blot(const fs::path& png) {
        const Pixels picture = read_png(png);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                if (figures::saturation(picture.at(x, y)) > 60) count += 1.0, sum += Vec2(x, y);
    }
};

Insitu depth_map(const char* name, double above) {
    Insitu map = entry(name, Insitu::Kind::figure, {"depth"});
    map.range = {0.0, 3.0};
    map.above = above;
    return map;
}

}  // namespace

TEST_CASE("a run without frames leaves its pictures, lines and tables", "[insitu]") {
    Insitu cut = entry("cut", Insitu::Kind::profile, {"depth", "velocity_x"});
    cut.line = {{1002, 2022}, {1030, 2013}};
    cut.every_steps = 10;
    Insitu lines = entry("lines", Insitu::Kind::contour, {"depth"});
    lines.levels = {0.5};
    Insitu deep = entry("deep", Insitu::Kind::threshold, {"depth"});
    deep.from = 1.0;
    const Insitu extremes = entry("extremes", Insitu::Kind::reduce, {"depth"});
    const BareRun run({cut, lines, deep, extremes});

    for (const char* frames : {"particles", "grid", "rasters", "figures"}) CHECK(run.files(frames) == 0);
    for (const char* file : {"grid.pvd", "particles.pvd", "terrain.vti", "run.h5", "run.xdmf"})
        CHECK_FALSE(fs::exists(run.dir() / file));
    CHECK(run.files("insitu/lines") == 5);
    CHECK(run.files("insitu/deep") == 5);
    const Table table = read_table(run.dir() / "insitu" / "cut.csv");
    std::map<double, int> rows;
    const auto &t = table.column("t"), &x = table.column("x"), &y = table.column("y"), &depth = table.column("depth");
    for (std::size_t i = 0; i < table.rows(); ++i) {
        ++rows[t[i]];
        // bilinear on 1 m cells: off by at most h''/8 in each direction, h'' <= 2/9 1/m
        CHECK(std::abs(depth[i] - FakeSimulation::depth({x[i], y[i]}, t[i])) < 2.0 / 9.0 / 8.0 * 2.0);
    }
    CHECK(rows.size() == 8);  // 4 x 17 steps: the start, every tenth step, the end
    const Table most = read_table(run.dir() / "insitu" / "extremes.csv");
    REQUIRE(most.rows() == 5);
    CHECK(most.column("t")[4] == 2.0);
    // the hill's top is at a node at t = 2 s: (1013, 2019) lies in the middle of four, 0.5 m from them in x and y
    CHECK(most.column("depth_max")[4] == Approx(FakeSimulation::depth({1012.5, 2018.5}, 2.0)).epsilon(1e-12));

    const Json json = run.json();
    CHECK(json["exit_reason"] == "end");
    REQUIRE(json["insitu"].size() == 4);
    CHECK(json["insitu"][1] ==
          Json{{"name", "lines"}, {"kind", "contour"}, {"made", 5}, {"failed", 0}, {"first_failure", ""}});
    CHECK(json["wall_seconds"]["output"].contains("insitu cut"));
    const std::string report = text_of(run.dir() / "report.md");
    for (const char* product : {"insitu/cut.csv", "insitu/lines.pvd", "`insitu/lines/`", "`insitu/deep/`"})
        CHECK(report.find(product) != std::string::npos);
}

TEST_CASE("a new run in the folder takes the pictures of the earlier one away", "[insitu]") {
    Insitu lines = entry("lines", Insitu::Kind::contour, {"depth"});
    lines.levels = {0.5};
    const BareRun run({lines});
    REQUIRE(run.files("insitu/lines") == 5);
    write_text(run.dir() / "insitu" / "lines" / "mine.txt", "kept");
    prepare_run_folder(run.dir(), {}, Overwrite::yes);
    CHECK(run.files("insitu/lines") == 1);
    CHECK_FALSE(fs::exists(run.dir() / "insitu" / "lines.pvd"));
}

TEST_CASE("works that fail are one warning each, counted in run.json, and the run ends as it would", "[insitu]") {
    Insitu missing = entry("missing", Insitu::Kind::contour, {"stress_xx"});  // the fake has no stress
    missing.levels = {1.0};
    const Insitu extremes = entry("extremes", Insitu::Kind::reduce, {"depth"});
    const BareRun run({missing, extremes});
    const Json json = run.json();
    CHECK(json["exit_reason"] == "end");
    CHECK(json["simulated_time"] == 2.0);
    CHECK(json["insitu"][0]["made"] == 0);
    CHECK(json["insitu"][0]["failed"] == 5);
    CHECK(json["insitu"][1]["made"] == 5);
    CHECK(json["insitu"][1]["failed"] == 0);
    int warnings = 0;
    for (const auto& warning : json["warnings"]) {
        const auto text = warning.get<std::string>();
        if (text.rfind("insitu missing: 5 of 5 failed, the first one at t = 0 s: found no field \"stress_xx\"", 0) == 0)
            ++warnings;
    }
    CHECK(warnings == 1);
}

TEST_CASE("a folder that cannot be written to stops no run", "[insitu]") {
    Insitu lines = entry("lines", Insitu::Kind::contour, {"depth"});
    lines.levels = {0.5};
    const Insitu extremes = entry("extremes", Insitu::Kind::reduce, {"depth"});
    const BareRun run({lines, extremes, depth_map("map", 0.1)}, [](const fs::path& dir) {
        write_text(dir / "insitu", "a file where the folder should be");  // as root no permission would stop us
    });
    const Json json = run.json();
    CHECK(json["exit_reason"] == "end");
    for (const std::size_t k : {0, 1, 2}) {
        CHECK(json["insitu"][k]["made"] == 0);
        CHECK(json["insitu"][k]["failed"] == 5);
        CHECK(json["insitu"][k]["first_failure"].get<std::string>().find((run.dir() / "insitu").string()) !=
              std::string::npos);
    }
    CHECK(read_table(run.dir() / "history.csv").column("t").back() == 2.0);
    CHECK(text_of(run.dir() / "insitu") == "a file where the folder should be");
}

TEST_CASE("a disk that is full of pictures stops no run", "[insitu]") {
    if (figures::cannot_draw()) return;
    std::optional<SmallDisk> disk;
    const Insitu extremes = entry("extremes", Insitu::Kind::reduce, {"depth"});
    Insitu map = depth_map("map", 0.1);
    map.width = 2000;
    map.height = 1600;
    // enough for each table of this run, not for such a picture
    const BareRun run({map, extremes}, [&](const fs::path&) { disk.emplace(65536); });
    disk.reset();
    CHECK(run.record.summary.reason == "end");
    CHECK(run.record.insitu[0].made == 0);
    CHECK(run.record.insitu[0].failed == 5);
    CHECK(run.record.insitu[0].first_failure.find("map_000000.png: cannot be written") != std::string::npos);
    CHECK(run.record.insitu[1].made == 5);
    CHECK(run.files("insitu/map") == 0);  // no halves either
}

TEST_CASE("lines and outlines for a GIS are those for ParaView, in the terrain's CRS and with their times",
          "[insitu]") {
    Insitu lines = entry("lines", Insitu::Kind::contour, {"depth"});
    lines.levels = {0.5, 1.0};
    Insitu deep = entry("deep", Insitu::Kind::threshold, {"depth"});
    deep.from = 1.0;
    lines.gis = deep.gis = true;
    const BareRun run({lines, deep});
    REQUIRE(run.record.insitu[0].made == 5);
    REQUIRE(run.record.insitu[1].made == 5);
    CHECK(text_of(run.dir() / "report.md").find("insitu/lines.gpkg") != std::string::npos);
    const Layer found(run.dir() / "insitu" / "lines.gpkg"), patches(run.dir() / "insitu" / "deep.gpkg");
    for (const Layer* layer : {&found, &patches}) {
        OGRSpatialReference expected;
        expected.importFromEPSG(32632);
        REQUIRE(layer->get().GetSpatialRef());
        CHECK(std::string(layer->get().GetSpatialRef()->GetAuthorityCode(nullptr)) == "32632");
        CHECK(layer->get().GetSpatialRef()->IsSame(&expected));
    }
    CHECK(std::string(found.get().GetName()) == "lines");

    std::map<double, Index> at_time;
    for (const OGRFeatureUniquePtr& feature : found.get()) {
        const double t = feature->GetFieldAsDouble("t_s"), level = feature->GetFieldAsDouble("level");
        ++at_time[t];
        CHECK(std::string(feature->GetFieldAsString("unit")) == "m");
        const double exact = FakeSimulation::width * std::sqrt(2.0 * std::log(FakeSimulation::height / level));
        for (const OGRPoint& p : *feature->GetGeometryRef()->toLineString())
            // a chord on 1 m cells, as in io_insitu.cpp
            CHECK(std::abs((Vec2(p.getX(), p.getY()) - FakeSimulation::centre(t)).norm() - exact) < 0.23 / 8.0 / 0.36);
    }
    read_back.array(found.get().GetFeatureCount());
    CHECK(at_time == std::map<double, Index>{{0.0, 2}, {0.5, 2}, {1.0, 2}, {1.5, 2}, {2.0, 2}});

    const std::vector<PvdEntry> files = read_pvd(run.dir() / "insitu" / "deep.pvd");
    REQUIRE(files.size() == 5);
    std::map<double, double> area;
    for (const OGRFeatureUniquePtr& feature : patches.get()) {
        area[feature->GetFieldAsDouble("t_s")] += feature->GetFieldAsDouble("area_m2");
        CHECK(feature->GetGeometryRef()->toPolygon()->get_Area() == Approx(feature->GetFieldAsDouble("area_m2")));
    }
    REQUIRE(area.size() == 5);
    for (const PvdEntry& file : files) {
        const auto cells = read<vtkXMLUnstructuredGridReader>(run.dir() / "insitu" / file.file);
        CHECK(area[file.time] == static_cast<double>(cells->GetOutput()->GetNumberOfCells()));  // of 1 m2
    }
}

TEST_CASE("a map made in the run shows the flow where it is", "[insitu]") {
    if (figures::cannot_draw()) return;
    const BareRun run({depth_map("map", 0.1), depth_map("nothing", 100.0)});
    CHECK(run.record.insitu[0].made == 5);
    REQUIRE(run.record.insitu[1].made == 5);
    const auto blot = [&](const char* name, int number) {
        return Blot(run.dir() / "insitu" / name / fmt::format("{}_{:06d}.png", name, number));
    };
    const Blot bar = blot("nothing", 0), first = blot("map", 0), last = blot("map", 4);
    const double flow = first.count - bar.count;
    const double area =
        2.0 * constants::kPi * 9.0 * std::log(FakeSimulation::height / 0.1);  // where it is deeper than 0.1 m
    const double pixels_per_metre = std::sqrt(flow / area);
    REQUIRE(pixels_per_metre > 5.0);
    const Vec2 moved = (last.sum - first.sum) / flow, expected = pixels_per_metre * Vec2(3.0, -1.0);  // in 2 s
    // contours, the outline and texts take away a few per cent of the coloured pixels
    CHECK((moved - expected).norm() < 0.1 * expected.norm());
    CHECK(last.count - bar.count == Approx(flow).epsilon(0.05));
}

TEST_CASE("the map of another field is outlined as that of the depth is", "[insitu]") {
    if (figures::cannot_draw()) return;
    Insitu depth = depth_map("depth_map", 0.1), speed = depth_map("speed_map", 0.1);
    speed.fields = {"speed"};  // the same everywhere in the flow, and far beyond where it counts
    speed.above.reset();
    const BareRun run({depth, speed});
    const auto last = [&](const char* name) {
        return read_png(run.dir() / "insitu" / name / fmt::format("{}_000004.png", name));
    };
    const Pixels a = last("depth_map"), b = last("speed_map");
    REQUIRE(a.width == b.width);
    REQUIRE(a.height == b.height);
    const auto lightest = [](const Pixels& picture, int x, int y) {
        const Colour c = picture.at(x, y);
        return std::max({c.r, c.g, c.b});
    };
    const auto black = [&](const Pixels& picture, int x, int y) { return lightest(picture, x, y) < 60; };
    int outline = 0, different = 0;
    for (int y = a.height / 4; y < a.height * 9 / 10; ++y)  // the map without the texts around it
        for (int x = a.width / 8; x < a.width * 3 / 4; ++x) {
            outline += black(a, x, y);
            // the edges of the line mix with the colours beside it: dark in one, at least grey in the other
            different += (black(a, x, y) && lightest(b, x, y) > 160) || (black(b, x, y) && lightest(a, x, y) > 160);
        }
    CHECK(outline > 300);
    CHECK(different < outline / 20);
}

TEST_CASE("a camera that follows the flow sees it at the same place of the picture", "[insitu]") {
    if (figures::cannot_draw()) return;
    const auto from_above = [](const char* name, double time) {
        const Vec2 c = FakeSimulation::centre(time);
        Insitu view = depth_map(name, 0.1);
        view.camera = Camera{};
        view.camera->perspective = true;
        const double ground = FakeSimulation::bed(c);
        view.camera->target = {c.x(), c.y(), ground};
        view.camera->position = {c.x(), c.y() - 10.0, ground + 40.0};
        return view;
    };
    const BareRun run({from_above("still", 0.0), from_above("there", 2.0)});
    REQUIRE(run.record.insitu[0].made == 5);
    const auto middle = [&](const char* name, int number) {
        const Blot blot(run.dir() / "insitu" / name / fmt::format("{}_{:06d}.png", name, number));
        return Vec2(blot.sum / blot.count);
    };
    const Vec2 start = middle("still", 0), later = middle("still", 4), followed = middle("there", 4);
    CHECK((later - start).norm() > 20.0);    // 3.2 m at some 20 pixels a metre, with the bar's share
    CHECK((followed - start).norm() < 3.0);  // the mesh of the terrain is cut at other places
    CHECK(later.x() > start.x() + 15.0);
    CHECK(later.y() < start.y() - 3.0);
}

TEST_CASE("a cut can be drawn besides its table", "[insitu]") {
    if (figures::cannot_draw()) return;
    Insitu cut = entry("cut", Insitu::Kind::profile, {"depth"});
    cut.line = {{1002, 2022}, {1030, 2013}};
    cut.picture = true;
    cut.width = 500;
    cut.height = 400;
    const BareRun run({cut});
    CHECK(run.record.insitu[0].made == 5);
    const Pixels first = read_png(run.dir() / "insitu" / "cut" / "cut_000000.png");
    const Pixels last = read_png(run.dir() / "insitu" / "cut" / "cut_000004.png");
    CHECK(first.width == 500);
    CHECK(first.height == 400);
    CHECK(first.rgb != last.rgb);
    CHECK(figures::count(first, colours::ground, 2) > 2000);
    CHECK(figures::count(first, curve_colour(0), 40) > 300);
}

TEST_CASE("a script that cannot run is refused before the run, in builds with Catalyst and without", "[insitu]") {
    FakeSimulation simulation;
    const FreshFolder folder;
    Scene scene = fake_scene(simulation);
    scene.insitu = {entry("mine", Insitu::Kind::catalyst, {})};
    scene.insitu[0].place = "case.toml:12: insitu.0";
    scene.insitu[0].script = folder.path() / "old.py";
    write_text(scene.insitu[0].script, "from paraview.simple import *\n");  // no version: Catalyst takes it for 1.0
    CHECK_THROWS_WITH(check_insitu(scene), Catch::StartsWith("case.toml:12: insitu.0.") &&
                                               (Catch::Contains("built without ParaView Catalyst") ||
                                                Catch::Contains("not a Catalyst script of version 2.0")));
}
