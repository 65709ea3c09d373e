// What flows as water alone by a bed law of particles: a second scheme for their equations. Exact answers, and what is
// refused.
#include <cmath>

#include "coupling/structured_run.h"
#include "scene/build_scene.h"
#include "slope_case.h"

namespace frana::flood_law_test {  // its names are other files' too
using namespace frana::test;

namespace {

constexpr double kSlope = 0.5, kCell = 1.0, kDepth = 1.0;
constexpr Index kNx = 160, kNy = 5;

/// A plane that falls to the east, all of it covered.
FakeGis covered_plane() {
    FakeGis gis;
    gis.rasters["dem.tif"] =
        sampled({kNx, kNy, 0.5 * kCell, 0.5 * kCell, kCell}, [](double x, double) { return 500.0 - kSlope * x; });
    gis.polygons["release.geojson"] = rectangle(0.0, 0.0, kNx * kCell, kNy * kCell);
    return gis;
}

Scene scene_by(const std::string& law, const std::string& more = "") {
    return build_scene(
        CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[time]\nend = 100\n[water]\nmodel = \"free\"\n" + more +
                            "[material.bed]\n" + law + "[[release]]\noutline = \"release.geojson\"\ndepth = 1.0\n",
                        "flood/case.toml"),
        covered_plane());
}

/// Depth [m] and speed on the map [m/s] of a cell in the middle of the plane's width.
struct Cell {
    double depth, speed;
};
Cell cell_at(Simulation& run, Index i) {
    const Frame frame = run.frame();
    const Index k = 2 * kNx + i;
    return {frame.node("depth")->data[k], frame.node("velocity")->data[3 * k]};
}

}  // namespace

TEST_CASE("A sheet by Voellmy's law runs down a plane to its end speed as water alone", "[water][alone]") {
    constexpr double mu = 0.2, xi = 500.0, end = 3.0;
    const std::unique_ptr<Simulation> run = make_simulation(scene_by("law = \"voellmy\"\nmu = 0.2\nxi = 500.0\n"));
    while (run->status().time < end) run->advance(end);
    const double steep = std::sqrt(1.0 + kSlope * kSlope), drive = (kSlope - mu) / steep,
                 fastest = std::sqrt(xi * kDepth / steep * drive);
    const double along = fastest * std::tanh(9.81 * drive * end / fastest);
    // The front of the wave from the upper edge, which runs at the flow's speed and that of waves, has come 35 m far.
    const Cell cell = cell_at(*run, 120);
    CHECK(cell.depth == Approx(kDepth).epsilon(1e-9));
    CHECK(cell.speed == Approx(along / steep).epsilon(1e-3));  // second order in steps of 0.05 s, of a time of 2 s
}

TEST_CASE("A sheet that its bed holds stands as water alone", "[water][alone]") {
    const std::unique_ptr<Simulation> run =
        make_simulation(scene_by("law = \"coulomb\"\nmu = 0.6\n", "[boundary]\nsides = \"wall\"\n"));
    while (run->status().time < 5.0) run->advance(5.0);
    for (const Index i : {60, 80, 100}) {
        CHECK(cell_at(*run, i).speed == 0.0);
        CHECK(cell_at(*run, i).depth == Approx(kDepth).epsilon(1e-12));
    }
}

// Nothing flows across the slope, and so strips that are as deep as each other run down it side by side, each at its own speed.
TEST_CASE("Sheets of water side by side run as fast as the friction of their zone lets them", "[water][alone][zones]") {
    const double steep = std::sqrt(1.0 + kSlope * kSlope), drive = kSlope / steep, thick = kDepth / steep;
    const auto manning = [&](double n) { return std::pow(thick, 2.0 / 3.0) * std::sqrt(drive) / n / steep; };
    const auto voellmy = [&](double mu) { return std::sqrt(50.0 * thick * (kSlope - mu) / steep) / steep; };
    FakeGis gis = covered_plane();
    gis.polygons["south.geojson"] = rectangle(-1.0, -1.0, kNx * kCell + 1.0, 2.0);
    gis.rasters["n.tif"] =
        sampled(gis.rasters["dem.tif"].geometry, [](double, double y) { return y < 2.0 ? 0.2 : 0.1; });
    const auto check = [&](const std::string& text, double south, double north) {
        CAPTURE(text);
        const Scene scene =
            build_scene(CaseFile::parse("[terrain]\ndem = \"dem.tif\"\n[time]\nend = 100\n[[release]]\noutline = "
                                        "\"release.geojson\"\ndepth = 1.0\n[water]\nmodel = \"free\"\nsides.south = "
                                        "\"wall\"\nsides.north = \"wall\"\n" +
                                            text,
                                        "flood/case.toml"),
                        gis);
        const std::unique_ptr<Simulation> run = make_simulation(scene);
        while (run->status().time < 12.0) run->advance(12.0);
        const Frame frame = run->frame();
        const auto speed = [&](Index j) { return frame.node("velocity")->data[3 * (j * kNx + 120)]; };
        // The slowest to settle, voellmy with mu = 0.3, has tanh(7.4) of its end speed, all but 7e-7.
        CHECK(speed(0) == Approx(south).epsilon(1e-5));
        CHECK(speed(1) == Approx(south).epsilon(1e-5));
        CHECK(speed(2) == Approx(north).epsilon(1e-5));
        CHECK(speed(4) == Approx(north).epsilon(1e-5));
        CHECK(frame.node("depth")->data[2 * kNx + 120] ==
              Approx(kDepth).epsilon(1e-5));  // the foot of the wave from the upper edge
    };
    const std::string zone = "[[material.zone]]\noutline = \"south.geojson\"\n";
    check("friction = \"manning\"\nmanning_n = 0.1\n" + zone + "water.manning_n = 0.2\n", manning(0.2), manning(0.1));
    check("friction = \"manning\"\nmanning_n = \"n.tif\"\n", manning(0.2), manning(0.1));
    check("[material.bed]\nlaw = \"manning\"\nmanning_n = 0.1\n" + zone + "manning_n = 0.2\n", manning(0.2),
          manning(0.1));
    check("[material.bed]\nlaw = \"manning\"\nmanning_n = \"n.tif\"\n", manning(0.2), manning(0.1));
    check("[material.bed]\nlaw = \"voellmy\"\nmu = 0.1\nxi = 50\n" + zone + "mu = 0.3\n", voellmy(0.3), voellmy(0.1));
}

TEST_CASE("Water alone has one law: water.friction or a bed law, whose numbers zones may change",
          "[water][alone][scene]") {
    const auto problem = [](const std::string& law, const std::string& more) {
        return only_problem([&] { scene_by(law, more); });
    };
    CHECK(problem("law = \"coulomb\"\nmu = 0.6\n", "friction = \"manning\"\nmanning_n = 0.03\n")
              .find("material.bed brakes what flows") != std::string::npos);
    CHECK(problem("law = \"coulomb\"\nmu = 0.6\n", "viscous = \"clear\"\n").find("material.bed brakes what flows") !=
          std::string::npos);
    CHECK(problem("law = \"coulomb\"\nmu = 0.6\n", "[[material.zone]]\nbelow = 450\nwater.manning_n = 0.3\n")
              .find("material.zone.0.water.manning_n: found, but water.friction = \"none\" does not use it") !=
          std::string::npos);
}

}  // namespace frana::flood_law_test
