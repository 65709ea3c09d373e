// What `frana check` foretells of a 3D stage, and what the stage then takes.
#include "catch.h"
#include "coupling/staged_run.h"
#include "fake_gis.h"
#include "frana_check_stage.h"
#include "scene/build_scene.h"

using namespace frana;

namespace {

/// A slope of 1 in 2 down to the west, then flat ground: 160 x 24 nodes, 5 m apart.
FakeGis run_out() {
    FakeGis gis;
    gis.rasters["dem.tif"] =
        sampled({160, 24, 2.5, 2.5, 5.0}, [](double x, double) { return 100.0 + 0.5 * std::max(0.0, x - 200.0); });
    gis.polygons["above.geojson"] = rectangle(640, 30, 700, 90);
    gis.polygons["below.geojson"] = rectangle(60, 30, 120, 90);
    return gis;
}

Scene scene_with(const std::string& release, double end, const std::string& stage) {
    return build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"" + release +
                                           "\"\ndepth = 1.5\n[material.bed]\nlaw = \"voellmy\"\nmu = 0.2\nxi = 2000\n"
                                           "[time]\nend = " +
                                           std::to_string(end) + "\n" + stage,
                                       "case.toml"),
                       run_out());
}

/// Steps and the most points of a stage.
struct Taken {
    double steps = 0.0, points = 0.0;
};
Taken taken_by(const Scene& scene) {
    StagedRun run(scene);
    Taken taken;
    while (run.status().time < scene.end) {
        run.advance(scene.end);
        if (!run.points() || run.points()->body().points.count() == 0) continue;
        ++taken.steps;
        taken.points = std::max(taken.points, static_cast<double>(run.points()->body().points.count()));
    }
    return taken;
}

}  // namespace

TEST_CASE("check foretells steps and points of a stage in which the flow starts within 30 %", "[check]") {
    const Scene scene = scene_with("below.geojson", 3.0, "[[stage]]\nmodel = \"mpm3d\"\ncell = 4\n");
    const StageForecast foretold = forecast_stage(scene);
    const Taken taken = taken_by(scene);
    CHECK(foretold.steps == Approx(taken.steps).epsilon(0.3));
    CHECK(foretold.points == Approx(taken.points).epsilon(0.3));
}

// Points were volume over spacing^3, though each particle becomes one at least, and sound was that of the release's
// depth: a twentieth of the points and a third of the steps. And a window had room for full points only.
TEST_CASE("check foretells steps and points of a stage that a flow comes to within a factor of two", "[check]") {
    const std::string cell = GENERATE("8", "20");
    CAPTURE(cell);
    const Scene scene =
        scene_with("above.geojson", 37.0,
                   "[[stage]]\nmodel = \"depth_averaged\"\nuntil = 25\n[[stage]]\nmodel = \"mpm3d\"\nwindow = [0, 0, "
                   "250, 120]\ncell = " +
                       cell + "\n");
    const StageForecast foretold = forecast_stage(scene);
    const Taken taken = taken_by(scene);
    REQUIRE(taken.points > 100.0);
    CAPTURE(foretold.steps, taken.steps, foretold.points, taken.points, foretold.speed);
    CHECK(foretold.steps < 2.0 * taken.steps);
    CHECK(foretold.steps > 0.5 * taken.steps);
    CHECK(foretold.points < 2.0 * taken.points);
    CHECK(foretold.points > 0.5 * taken.points);
}
