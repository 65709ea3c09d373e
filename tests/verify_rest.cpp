// What must not move: lakes (to round-off) and piles below their friction angle (to the last bit).
#include "analytic_scene.h"
#include "base/constants.h"
#include "catch.h"
#include "fake_gis.h"
#include "scene/build_scene.h"

using namespace frana;
using namespace frana::test;

namespace {

Function z1() {
    return [](double x, double y) { return 5 * std::exp(-0.4 * ((x - 5) * (x - 5) + (y - 5) * (y - 5))); };
}
Function z2() {
    return [](double x, double y) { return x >= 4 && x <= 8 && y >= 4 && y <= 8 ? 4.0 : 0.0; };
}
Function island() {
    return [](double x, double y) { return 12 * std::exp(-0.4 * ((x - 5) * (x - 5) + (y - 5) * (y - 5))); };
}

Scene lake(const Function& z, double shift) {
    Scene scene = scene_on(51, 51, 0.2, z);
    scene.sides = Sides::wall;
    scene.still_surface = 10.0;
    frana::test::fill(
        scene, [&](double x, double y) { return 10.0 - z(x, y); }, 2, shift, 2.2 * shift);
    return scene;
}

}  // namespace

// Fois et al. 2024, section 4.1, table 1; the still level is used for the initial masses only. The bound is
// round-off: 100 steps of 1e-14 m/s each; the finding is 3e-14 to 6e-14 m/s.
TEST_CASE("A lake at rest stays at rest on a bump, a step and around an island, wherever its points stand", "[lake]") {
    for (const auto& [name, z] : {std::pair{"Z1", z1()}, std::pair{"Z2", z2()}, std::pair{"island", island()}})
        for (const double shift : {0.0, 0.13})
            for (const TerrainModel terrain : {TerrainModel::steep, TerrainModel::shallow}) {
                Scene scene = lake(z, shift);
                scene.terrain = terrain;
                DepthAveraged simulation(scene);
                const double mass = simulation.status().mass;
                run_to(simulation, 1.0);
                const Frame frame = simulation.frame();
                CAPTURE(name, shift, frame.status.max_speed_on_map);
                CHECK(frame.status.max_speed_on_map <= 1e-12);
                CHECK(mass_error(frame.status, mass) <= 1e-13);
                double worst = 0.0;
                for (Index k = 0; k < frame.node("depth")->count; ++k)
                    if (frame.node("depth")->data[k] > 1.0)  // away from the island's shore, where depth + z is lifted
                        worst = std::max(worst, std::abs(frame.node("surface")->data[k] - 10.0));
                CHECK(worst <= 1e-11);
            }
}

TEST_CASE("A lake with fitted masses rests to the last bit: the round-off of its height is no slope", "[lake]") {
    for (const auto& z : {z1(), z2(), island()}) {
        DepthAveraged simulation(lake(z, 0.13));
        run_to(simulation, 0.5);
        CHECK(simulation.status().max_speed_on_map == 0.0);
    }
}

// Section 4.1 as the authors ran it: bilinear shapes, PIC, the level known. Table 1 has 2e-12 and 3e-13.
TEST_CASE("In the paper preset a lake of known level stays at rest", "[lake][paper]") {
    for (const auto& z : {z1(), z2()}) {
        Scene scene = lake(z, 0.0);
        scene.terrain = TerrainModel::shallow;
        scene.curvature = Curvature::none;
        scene.scheme.shape = Shape::linear;
        scene.scheme.transfer = Transfer::pic;
        scene.scheme.paper_pressure = true;
        scene.scheme.split = false;
        scene.scheme.filter = scene.scheme.viscosity_linear = scene.scheme.viscosity_quadratic = 0.0;
        scene.scheme.still_level = 10.0;
        DepthAveraged simulation(scene);
        run_to(simulation, 1.0);
        CHECK(simulation.frame().status.max_speed_on_map <= 1e-12);
    }
}

TEST_CASE("A pile below its friction angle does not move by one bit", "[rest]") {
    struct Pile {
        double slope, surface, mu;
    };
    for (const Pile& pile : {Pile{0.2, 0.3, 0.6}, Pile{0.7, 0.2, 1.1}})
        for (const double turn : {0.0, 27.0, 45.0}) {
            const double c = std::cos(turn * constants::kPi / 180.0), s = std::sin(turn * constants::kPi / 180.0);
            Scene scene = scene_on(61, 61, 1.0, [&](double x, double y) { return 100 - pile.slope * (c * x + s * y); });
            scene.bed_law = bed::Coulomb{pile.mu};
            frana::test::fill(scene, [&](double x, double y) { return 4 - pile.surface * std::hypot(x - 30, y - 30); });
            DepthAveraged simulation(scene);
            const Particles before = simulation.flow().particles;
            run_to(simulation, 5.0);
            CAPTURE(pile.slope, turn);
            CHECK(simulation.status().max_speed_on_map == 0.0);
            CHECK(simulation.flow().particles.x == before.x);
            CHECK(simulation.flow().particles.y == before.y);
            RestRule rule(1.0, 0.05);
            rule.note(simulation);
            CHECK(rule.at_rest());
        }
}

TEST_CASE("A slab holds at tan(th) = mu and slides just below it", "[rest]") {
    const double slope = std::tan(constants::kPi / 6);
    for (const double factor : {1.0 + 1e-9, 1.0 - 1e-4}) {
        Scene scene = scene_on(41, 41, 2.0, [&](double x, double) { return 100 - slope * x; });
        scene.bed_law = bed::Coulomb{slope * factor};
        // a slab without margins in the middle of the slope: thin enough that its rim hardly pushes
        frana::test::fill(scene, [](double x, double y) { return std::hypot(x - 40, y - 40) < 20 ? 1e-6 : 0.0; });
        DepthAveraged simulation(scene);
        run_to(simulation, 2.0);
        double fastest = simulation.status().max_speed_on_map;
        if (factor > 1.0)
            CHECK(fastest < 1e-5);  // the rim's own slope, 1e-6 m over a cell, may creep below mu's margin
        else
            CHECK(fastest > 0.5 * 1e-4 * slope * 9.81 * 0.75 * 2.0);
    }
}

TEST_CASE("A lake within an outline that holds its shore rests to the last bit, one cut through moves", "[lake]") {
    FakeGis gis;
    const auto bowl = [](double x, double y) { return 0.002 * ((x - 150) * (x - 150) + (y - 150) * (y - 150)); };
    gis.rasters["dem.tif"] = sampled({61, 61, 0.0, 0.0, 5.0}, bowl);
    gis.polygons["wide.geojson"] = rectangle(60, 60, 240, 240);  // the shore is a circle of radius 70.7 m
    gis.polygons["narrow.geojson"] = rectangle(60, 60, 170, 240);
    const auto fastest = [&](const std::string& outline) {
        const std::string text = "[terrain]\ndem = \"dem.tif\"\n[[release]]\n" + outline +
                                 "surface = 10.0\n[material]\ndensity = 1000.0\n[time]\nend = 1.0\n";
        DepthAveraged simulation(build_scene(CaseFile::parse(text, "lake/case.toml"), gis));
        run_to(simulation, 0.5);
        return simulation.status().max_speed;
    };
    CHECK(fastest("") == 0.0);
    CHECK(fastest("outline = \"wide.geojson\"\n") == 0.0);
    CHECK(fastest("outline = \"narrow.geojson\"\n") > 1.0);
}
