// Peaks on rough terrain: what a dam is designed by must not grow with every finer cell.
#include <algorithm>
#include <cstdint>

#include "analytic_scene.h"
#include "catch.h"
#include "run/simulation.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kPixel = 2.5, kNoise = 0.5;  // [m]

/// Even in (-1, 1), of the pixel alone.
double noise_of(Index i, Index j) {
    std::uint64_t bits = static_cast<std::uint64_t>(i + 4096) * 0x9E3779B97F4A7C15u ^
                         static_cast<std::uint64_t>(j + 4096) * 0xC2B2AE3D27D4EB4Fu;
    bits ^= bits >> 29, bits *= 0xBF58476D1CE4E5B9u, bits ^= bits >> 32;
    return 2.0 * static_cast<double>(bits >> 11) / 9007199254740992.0 - 1.0;
}

/// Noise with a standard deviation of kNoise at the pixels of an elevation model, bilinear between them.
double roughness(double x, double y) {
    const double u = x / kPixel, v = y / kPixel, at_x = std::floor(u), at_y = std::floor(v), fx = u - at_x,
                 fy = v - at_y;
    const Index i = static_cast<Index>(at_x), j = static_cast<Index>(at_y);
    const double low = (1 - fx) * noise_of(i, j) + fx * noise_of(i + 1, j);
    const double high = (1 - fx) * noise_of(i, j + 1) + fx * noise_of(i + 1, j + 1);
    return kNoise * std::sqrt(3.0) * ((1 - fy) * low + fy * high);
}

/// A channel that falls by 40 degrees and runs out on a level plain, 100 m wide, under snow with Voellmy's friction.
double track(double x, double y) {
    const double run = std::max(0.0, 500.0 - x), fall = std::min(run, 300.0);
    return fall * fall / 600.0 * std::tan(0.6981) + std::max(0.0, run - 300.0) * std::tan(0.6981) +
           0.002 * (y - 100.0) * (y - 100.0);
}

Scene rough_path(double cell) {
    const auto nodes = [&](double length) { return static_cast<Index>(length / cell) + 1; };
    Scene scene =
        scene_on(nodes(800), nodes(200), cell, [](double x, double y) { return track(x, y) + roughness(x, y); });
    scene.density = 250.0;
    scene.bed_law = bed::Voellmy{0.2, 2000.0};
    fill(scene, [](double x, double y) {
        return std::max(0.0, 2.0 * (1.0 - ((x - 60) * (x - 60) + (y - 100) * (y - 100)) / 1600.0));
    });
    return scene;
}

struct Outcome {
    double high_speed =
        0.0;  ///< 99.9th percentile of the peak speed, of nodes ever deeper than the footprint depth [m/s]
    double over_line = 0.0;              ///< worst peak speed over what the energy line allows at the node [1]
    double fastest = 0.0, raster = 0.0;  ///< of the status, of the peaks [m/s]
};

Outcome run_down(double cell) {
    const Scene scene = rough_path(cell);
    DepthAveraged simulation(scene);
    const Frame start = simulation.frame();
    double top = 0.0;
    for (Index p = 0; p < start.particle("surface")->count; ++p)
        top = std::max(top, start.particle("surface")->data[p]);
    Outcome outcome;
    while (simulation.status().time < 40.0) {
        simulation.advance(40.0);
        outcome.fastest = std::max(outcome.fastest, simulation.status().max_speed);
    }
    const Frame end = simulation.frame();
    const Field &speed = *end.node("peak_speed"), &depth = *end.node("peak_depth"), &z = *end.node("elevation");
    std::vector<double> speeds;
    for (Index k = 0; k < speed.count; ++k) {
        outcome.raster = std::max(outcome.raster, speed.data[k]);
        if (depth.data[k] > scene.output.footprint_depth) speeds.push_back(speed.data[k]);
        const double bound = std::sqrt(2.0 * scene.gravity * std::max(0.0, top - z.data[k]));
        if (bound > 3.0) outcome.over_line = std::max(outcome.over_line, speed.data[k] / bound);
    }
    std::sort(speeds.begin(), speeds.end());
    outcome.high_speed = speeds[static_cast<std::size_t>(0.999 * static_cast<double>(speeds.size() - 1))];
    return outcome;
}

}  // namespace

