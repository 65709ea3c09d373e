// Material that comes in at rest over an area: its volume, a level lake, the same bits on threads and after a resume.
#include <omp.h>

#include "analytic_scene.h"
#include "catch.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "same_run.h"
#include "shallow/depth_averaged.h"
#include "shallow/feed.h"

using namespace frana;
using namespace frana::test;

namespace {

/// Whole cells from (x0, y0) to (x1, y1) [m], two by two patches each; in all 40 layers and a half.
Inflow pool(double x0, double y0, double x1, double y1) {
    Inflow inflow;
    inflow.name = "pool";
    inflow.area = (x1 - x0) * (y1 - y0), inflow.spacing = 0.5;
    for (double y = y0 + 0.25; y < y1; y += 0.5)
        for (double x = x0 + 0.25; x < x1; x += 0.5) inflow.patches.push_back({{x, y}, 0.25 / inflow.area});
    inflow.time = {1.0, 3.0, 4.0, 9.0}, inflow.discharge = {0.0, 30.0, 10.0, 0.0};
    inflow.speed.assign(4, 0.0);
    inflow.layer = 75.0 / inflow.area / 40.5;
    return inflow;
}
constexpr double kPool = 30.0 + 20.0 + 25.0;  // [m3]

/// A box with walls; the bed is `ground`.
Scene box(const verify::Function& ground) {
    Scene scene = scene_on(25, 21, 1.0, ground);
    scene.sides = Sides::wall;
    scene.bed_law = bed::Manning{0.1, 0.0};
    return scene;
}

}  // namespace

TEST_CASE("Layers of an area are alike but for the last, and sum to the table", "[inflow][area]") {
    const Inflow of = pool(6, 6, 12, 11);
    const std::vector<InflowRow> rows = rows_of(of);
    REQUIRE(rows.size() == 41);
    double volume = 0.0, before = 1.0;
    for (const InflowRow& row : rows) {
        const double share = &row == &rows.back() ? 0.5 : 1.0;
        CHECK(row.volume == Approx(share * of.layer * of.area).epsilon(1e-9));  // times from a square root
        CHECK(row.complete > before);
        before = row.complete, volume += row.volume;
    }
    CHECK(rows.back().complete == 9.0);
    CHECK(volume == Approx(kPool).epsilon(1e-14));
}

TEST_CASE("What comes in over an area is its table's at each step, up to a layer and what waits", "[inflow][area]") {
    Scene scene = box([](double x, double) { return 0.1 * x; });
    scene.inflows = {pool(6, 6, 12, 11)};
    DepthAveraged run(scene);
    const Status first = run.status();
    while (run.status().time < 10.0) {
        run.advance(10.0);
        const Status& now = run.status();
        CHECK(std::abs(budget(first, now).mass_error) < 1e-13);
        const InflowBudget came = run.extras().inflow.value();
        CHECK(came.volume == Approx(came.expected).epsilon(1e-13));
        double by_now = 0.0;
        const Inflow& of = scene.inflows[0];
        for (std::size_t n = 0; n + 1 < of.time.size(); ++n) {
            const double s = std::clamp(now.time, of.time[n], of.time[n + 1]) - of.time[n];
            const double dq = (of.discharge[n + 1] - of.discharge[n]) / (of.time[n + 1] - of.time[n]);
            by_now += s * (of.discharge[n] + 0.5 * dq * s);
        }
        CHECK(came.volume <= by_now + 1e-9);
        // Layers wait for three ordinary steps at most; an ordinary one is half a cell at the fastest signal.
        CHECK(came.volume > by_now - kPool / 40.5 - 30.0 * 3.0 * std::max(now.dt, 0.25));
    }
    CHECK(run.status().mass_in / scene.density == Approx(kPool).epsilon(1e-14));
    CHECK_FALSE(run.more_comes());
    CHECK(run.flow().particles.count() < 41 * 120);  // 120 patches: layers at the same places were merged
}

