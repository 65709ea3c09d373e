// scheme.precision = "float": what points carry is held in single precision.
#include <omp.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "checks/bench/blob.h"
#include "checks/bench/measure.h"
#include "checks/verify/trial.h"
#include "shallow/depth_averaged.h"

using namespace frana;

namespace {

Scene blob(Precision precision) {
    bench::Blob blob;
    blob.particles = 4000;
    Scene scene = bench::blob_scene(blob);
    scene.scheme.precision = precision;
    return scene;
}

}  // namespace

TEST_CASE("Single precision conserves mass to round-off of double and stays near a run in double", "[precision]") {
    DepthAveraged wide(blob(Precision::full)), narrow(blob(Precision::single));
    const double mass = narrow.status().mass;
    double moved = 0.0;
    for (const double output : {2.0, 4.0, 6.0}) {
        while (wide.status().time < output) wide.advance(output);
        while (narrow.status().time < output) {
            narrow.advance(output);
            CHECK(narrow.status().p2g_mass_error <= 1e-13);
            CHECK(narrow.status().p2g_momentum_error <= 1e-12);
            CHECK(std::abs(narrow.status().mass + narrow.status().mass_left - mass) <= 1e-13 * mass);
            moved += narrow.status().max_speed_on_map * narrow.status().dt;
        }
    }
    REQUIRE(narrow.status().step == wide.status().step);
    // A velocity is rounded once a step, by half of 2^-23 of itself and to either side: points part as in a random walk, five
    // deviations at most, and depths by as much in the same ratio.
    const double share = 5.0 * std::sqrt(static_cast<double>(narrow.status().step)) * std::ldexp(1.0, -24);
    const GridGeometry& g = wide.flow().grid.geometry();
    double apart = 0.0, deepest = 0.0;
    for (Index j = 0; j < g.ny; ++j)
        for (Index i = 0; i < g.nx; ++i) {
            const Vec2 at(g.x0 + static_cast<double>(i) * g.cell, g.y0 + static_cast<double>(j) * g.cell);
            const double a = wide.at(at).depth, b = narrow.at(at).depth;
            apart = std::max(apart, std::abs(a - b));
            deepest = std::max(deepest, a);
        }
    CAPTURE(apart, deepest, moved);
    CHECK(apart <= share * moved / g.cell * deepest);
    CHECK(apart > 0.0);
    CHECK(std::abs(wide.status().kinetic / narrow.status().kinetic - 1.0) <= share);
}

TEST_CASE("Single precision gives the same bits with one, two and four threads", "[precision][threads]") {
    bench::Blob twice;
    twice.particles = 20000;
    twice.single = true;
    const Scene scene = bench::blob_scene(twice);
    bench::Plan plan;
    plan.windows = 2;
    std::set<std::uint64_t> hashes;
    const int threads_before = omp_get_max_threads();
    for (const int threads : {1, 2, 4}) {
        plan.threads = threads;
        hashes.insert(bench::measure(scene, plan).hash);
    }
    omp_set_num_threads(threads_before);
    CHECK(hashes.size() == 1);
}

TEST_CASE("Single precision takes less than 0.7 of the memory of double", "[precision]") {
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);  // each thread has room to sort an array of doubles
    DepthAveraged wide(blob(Precision::full)), narrow(blob(Precision::single));
    for (int step = 0; step < 10; ++step) wide.advance(1e9), narrow.advance(1e9);
    // particles: 68 B of 112; sorting: 8 B of 8 for the order, 8 of 8 of scratch a thread
    CHECK(static_cast<double>(narrow.particle_bytes()) < 0.7 * static_cast<double>(wide.particle_bytes()));
    omp_set_num_threads(threads);
}

TEST_CASE("Single precision with another scheme than the default is refused", "[precision]") {
    Scene scene = blob(Precision::single);
    scene.scheme.shape = Shape::cubic;
    CHECK_THROWS(DepthAveraged(scene));
}
