// Particles on a part of a large terrain: no result depends on what else of the terrain there is.
#include <memory>
#include <sstream>

#include "analytic_scene.h"
#include "base/error.h"
#include "catch.h"
#include "coupling/walled_particles.h"
#include "fake_gis.h"
#include "growing_slide.h"
#include "observe/memory_archive.h"
#include "run/memory_state.h"
#include "run/run_loop.h"
#include "scene/build_scene.h"
#include "slope_case.h"
#include "terrain/holes.h"

using namespace frana;
using namespace frana::test;

TEST_CASE("A run on a part of a terrain has the same bits whatever lies beyond", "[terrain]") {
    GrowingParticles large(slide_on_large()), cut(slide_on_cut());
    const NodeBox begin = large.held();
    for (double time = 2.0, after = 0.0; after < 8.0; time += 2.0, after += large.held() == begin ? 0.0 : 1.0) {
        REQUIRE(time < 60.0);
        run_to(large, time), run_to(cut, time);
        require_same(large, cut);
    }
    // It went farther than the part that it began with, to the west, and the part grew before.
    CHECK(large.held().i0 < begin.i0);
    const Frame frame = large.frame();
    const Field& peak = *frame.node("peak_depth");
    Index west = frame.grid.nx;
    for (Index k = 0; k < peak.count; ++k)
        if (peak.data[k] > 0.0) west = std::min(west, k % frame.grid.nx);
    CHECK(frame.grid.x(west) < kLarge.x(begin.i0));
    CHECK(mass_error(large.status(), 400e3) < 1e-13);
    CHECK(large.status().mass_left == 0.0);
}

TEST_CASE("A part that may not grow ends the run as refused, after the step that needed more", "[terrain]") {
    Scene scene = slide_on_large();
    scene.wider = std::make_shared<WiderTerrain>(
        WiderTerrain{kLarge, kBegin, [](const NodeBox&) -> Raster { throw UserError("dem.tif: cannot be read"); }, {}});
    GrowingParticles part(scene);
    Observers nobody;
    std::ostringstream stream;
    Progress progress(stream, Progress::Style::silent, scene.density);
    const RunSummary summary = run(part, {60.0, 1000.0, false}, nobody, Interrupt(), progress);
    CHECK(summary.reason == "refused");
    REQUIRE(summary.failure);
    CHECK_THROWS_AS(std::rethrow_exception(summary.failure), UserError);
    CHECK(summary.failure_text.find("more of the terrain is needed: dem.tif: cannot be read") != std::string::npos);
    CHECK(summary.frames == 2);
    CHECK(summary.last.time > 0.0);
    CHECK(summary.last.step == part.status().step);
}

TEST_CASE("Growing changes a run by round-off only", "[terrain]") {
    Scene whole = slide_on_large();
    whole.bed = ground_on(kLarge);
    whole.wider.reset();
    DepthAveraged all(whole);
    GrowingParticles part(slide_on_large());
    const NodeBox begin = part.held();
    while (part.held() == begin) {
        all.advance(1e9), part.advance(1e9);
        REQUIRE(all.status().time < 24.0);
    }
    for (int step = 0; step < 20; ++step) all.advance(1e9), part.advance(1e9);
    // Places in cells are counted from other nodes: they differ in their last bits, at most 1000 x 2^-53 cells each
    // step, and so do sums that follow. A thousand such steps stay below 1e-9 of what the flow has.
    CHECK(part.status().step == all.status().step);
    CHECK(std::abs(part.status().time - all.status().time) < 1e-9 * all.status().time);
    CHECK(std::abs(part.status().kinetic - all.status().kinetic) < 1e-9 * all.status().kinetic);
    CHECK(std::abs(part.status().dissipated - all.status().dissipated) < 1e-9 * all.status().dissipated);
    CHECK(part.status().mass == Approx(all.status().mass).epsilon(1e-13));
}

