// Holes of the elevation model inside the terrain: walls that lose nothing, or places where mass leaves and is counted.
#include <fmt/format.h>
#include <omp.h>

#include "analytic_scene.h"
#include "catch.h"
#include "fake_gis.h"
#include "observe/memory_archive.h"
#include "scene/build_scene.h"
#include "scene/scene_parts.h"

using namespace frana;
using namespace frana::test;

namespace {

enum class Outline { square, slanted, lone };

/// Where the bed of stream() has no data, in nodes: 16 of them, a slanted wall of corners, or one.
bool in_hole(Outline shape, double x, double y) {
    if (shape == Outline::square) return x >= 48 && x <= 51 && y >= 19 && y <= 22;
    if (shape == Outline::slanted) return y >= 14 && y <= 27 && x >= 34 + y && x <= 36 + y;
    return x == 50 && y == 20;
}

/// A mass that runs down a slope against a hole in the middle of its way, 25 m/s fast when it comes there.
Scene stream(Outline shape) {
    Scene scene = scene_on(100, 41, 1.0, [=](double x, double y) {
        return in_hole(shape, x, y) ? Raster::nodata : 60.0 - 0.6 * x + 0.002 * (y - 20) * (y - 20);
    });
    scene.bed_law = bed::Voellmy{0.15, 800};
    fill(scene, [](double x, double y) { return std::hypot(x - 20, y - 20) < 9 ? 2.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 15.0);
    scene.holes = holes_of(scene.bed);
    return scene;
}

Scene walled(Scene scene) {
    scene.hole_top = hole_wall_height(scene);
    return scene;
}

double energy(const Status& s) { return s.kinetic + s.potential + s.dissipated + s.energy_left; }

}  // namespace

TEST_CASE("Holes are nodes without data that the terrain surrounds, by corners too", "[holes]") {
    Raster bed = Raster::filled({9, 7, 0.0, 0.0, 1.0}, 1.0);
    for (const auto& [i, j] : {std::pair<Index, Index>{0, 3},
                               {1, 3},
                               {2, 4},  // reaches the side by a corner
                               {4, 1},
                               {5, 2},
                               {4, 4},
                               {7, 5},
                               {6, 5},
                               {7, 4}})
        bed.at(i, j) = Raster::nodata;
    const Holes holes = holes_of(bed);
    CHECK(holes.count == 3);
    CHECK(holes.nodes == std::vector<Index>{1 * 9 + 4, 2 * 9 + 5, 4 * 9 + 4, 4 * 9 + 7, 5 * 9 + 6, 5 * 9 + 7});
    CHECK(holes.largest == 3);
    CHECK(holes.first == 4 * 9 + 7);
    CHECK(holes_of(Raster::filled({5, 5, 0.0, 0.0, 1.0}, Raster::nodata)).count == 0);
}

// Round-off: mass of 1e4 terms, momentum against the weight's whole impulse. Energy: a thousandth of the motion, by choice; no order of the scheme gives it.
TEST_CASE("A stream goes round a hole that is a wall: nothing is lost, no energy is gained", "[holes]") {
    for (const Outline shape : {Outline::square, Outline::slanted, Outline::lone}) {
        const Scene scene = walled(stream(shape)), open = stream(shape);
        CAPTURE(static_cast<int>(shape), *scene.hole_top);
        DepthAveraged simulation(scene), leaves(open);
        const Status first = simulation.frame().status;
        REQUIRE(first.kinetic > 0.0);
        double most = energy(first);
        while (simulation.status().time < 2.5) {
            simulation.advance(2.5);
            most = std::max(most, energy(simulation.status()));
        }
        run_to(leaves, 2.5);
        CHECK(leaves.status().mass_left > 0.001 * first.mass);  // it does come there
        const Status& s = simulation.status();
        CHECK(s.mass_left == 0.0);
        CHECK(mass_error(s, first.mass) <= 1e-13);
        for (int axis = 0; axis < 2; ++axis)
            CHECK(std::abs(s.momentum[axis] - first.momentum[axis] - s.impulse[axis]) <=
                  1e-12 * std::abs(s.impulse[0]));
        CHECK(most - energy(first) <= 1e-3 * first.kinetic);
    }
}

TEST_CASE("A run round a hole has the same bits on any number of threads", "[holes][threads]") {
    const int before = omp_get_max_threads();
    std::vector<Particles> ends;
    for (const int threads : {1, 4}) {
        omp_set_num_threads(threads);
        Scene scene = walled(stream(Outline::slanted));
        fill(scene, [](double x, double y) { return x < 95 && x > 60 && y > 2 && y < 38 ? 0.5 : 0.0; });
        for (auto* v : {&scene.particles.vx, &scene.particles.vy}) v->resize(scene.particles.x.size(), 0.0);
        DepthAveraged simulation(scene);
        REQUIRE(simulation.flow().active.count() >= kTilesForThreads);
        run_to(simulation, 1.5);
        ends.push_back(simulation.flow().particles);
    }
    omp_set_num_threads(before);
    CHECK(ends[0].x == ends[1].x);
    CHECK(ends[0].vy == ends[1].vy);
    CHECK(ends[0].mass == ends[1].mass);
}

TEST_CASE("A run round a hole, or into it, is taken up again with the same bits and the same loss", "[holes][resume]") {
    for (const bool wall : {true, false}) {
        const Scene scene = wall ? walled(stream(Outline::square)) : stream(Outline::square);
        DepthAveraged straight(scene), resumed(scene, Start::resumed);
        run_to(straight, 1.6);
        MemoryArchive kept;
        straight.serialize(kept);
        resumed.serialize(kept.rewind());
        for (DepthAveraged* run : {&straight, &resumed}) run_to(*run, 2.5);
        CHECK(resumed.flow().particles.x == straight.flow().particles.x);
        CHECK(resumed.flow().particles.vx == straight.flow().particles.vx);
        CHECK(resumed.status().mass_left == straight.status().mass_left);
        CHECK(resumed.remarks() == straight.remarks());
        CHECK(straight.remarks().size() == (wall ? 0 : 1));
    }
}

TEST_CASE("What is lost in open holes is a remark with its number, what leaves the terrain is none of it", "[holes]") {
    Scene scene = stream(Outline::square);
    for (Index j = 0; j < 41; ++j)
        for (Index i = 80; i < 100; ++i) scene.bed.at(i, j) = Raster::nodata;  // outside of the terrain
    scene.holes = holes_of(scene.bed);
    REQUIRE(scene.holes.nodes.size() == 16);
    DepthAveraged simulation(scene);
    const double mass = simulation.status().mass;
    run_to(simulation, 2.0);
    const double in_hole = simulation.status().mass_left;  // nothing has come to the end of the terrain yet
    REQUIRE(in_hole > 0.0);
    const std::string expected = fmt::format(
        "boundary.holes: {:.6g} kg, {:.3g} % of the mass, left where the elevation model has no data inside "
        "the terrain",
        in_hole, 100.0 * in_hole / mass);
    REQUIRE(simulation.remarks().size() == 1);
    CHECK(simulation.remarks()[0].find(expected) == 0);
    run_to(simulation, 6.0);
    REQUIRE(simulation.status().mass_left > in_hole + 0.1 * mass);
    double said = 0.0;
    REQUIRE(std::sscanf(simulation.remarks()[0].c_str(), "boundary.holes: %lf kg", &said) == 1);
    CHECK(said < 0.9 * simulation.status().mass_left);
}

TEST_CASE("Frames have no elevation in holes, walls or not, and maps of speed no peak next to them", "[holes]") {
    const Scene scene = walled(stream(Outline::square));
    DepthAveraged simulation(scene);
    const double top = 60.0 + 2.0 + 0.5 * 225 * 1.36 / 9.81;  // energy line at the start
    run_to(simulation, 2.5);
    const Frame frame = simulation.frame();
    const double* z = frame.node("elevation")->data;
    const double* v = frame.node("peak_speed")->data;
    for (Index k = 0; k < scene.bed.geometry.size(); ++k) {
        CHECK(std::isnan(z[k]) == std::isnan(scene.bed.values[static_cast<std::size_t>(k)]));
        if (std::isfinite(z[k])) CHECK(v[k] <= std::sqrt(2 * 9.81 * (top - (60.0 - 0.6 * double(k % 100)))) * 1.01);
    }
}
