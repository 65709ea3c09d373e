// What a run needs of the system's memory is told, and refused, before it is asked for.
#include "base/error.h"
#include "catch.h"
#include "convert/solid_points.h"
#include "coupling/flow_map.h"
#include "coupling/stage_conversion.h"
#include "coupling/staged_run.h"
#include "scene/build_scene.h"
#include "scene/memory_need.h"
#include "slope_case.h"

using namespace frana;
using namespace frana::test;

namespace {

const std::string kCase =
    "[terrain]\ndem = \"dem.tif\"\n[[release]]\noutline = \"release.geojson\"\ndepth = 2\n[time]\nend = 20\n"
    "[material.bed]\nlaw = \"voellmy\"\nmu = 0.2\nxi = 500\n";
const std::string kStage = "[[stage]]\nmodel = \"mpm3d\"\nwindow = [1005, 2000, 1160, 2100]\n";

Scene scene_of(const std::string& rest) { return build_scene(CaseFile::parse(kCase + rest, "case.toml"), slope_gis()); }

std::string refusal(double needed, double free) {
    try {
        require_memory(needed, free, {"terrain.window", "found 10 x 10 nodes, which", "give a smaller window"});
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("More memory than is free is refused in one sentence", "[memory]") {
    CHECK(refusal(2e9, 2e9).empty());
    CHECK(refusal(5.6e10, 2.34e10) ==
          "terrain.window: found 10 x 10 nodes, which need 56 GB; expected what fits into the 23.4 GB that are free; "
          "give a smaller window");
}

TEST_CASE("More particles than fit into memory are refused before they are made", "[memory]") {
    // 431 bytes each, and 388 more for VTK's frames. Most systems have less than that 1.6 TB.
    const std::string problem = only_problem([] { scene_of("[particles]\ncount = 2000000000\n"); });
    CHECK_THAT(problem,
               Catch::Contains("particles.count: found 2e+09 particles, which need 1.64e+03 GB; expected what fits") &&
                   Catch::Contains("give fewer of them"));
}

TEST_CASE("Particles that become points are counted before they are divided", "[memory]") {
    Scene scene = scene_of(kStage);
    const std::vector<std::uint8_t> all(static_cast<std::size_t>(scene.bed.geometry.size()), 1);
    const FlowParticles particles = particles_of(scene.particles, scene, all);
    for (const double spacing : {3.0, 1.0, 0.4, 0.21}) {
        const double cell = scene.bed.geometry.cell;
        const FlowParticles parts = in_parts(particles, spacing, cell, scene.bed, {1000.0, 2000.0, 1200.0, 2150.0});
        const PartsForecast forecast = forecast_parts(particles, spacing, cell);
        CHECK(forecast.particles == static_cast<double>(parts.count()));
        CHECK(forecast.points == forecast_points(parts, spacing));
    }
    // Divided first, each of the 240 particles would be 1e12 of them.
    scene.solid->spacing = 1e-6;
    CHECK_THROWS_WITH(StagedRun(scene),
                      Catch::StartsWith("stage.spacing = 1e-06: makes ") && Catch::Contains("give a larger spacing"));
}

// On all of the terrain the beds of particles, points and run, and depths. On the window's part what the map of points
// has.
TEST_CASE("A 3D stage asks for the memory of its nodes, those of its window above all", "[memory]") {
    Scene scene = scene_of(kStage);
    const auto asked = [&] { return memory_need(scene).nodes; };
    const double with = asked();
    const double size = double(scene.bed.geometry.size());
    const std::array<Index, 4> window = scene.solid->window;
    scene.solid->window[2] -= 10;
    const double rows = double(window[3] - window[1] + 1), map = double(sizeof(FlowMap::Node) + sizeof(NodePeak));
    CHECK(with - asked() >= 10.0 * rows * map);
    CHECK(with - asked() <= 10.0 * double(scene.bed.geometry.ny) * 2.5 * map);
    scene.solid.reset();
    CHECK(with - asked() >= size * 3.0 * sizeof(double) + double(window[2] - window[0]) * rows * map);
}

// What the map had on all of the terrain took five times as long to look at as the points themselves.
TEST_CASE("The map of points has the nodes of their window and its rim alone, with the terrain's depths", "[stages]") {
    Scene scene = scene_of(kStage);
    const std::array<Index, 4>& w = scene.solid->window;
    const FlowMap map(scene);
    const NodeBox& box = map.nodes();
    CHECK(box.nx * box.ny < scene.bed.geometry.size());
    for (const auto& [i, j] : {std::pair(w[0], w[1]), std::pair(w[2], w[3])})
        CHECK(map.number(i, j) == (j - box.j0) * box.nx + i - box.i0);
    CHECK(map.number(w[2] + 20, w[3]) == -1);
    CHECK(map.at({scene.bed.geometry.x_max(), scene.bed.geometry.y_max()}).depth == 0.0);
}