TEST_CASE("A part that grows onto holes holds all of the terrain, with the walls of such a run", "[terrain][holes]") {
    // A hole across the flow's way, west of the part that it begins with, and one row of outside at the terrain's edge.
    const auto with_holes = [](Raster bed) {
        const GridGeometry& g = bed.geometry;
        for (Index j = 0; j < g.ny; ++j)
            for (Index i = 0; i < g.nx; ++i) {
                const double x = g.x(i), y = g.y(j);
                if ((x > 3500.0 && x < 3530.0 && y > 900.0 && y < 1100.0) || x > 4990.0) bed.at(i, j) = Raster::nodata;
            }
        return bed;
    };
    Scene scene = slide_on_large();
    const NodeBox begin = scene.wider->held;
    REQUIRE_FALSE(has_nodata(scene.bed));
    scene.wider = std::make_shared<WiderTerrain>(
        WiderTerrain{kLarge, begin, [&](const NodeBox& box) { return with_holes(ground_on(box.of(kLarge))); }, {}});
    scene.hole_top = 12.0;
    Scene whole = slide_on_large();
    whole.wider.reset();
    whole.bed = with_holes(ground_on(kLarge));
    whole.holes = holes_of(whole.bed);
    whole.hole_top = scene.hole_top;
    REQUIRE(whole.holes.count == 1);

    GrowingParticles part(scene);
    DepthAveraged all(whole);
    while (part.held() == begin) {
        part.advance(1e9), all.advance(1e9);
        REQUIRE(part.status().time < 60.0);
    }
    CHECK(part.held() == NodeBox::all(kLarge));
    CHECK(holes_of(*part.ground()).nodes == whole.holes.nodes);
    bool told = false;
    for (const std::string& remark : part.remarks())
        told = told || remark.find("hole(s) inside the terrain") != std::string::npos;
    CHECK(told);
    {
        MemoryArchive archive;
        part.serialize(archive);
        GrowingParticles again(scene, Start::resumed);
        again.serialize(archive.rewind());
        for (int step = 0; step < 50; ++step) part.advance(1e9), again.advance(1e9);
        require_same(part, again);
    }
    run_to(part, 60.0), run_to(all, 60.0);
    CHECK(part.status().mass_left == 0.0);
    CHECK(all.status().mass_left == 0.0);
    // Places counted from other nodes differ by round-off, which a flow that meets a wall makes grow: its middle stays.
    CHECK(part.status().potential == Approx(all.status().potential).epsilon(1e-3));
}

TEST_CASE("Frames of a part show what the flow has reached, and places that are always shown", "[terrain]") {
    GrowingParticles part(slide_on_large());
    const Frame start = part.frame();
    CHECK(start.grid.nx * start.grid.ny < 100 * 100);
    CHECK(start.grid.x0 < 4000.0 - 10.0);
    CHECK(start.grid.x_max() > 4000.0 + 10.0);
    // Nodes are those of the terrain.
    CHECK(std::fmod(start.grid.x0, 5.0) == 0.0);
    const GridGeometry before = start.grid;
    run_to(part, 12.0);  // some 200 m on
    const Frame later = part.frame();
    CHECK(later.grid.x0 < before.x0);
    CHECK(later.grid.x_max() >= before.x_max());
    const Field& peak = *later.node("peak_depth");
    for (Index k = 0; k < peak.count; ++k) {
        const Index i = k % later.grid.nx, j = k / later.grid.nx;
        if (i == 0 || j == 0 || i == later.grid.nx - 1 || j == later.grid.ny - 1) REQUIRE(peak.data[k] == 0.0);
    }
    Scene scene = slide_on_large();
    auto wider = std::make_shared<WiderTerrain>(*scene.wider);
    wider->shown = {{3700.0, 900.0}, {3800.0, 950.0}};
    scene.wider = wider;
    GrowingParticles with_places(scene);
    const Frame shown = with_places.frame();
    CHECK(shown.grid.x0 <= 3700.0);
    CHECK(shown.grid.y0 <= 900.0);
}

TEST_CASE("A run on a part goes on from a saved state with the same bits, grown or not", "[terrain]") {
    GrowingParticles run(slide_on_large());
    const NodeBox begin = run.held();
    for (const bool grown : {false, true}) {
        while ((run.held() == begin) == grown || run.status().time < 3.0) run.advance(1e9);
        MemoryArchive archive;
        run.serialize(archive);
        GrowingParticles again(slide_on_large(), Start::resumed);
        again.serialize(archive.rewind());
        CHECK(again.held() == run.held());
        for (int step = 0; step < 50; ++step) run.advance(1e9), again.advance(1e9);
        require_same(run, again);
    }
}

TEST_CASE("What may split is saved with a part that has grown", "[terrain]") {
    const auto slide = [](double least) {
        Scene scene = slide_on_large();
        scene.scheme.split_min_mass = least;
        return scene;
    };
    GrowingParticles run(slide(1.0)), splits(slide(0.02));
    const NodeBox begin = run.held();
    while (run.held() == begin) run.advance(1e9);
    MemoryArchive archive;
    run.serialize(archive);
    GrowingParticles again(slide(1.0), Start::resumed);
    again.serialize(archive.rewind());
    for (int step = 0; step < 50; ++step) run.advance(1e9), again.advance(1e9);
    require_same(run, again);
    run_to(splits, run.status().time);
    CHECK(splits.status().particles > run.status().particles);  // there is something that must not split
}