TEST_CASE("What comes in goes on coming in when all that was there has become bed",
          "[inflow][area][deposition][forest]") {
    const bool by_trees = GENERATE(false, true);
    Scene scene = scene_on(60, 31, 1.0, [](double x, double) { return 0.3 * (60.0 - x); });
    scene.bed_law = bed::Voellmy{by_trees ? 0.1 : 0.4, 1500.0};
    scene.inflows = {pool(10, 12, 16, 17)};
    if (by_trees) {
        scene.forest.emplace();
        scene.forest->pressure = Raster::filled(scene.bed.geometry, 10'000.0);
    } else {
        scene.deposition = Deposition{0.2};
    }
    DepthAveraged run(scene);
    const Status first = run.status();
    Index empty = 0;
    while (run.status().time < 12.0) {
        const double before = run.status().time;
        run.advance(12.0);
        REQUIRE(run.status().time > before);
        CHECK(std::abs(budget(first, run.status()).mass_error) < 1e-13);
        empty += run.flow().particles.count() == 0 && run.more_comes();
    }
    CHECK(empty > 0);
    CHECK(run.status().mass_in / scene.density == Approx(kPool).epsilon(1e-14));
}

TEST_CASE("Rain on all of a box with walls lifts its water level and moves nothing", "[inflow][area]") {
    Scene scene = box([](double, double) { return 2.0; });
    scene.inflows = {pool(0, 0, 24, 20)};
    DepthAveraged run(scene);
    const Status first = run.status();
    run_to(run, 10.0);
    // Each layer comes onto what lies there. Of a level lake that is exact.
    CHECK(std::abs(budget(first, run.status()).energy_residual) < 1e-6 * std::abs(run.status().potential));
    const Frame frame = run.frame();
    const double* depth = frame.node("depth")->data;
    for (Index n = 0; n < frame.grid.size(); ++n) CHECK(depth[n] == Approx(kPool / 480.0).epsilon(1e-9));
    CHECK(run.status().max_speed < 1e-9);
}

TEST_CASE("What springs on a slope flows before it may become bed", "[inflow][area][deposition]") {
    Scene scene = box([](double x, double) { return 10.0 - 0.4 * x; });
    scene.bed_law = bed::Coulomb{0.1};
    scene.deposition = Deposition{0.0};
    scene.inflows = {pool(6, 6, 12, 11)};
    DepthAveraged run(scene);
    run_to(run, 3.0);
    CHECK(run.status().max_speed > 0.5 * 3.0);  // of 0.3 g t, at least a sixth
    CHECK(run.status().bed.deposited < 0.5 * run.status().mass_in);
}

TEST_CASE("A spring fills a closed box to its volume over its area", "[inflow][area]") {
    Scene scene = box([](double, double) { return 2.0; });
    scene.inflows = {pool(6, 6, 12, 11)};
    DepthAveraged run(scene);
    run_to(run, 120.0);
    const Frame frame = run.frame();
    const double* depth = frame.node("depth")->data;
    CHECK(run.status().mass / scene.density == Approx(kPool).epsilon(1e-13));
    // Volume over area is exact of all nodes together, and so is the area: it is the raster's, to a pixel and less.
    double volume = 0.0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i)
            volume += run.flow().share(i, j) * run.flow().area * depth[j * frame.grid.nx + i];
    CHECK(volume == Approx(kPool).epsilon(1e-13));
    CHECK(run.status().covered_area == Approx(480.0).epsilon(1e-13));
    // The level is that of a twelfth of the box. Single nodes are off by 2 % (root mean square): particles that flowed
    // stand unevenly, and pressure does not see what differs from node to node. Without scheme.wave_shift it is 6 %.
    double squares = 0.0;
    for (Index n = 0; n < frame.grid.size(); ++n) squares += std::pow(depth[n] / (kPool / 480.0) - 1.0, 2);
    CHECK(std::sqrt(squares / static_cast<double>(frame.grid.size())) < 0.03);
    CHECK(run.status().max_speed < 0.03);  // of 1.2 m/s, the speed of waves
    double most = 0.0, least = 1.0;
    for (Index tj = 0; tj < 3; ++tj)
        for (Index ti = 0; ti < 4; ++ti) {
            double sum = 0.0;
            for (Index j = 1 + 6 * tj; j < 7 + 6 * tj; ++j)
                for (Index i = 1 + 6 * ti - (ti == 3); i < 7 + 6 * ti - (ti == 3); ++i)
                    sum += depth[j * frame.grid.nx + i];
            most = std::max(most, sum / 36.0), least = std::min(least, sum / 36.0);
        }
    CAPTURE(most, least, run.status().max_speed);
    CHECK(most <= 1.02 * kPool / 480.0);
    CHECK(least >= 0.98 * kPool / 480.0);
}

TEST_CASE("An area goes on in the middle of its table with the same bits, on any number of threads",
          "[inflow][area][resume]") {
    const int threads = omp_get_max_threads();
    Scene scene = box([](double x, double y) { return 0.1 * x + 0.02 * (y - 10) * (y - 10); });
    scene.inflows = {pool(6, 6, 12, 11), pool(15, 3, 20, 8)};
    omp_set_num_threads(1);
    DepthAveraged straight(scene);
    std::vector<MemoryArchive> kept;
    while (straight.status().time < 10.0) {
        if (straight.status().step % 11 == 0) straight.serialize(kept.emplace_back());
        straight.advance(10.0);
    }
    REQUIRE(kept.size() > 3);
    const auto expected = state_bits(straight);
    for (std::size_t n = 0; n < kept.size(); ++n) {
        omp_set_num_threads(n % 2 == 0 ? 4 : 2);
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(kept[n].rewind());
        INFO("kept at " << resumed.status().time << " s");
        run_to(resumed, 10.0);
        CHECK((state_bits(resumed) == expected));
    }
    omp_set_num_threads(threads);
}