// Along the slope of the node's own bed the three percentiles are 34.1, 35.1 and 35.4 m/s: they go on growing.
TEST_CASE("Peak speeds on a rough path do not grow with finer cells, nor beyond the energy line", "[conserve]") {
    const Outcome coarse = run_down(10.0), middle = run_down(5.0), fine = run_down(2.5);
    CAPTURE(coarse.high_speed, middle.high_speed, fine.high_speed, coarse.over_line, middle.over_line, fine.over_line);
    CHECK(std::abs(middle.high_speed - coarse.high_speed) <
          0.03 * middle.high_speed);  // a figure that a dam is designed by
    CHECK(std::abs(fine.high_speed - middle.high_speed) < 0.03 * fine.high_speed);
    for (const Outcome& of : {coarse, middle, fine}) {
        CHECK(of.over_line < 1.01);
        CHECK(of.fastest == of.raster);  // one speed: what the report names is what the map shows
    }
}

TEST_CASE("Particles show the pressure of the bed's curvature, as nodes do", "[conserve]") {
    // A quadric has the same Hessian everywhere, also when smoothed, and its slope is linear: both are exact at any place.
    constexpr double hxx = 0.012, hyy = -0.03, hxy = 0.01, vx = 6.0, vy = -9.0;
    for (const Curvature curvature : {Curvature::full, Curvature::none}) {
        Scene scene = scene_on(61, 61, 2.0, [](double x, double y) {
            const double a = x - 60, b = y - 60;
            return 50 + 0.5 * hxx * a * a + hxy * a * b + 0.5 * hyy * b * b;
        });
        scene.curvature = curvature;
        scene.scheme.curvature_length = 4.0;  // the grid's sides are ten of it away
        fill(scene, [](double x, double y) { return std::hypot(x - 60, y - 60) < 30 ? 1.5 : 0.0; });
        std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), vx);
        std::fill(scene.particles.vy.begin(), scene.particles.vy.end(), vy);
        DepthAveraged simulation(scene);
        const Frame frame = simulation.frame();
        const double *position = frame.particle("position")->data, *depth = frame.particle("depth")->data,
                     *pressure = frame.particle("pressure")->data;
        const double bend = curvature == Curvature::full ? hxx * vx * vx + 2 * hxy * vx * vy + hyy * vy * vy : 0.0;
        REQUIRE((bend == 0.0 || bend < -2.0));
        int inside = 0;
        for (Index p = 0; p < frame.particle("depth")->count; ++p) {
            const double a = position[3 * p] - 60, b = position[3 * p + 1] - 60;
            if (std::hypot(a, b) > 20) continue;
            const double bx = hxx * a + hxy * b, by = hxy * a + hyy * b;
            const double exact = scene.density * (scene.gravity + bend) * depth[p] / (1 + bx * bx + by * by);
            CHECK(pressure[p] == Approx(exact).epsilon(1e-9));  // round-off of second differences of 50 m over 4 m^2
            ++inside;
        }
        CHECK(inside > 1000);
        const Index middle = 30 * frame.grid.nx + 30;
        CHECK(frame.grid.nx == 61);
        CHECK(frame.node("pressure")->data[middle] ==
              Approx(scene.density * (scene.gravity + bend) * frame.node("depth")->data[middle]).epsilon(1e-9));
    }
}