TEST_CASE("A run on a part comes back to a state that was put aside, also just before it grows", "[terrain]") {
    GrowingParticles run(slide_on_large()), other(slide_on_large());
    const NodeBox begin = run.held();
    MemoryState aside;
    while (other.held() == begin) {
        aside.save(run);
        run.advance(1e9);
        run.frame();
        aside.load(run);
        run.advance(1e9);
        other.advance(1e9);
    }
    require_same(run, other);
}

TEST_CASE("A part of a terrain has a thick wall's corners, and what is off is told of the whole",
          "[terrain][barrier]") {
    const GridGeometry all{3000, 60, 2.5, 2.5, 5.0};
    LargeGis gis(all);
    gis.polygons["release.geojson"] = rectangle(1000, 100, 1040, 140);
    const auto scene_with = [&](const std::string& line) {
        const std::string text =
            "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
            "[material]\ndensity = 1000\nbed = { law = \"coulomb\", mu = 0.2 }\n[[barrier]]\nheight = 5\nthickness = "
            "60\n"
            "line = " +
            line + "\n";
        return build_scene(CaseFile::parse(text, "slide/case.toml"), gis);
    };
    // The line goes up and turns back: the outer corner is beyond it, to the east.
    const Polyline line{{5900, 80}, {6000, 150}, {5900, 220}};
    const Scene scene = scene_with("[[5900, 80], [6000, 150], [5900, 220]]");
    REQUIRE(scene.wider);
    for (const WetSide wet : {WetSide::left, WetSide::right})
        for (const Polygon& part : wall_outline(line, wet, 60.0).parts)
            for (const auto& ring : part.rings)
                for (const Vec2& corner : ring) CHECK(corner.x() < scene.bed.geometry.x_max());  // x 6105
    CHECK_THAT(only_problem([&] { scene_with("[[20000, 20], [20000, 280]]"); }),
               Catch::Contains("expected the barrier within x 0 to 15000, y 0 to 300"));
}

TEST_CASE("Barriers stand on a part that grows as on all of the terrain: the same bits, births and resume included",
          "[terrain][barrier]") {
    // A dam 4 m high across the flow's way, which the part holds from the start.
    const auto dammed = [](Scene scene) {
        Barrier dam;
        dam.name = "dam";
        dam.line = {{3850.0, 850.0}, {3850.0, 1150.0}};
        dam.thickness = 12.0;
        dam.height = 4.0;
        scene.barriers = {dam};
        return scene;
    };
    Scene on_all = dammed(slide_on_large());
    on_all.bed = ground_on(kLarge);
    on_all.wider.reset();
    WalledParticles large(dammed(slide_on_large())), cut(dammed(slide_on_cut())), all(on_all);
    const Index west = large.ground()->geometry.nx;
    while (large.ground()->geometry.nx == west) {
        for (WalledParticles* one : {&large, &cut, &all}) one->advance(1e9);
        REQUIRE(large.status().time < 60.0);
    }
    MemoryArchive archive;
    large.serialize(archive);
    WalledParticles again(dammed(slide_on_large()), Start::resumed);
    again.serialize(archive.rewind());
    CHECK(again.ground()->geometry == large.ground()->geometry);
    const double time = large.status().time + 8.0;
    for (WalledParticles* one : {&large, &cut, &again, &all}) run_to(*one, time);
    require_same(large, cut);
    require_same(large, again);
    const BarrierLoad &load = large.loads()->barriers.at(0), &whole = all.loads()->barriers.at(0);
    CHECK(load.overtopped > 0.0);
    CHECK(load.run_up > 4.0);
    for (const WalledParticles* one : {&cut, &again}) {
        CHECK(one->loads()->barriers.at(0).overtopped == load.overtopped);
        CHECK(one->loads()->barriers.at(0).run_up == load.run_up);
    }
    CHECK(large.status().particles > 64);  // some were born on the way
    // Places counted from other nodes differ in their last bits; the count of particles over the dam does not.
    CHECK(load.overtopped == Approx(whole.overtopped).epsilon(1e-9));
    CHECK(load.run_up == Approx(whole.run_up).epsilon(1e-6));
    // The ground is that without the dam.
    const GridGeometry& g = large.ground()->geometry;
    const Index i = std::lround((3850.0 - g.x0) / g.cell), j = std::lround((1000.0 - g.y0) / g.cell);
    CHECK(large.ground()->at(i, j) == ground(3850.0, 1000.0));
}
