// A run with a 3D stage on a part of a large terrain: the part grows, and no result depends on what else there is.
#include <memory>
#include <sstream>

#include "base/error.h"
#include "catch.h"
#include "coupling/staged_run.h"
#include "fake_gis.h"
#include "growing_slide.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "run/run_loop.h"
#include "same_run.h"
#include "scene/build_scene.h"
#include "scene/memory_need.h"
#include "slope_case.h"
#include "terrain/part_of.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kFrom = 5.0, kUntil = 12.0;
constexpr NodeBox kStart{720, 100, 160, 200};  ///< nodes of the large terrain around the start
constexpr NodeBox kBand{397, 0, 520, 400};     ///< all that the run ever needs, no multiple of a tile away

/// The slide becomes 3D points 40 m from its start, meets a low dam, and leaves the window 100 m from it.
Scene with_stage(Scene scene) {
    SolidStage stage;
    stage.from = kFrom;
    stage.until = kUntil;
    stage.window = {60, 86, 72, 114};  // x 3900 to 3960, y 930 to 1070, of the nodes that the run begins with
    stage.cell = 2.5;
    stage.spacing = 1.25;
    stage.law = solid::Fluid{};
    stage.bed_friction = 0.1;
    scene.solid = stage;
    Barrier dam;
    dam.name = "dam";
    dam.line = {{3925.0, 940.0}, {3925.0, 1060.0}};
    dam.wet_left = false;
    dam.thickness = 6.0;
    dam.height = 1.0;
    scene.barriers = {dam};
    return scene;
}

Scene on_large() { return with_stage(slide_on(kLarge, kStart)); }
Scene on_cut() {
    return with_stage(slide_on(kBand.of(kLarge), {kStart.i0 - kBand.i0, kStart.j0 - kBand.j0, kStart.nx, kStart.ny}));
}
Scene on_all() {
    Scene scene = on_large();
    scene.bed = ground_on(kLarge);
    scene.wider.reset();
    for (std::size_t side = 0; side < 4; ++side) scene.solid->window[side] += side % 2 == 0 ? kStart.i0 : kStart.j0;
    return scene;
}

bool has_grown(const StagedRun& run) { return !(run.ground()->geometry == kStart.of(kLarge)); }
bool is_in_3d(const StagedRun& run) { return run.points() && run.points()->status().points > 0; }

}  // namespace

TEST_CASE("A run with a 3D stage on a part of a terrain has the same bits whatever lies beyond",
          "[terrain][stages][barrier]") {
    StagedRun large(on_large()), cut(on_cut());
    const Status first = large.status();
    bool grew_in_3d = false, returned = false;
    for (double time = 0.5; time <= kUntil + 0.5; time += 0.5) {
        for (StagedRun* run : {&large, &cut})
            while (run->status().time < time) {
                run->advance(time);
                CHECK(std::abs(budget(first, run->status()).mass_error) < 1e-13);
            }
        grew_in_3d = grew_in_3d || (is_in_3d(large) && has_grown(large));
        returned = returned || (is_in_3d(large) && large.points()->status().mass_left > 0.0);
        require_same(large, cut);
    }
    CHECK(grew_in_3d);
    CHECK(returned);
    CHECK_FALSE(is_in_3d(large));
    CHECK(large.loads()->barriers.at(0).touched);
    CHECK(large.loads()->barriers.at(0).overtopped > 0.0);
    CHECK(std::abs(large.status().mass_left) < 1e-13 * first.mass);  // of what went in and out of the window
    const Frame frame = large.frame();
    CHECK(frame.grid.x0 < kLarge.x(kStart.i0) + 200.0);
    CHECK(frame.grid.size() < large.ground()->geometry.size());
}

TEST_CASE("Growing changes a run with a 3D stage by round-off only", "[terrain][stages]") {
    StagedRun part(on_large()), all(on_all());
    while (!has_grown(part)) {
        part.advance(kUntil), all.advance(kUntil);
        REQUIRE(part.status().time < kUntil);
    }
    REQUIRE(is_in_3d(part));
    for (int step = 0; step < 20; ++step) part.advance(kUntil), all.advance(kUntil);
    // As in depth-averaged runs: places counted from other nodes. Points begin from particles that differ so.
    CHECK(part.status().step == all.status().step);
    CHECK(part.status().particles == all.status().particles);
    CHECK(part.status().kinetic == Approx(all.status().kinetic).epsilon(1e-9));
    CHECK(part.status().dissipated == Approx(all.status().dissipated).epsilon(1e-9));
    CHECK(part.status().mass == Approx(all.status().mass).epsilon(1e-13));
    const Vec2 crest(3925.0, 1000.0);
    CHECK(part.at(crest).elevation == Approx(all.at(crest).elevation).epsilon(1e-12));
    CHECK(part.at(crest).depth == Approx(all.at(crest).depth).margin(1e-9));
    const Frame shown = part.frame(), whole = all.frame();
    const NodeBox box = box_of(shown.grid, whole.grid).value();
    for (const char* name : {"elevation", "depth", "surface", "speed", "peak_depth", "pressure"}) {
        CAPTURE(name);
        const double *found = shown.node(name)->data, *expected = whole.node(name)->data;
        double largest = 0.0, off = 0.0;
        for (Index k = 0; k < shown.grid.size(); ++k) {
            const double there = expected[(box.j0 + k / box.nx) * whole.grid.nx + box.i0 + k % box.nx];
            largest = std::max(largest, std::abs(there)), off = std::max(off, std::abs(found[k] - there));
        }
        CHECK(largest > 0.0);
        CHECK(off < 1e-6 * largest);  // a node at the margin has a thousandth of the mass that sums are made of
    }
}