TEST_CASE("The speed at a place on a slope is that along the bed, as frames have it", "[peaks]") {
    constexpr double slope = 0.75;
    Scene scene = scene_on(41, 41, 1.0, [](double x, double) { return 60.0 - slope * x; });
    fill(scene, [](double x, double y) { return x > 5 && x < 35 && y > 5 && y < 35 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 4.0);
    DepthAveraged run(scene);
    run_to(run, 0.05);
    const Sample there = run.at({20.0, 20.0});
    REQUIRE(there.velocity.x() > 3.0);
    CHECK(there.speed == Approx(there.velocity.norm() * std::hypot(1.0, slope)).epsilon(1e-9));
}

namespace {

/// What a run tells of itself at its steps, and what its peaks show at the end.
struct Told {
    double depth = 0.0, speed = 0.0;            ///< largest of the steps' statuses [m], [m/s]
    double peak_depth = 0.0, peak_speed = 0.0;  ///< largest of the nodes at the end
};

double largest(const Field& field) { return *std::max_element(field.data, field.data + field.count); }

Told told_by(const Scene& scene) {
    const std::unique_ptr<Simulation> run = make_simulation(scene);
    Told told;
    const auto note = [&] {
        told.depth = std::max(told.depth, run->status().max_depth);
        told.speed = std::max(told.speed, run->status().max_speed);
    };
    note();
    while (run->status().time < scene.end) run->advance(scene.end), note();
    const Frame end = run->frame();
    told.peak_depth = largest(*end.node("peak_depth")), told.peak_speed = largest(*end.node("peak_speed"));
    return told;
}

/// A slab that slides down a slope against a wall, for a second.
Scene slab() {
    Scene scene = scene_on(31, 21, 1.0, [](double x, double) { return 20.0 - 0.25 * x; });
    scene.sides = Sides::wall;
    fill(scene, [](double x, double y) { return x > 14 && x < 28 && y > 6 && y < 14 ? 1.2 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.end = 1.0;
    return scene;
}

/// The same with 3D points from one time to another.
Scene in_3d(double from, std::optional<double> until) {
    Scene scene = slab();
    SolidStage stage;
    stage.from = from, stage.until = until;
    stage.window = {17, 0, 30, 20};
    stage.cell = 0.5, stage.spacing = 0.25;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    return scene;
}

}  // namespace

TEST_CASE("The largest depth and speed that a run tells of are those of its peaks", "[peaks][stages]") {
    SECTION("of depth-averaged flow") {
        const Told told = told_by(slab());
        CHECK(told.depth == told.peak_depth);
        CHECK(told.speed == told.peak_speed);
    }
    SECTION("of an inflow, next to what holds it up") {
        Scene scene = slab();
        Inflow inflow;
        inflow.line = {{8, 2}, {12, 12}, {10, 18}};
        inflow.spacing = 0.5;
        inflow.time = {0.0, 0.5, 2.0}, inflow.discharge = {0.0, 120.0, 20.0}, inflow.speed = {1.0, 5.0, 3.0};
        scene.inflows = {inflow};
        for (const bool with_slab : {false, true}) {
            if (!with_slab) scene.particles = {};
            const Told told = told_by(scene);
            CHECK(told.depth == told.peak_depth);
            scene.particles = slab().particles;
        }
    }
    SECTION("of a release that enters later") {
        Scene scene = slab();
        Seeds late = scene.particles;
        LateRelease release;
        release.seeds = std::move(late), release.at = 0.3;
        scene.late = {release};
        const Told told = told_by(scene);
        CHECK(told.depth == told.peak_depth);
        CHECK(told.speed == told.peak_speed);
    }
    SECTION("of points in 3D") {
        const double from = GENERATE(0.0, 0.2);
        const double until = GENERATE(0.2, 0.3, 0.5);
        CAPTURE(from, until);
        Scene scene = in_3d(from, until);
        scene.end = until;  // while depths before the wall grow
        const Told told = told_by(scene);
        CHECK(told.depth == told.peak_depth);
        CHECK(told.speed >= told.peak_speed);  // the fastest point's, and cells average points
    }
    SECTION("of structured solids") {
        Scene scene = slab();
        Structure structure;
        structure.material.young = 2e6, structure.material.critical_strain = 0.05, structure.cohesion = 1e9;
        scene.structure = structure;
        if (GENERATE(false, true)) scene.water.emplace(), scene.water->share = 0.3;
        const Told told = told_by(scene);
        CHECK(told.depth == told.peak_depth);
        CHECK(told.speed == told.peak_speed);
    }
}