TEST_CASE("A run with a 3D stage on a part goes on from a saved state with the same bits, grown or not",
          "[terrain][stages]") {
    StagedRun run(on_large());
    for (const double stop : {2.0, 6.0, 0.0, 10.0, kUntil + 0.5}) {  // 0: as soon as it has grown
        while (run.status().time < stop || (stop == 0.0 && !has_grown(run))) run.advance(kUntil + 2.0);
        MemoryArchive archive;
        run.serialize(archive);
        StagedRun again(on_large(), Start::resumed);
        again.serialize(archive.rewind());
        CHECK(again.ground()->geometry == run.ground()->geometry);
        for (int step = 0; step < 60; ++step) run.advance(kUntil + 2.0), again.advance(kUntil + 2.0);
        require_same(run, again);
        check_same(run, again);
    }
}

TEST_CASE("A run with a 3D stage whose part may not grow ends with all its mass", "[terrain][stages]") {
    Scene scene = on_large();
    scene.wider = std::make_shared<WiderTerrain>(
        WiderTerrain{kLarge, kStart, [](const NodeBox&) -> Raster { throw UserError("dem.tif: cannot be read"); }, {}});
    StagedRun part(scene);
    const Status first = part.status();
    Observers nobody;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    const RunSummary summary = run(part, {kUntil + 60.0, 1000.0, false}, nobody, Interrupt(), progress);
    CHECK(summary.reason == "refused");
    CHECK(summary.failure_text.find("more of the terrain is needed: dem.tif: cannot be read") != std::string::npos);
    CHECK(is_in_3d(part));
    CHECK(std::abs(budget(first, part.status()).mass_error) < 1e-13);
    CHECK(summary.last.mass == Approx(first.mass).epsilon(1e-13));
}

TEST_CASE("A 3D stage's window is on the part of a large terrain that a run begins with", "[terrain][stages]") {
    const GridGeometry all{10000, 10000, 0.5, 0.5, 1.0};
    LargeGis gis(all);
    gis.polygons["release.geojson"] = rectangle(5000, 5000, 5050, 5050);
    const auto scene_with = [&](const std::string& stage) {
        const std::string text =
            "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
            "[material]\ndensity = 1000\nbed = { law = \"coulomb\", mu = 0.05 }\n[[stage]]\nmodel = "
            "\"depth_averaged\"\nuntil = 5\n[[stage]]\nmodel = \"mpm3d\"\ncell = 2\n" +
            stage + "\n";
        return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
    };
    const Scene scene = scene_with("window = [4000, 4950, 4100, 5100]");
    REQUIRE(scene.wider);
    const GridGeometry& g = scene.bed.geometry;
    const std::array<Index, 4>& w = scene.solid->window;
    CHECK(g.x(w[0]) == 4000.5);
    CHECK(g.y(w[1]) == 4950.5);
    CHECK(g.x(w[2]) == 4099.5);
    CHECK(g.y(w[3]) == 5099.5);
    CHECK(g.x0 < 4000.0 - 512.0);  // what leaves the window has room
    CHECK(g.x_max() > 5050.0 + 512.0);
    // The part's nodes, the stage's rates besides; all of the terrain would need 34 GB.
    const double nodes = double(g.size());
    CHECK(nodes < 0.06 * double(all.size()));
    CHECK(memory_need(scene).nodes < memory_of_part(nodes) + memory_of_fields(scene, nodes) + 20e6);
    CHECK(memory_of_fields(scene, nodes) >= 26.0 * nodes);  // what each node has besides in a stage, as it grows too
    CHECK_THAT(only_problem([&] { scene_with("window = [4000, 4950, 10100, 5100]"); }),
               Catch::Contains("within x 0 to 10000, y 0 to 10000"));
}
