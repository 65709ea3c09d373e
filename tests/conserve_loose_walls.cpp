// Barriers that stand in ground which the flow takes up, or raises by what it leaves.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "coupling/walled_particles.h"
#include "growing_slide.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "same_run.h"
#include "threads_of_test.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kLoose = 0.25;  ///< [m]

Barrier wall_of(double x0, double y0, double x1, double y1, double height) {
    Barrier wall;
    wall.name = "wall";
    wall.outline = rectangle(x0, y0, x1, y1);
    wall.height = height;
    return wall;
}

void loosen(Scene& scene, double growth = 0.05) {
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, kLoose), scene.density, erosion::Growth{growth}};
}

/// A slide that comes down a slope onto a plain and against a wall, which it passes on both sides. All ground is loose.
Scene slide(const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(120, 80, 1.0, [](double x, double) { return x < 40.0 ? 0.8 * (40.0 - x) : 0.0; });
    scene.bed_law = bed::Coulomb{0.3};
    fill(scene, [](double x, double y) {
        const double r2 = ((x - 18.2) * (x - 18.2) + (y - 40.3) * (y - 40.3)) / 144.0;
        return 2.5 * std::max(0.0, 1.0 - r2);
    });
    scene.barriers = {wall_of(52.3, 32.2, 55.1, 47.9, 3.0)};
    loosen(scene);
    if (edit) edit(scene);
    return scene;
}

void leave_deposits(Scene& scene) { scene.deposition = Deposition{1.0}; }
void plant_trees(Scene& scene) {
    scene.forest = Forest{Raster::filled(scene.bed.geometry, 0.0), {}};
    for (Index j = 0; j < scene.bed.geometry.ny; ++j)
        for (Index i = 45; i < 60; ++i) scene.forest->pressure.at(i, j) = 30.0;
}

/// A rectangle, whose nodes and those half a cell from it a barrier takes.
struct Box {
    double x0, y0, x1, y1;
    bool has(const GridGeometry& g, Index i, Index j) const {
        return std::hypot(std::max({x0 - g.x(i), 0.0, g.x(i) - x1}), std::max({y0 - g.y(j), 0.0, g.y(j) - y1})) <= 0.5;
    }
};

constexpr Box kDam{52.3, 32.2, 55.1, 47.9};

/// Whether a barrier takes a node, or one next to it.
std::vector<bool> footing(const Scene& scene, const Box& wall) {
    const GridGeometry& g = scene.bed.geometry;
    std::vector<bool> carries(scene.bed.values.size(), false);
    for (Index j = 1; j + 1 < g.ny; ++j)
        for (Index i = 1; i + 1 < g.nx; ++i)
            for (Index dj = -1; dj <= 1; ++dj)
                for (Index di = -1; di <= 1; ++di)
                    if (wall.has(g, i + di, j + dj)) carries[static_cast<std::size_t>(j * g.nx + i)] = true;
    return carries;
}

}  // namespace

TEST_CASE("What carries a barrier stays, and the ground around it is taken up", "[barrier][erosion]") {
    const Scene scene = slide();
    const std::vector<bool> carries = footing(scene, kDam);
    WalledParticles run(scene);
    const WalledParticles still(scene);
    const Flow& begin = still.particles().flow();
    const Status first = run.status();
    while (run.status().time < 15.0) {
        run.advance(15.0);
        REQUIRE(std::abs(budget(first, run.status()).mass_error) <= 1e-13);
        REQUIRE(std::abs(budget(first, run.status()).bed_error) <= 1e-13);
    }
    REQUIRE(run.loads()->barriers.at(0).run_up > 0.5);
    const Frame frame = run.frame();
    const double *change = frame.node("bed_change")->data, *z = frame.node("elevation")->data;
    Index firm = 0, moved = 0, before = 0, aside = 0, behind = 0;
    for (Index j = 0; j < frame.grid.ny; ++j)
        for (Index i = 0; i < frame.grid.nx; ++i) {
            const Index n = j * frame.grid.nx + i;
            REQUIRE(std::abs(z[n] - change[n] - begin.bed.z[begin.grid.at(i, j)]) <= 1e-12);  // of 40 m
            if (carries[static_cast<std::size_t>(n)]) ++firm, moved += change[n] != 0.0;
            if (change[n] > -0.1 * kLoose) continue;
            before += i < 50, aside += i >= 51 && i <= 56, behind += i > 58;
        }
    CHECK(moved == 0);
    CHECK(before > 100);
    CHECK(aside > 10);
    CHECK(behind > 10);
    // 15.7 x 2.8 m and half a cell, on nodes a metre apart; all of it was loose
    const std::string said = run.remarks().back();
    CHECK(said == remarks_on({static_cast<double>(firm) * kLoose, 0.0}).at(0));
    CHECK(said.find("m3 of loose ground under barriers") != std::string::npos);
    CHECK(remarks_on({}).empty());
}

TEST_CASE("Ground below the top of a buried barrier stays, and what lies over it is taken up", "[barrier][erosion]") {
    const Box wall{30.2, 36.2, 44.8, 44.4};
    constexpr double kTop = -0.125;  // on the plain below half of the loose ground; high above it is the slope
    const Scene scene = slide([&](Scene& s) {
        s.barriers = {wall_of(wall.x0, wall.y0, wall.x1, wall.y1, 0.0)};
        s.barriers[0].top = kTop;
        loosen(s, 0.2);
    });
    const std::vector<bool> carries = footing(scene, wall);
    WalledParticles run(scene);
    const Status first = run.status();
    run_to(run, 15.0);
    CHECK(std::abs(budget(first, run.status()).mass_error) <= 1e-13);
    CHECK(std::abs(budget(first, run.status()).bed_error) <= 1e-13);
    const Frame frame = run.frame();
    const double* change = frame.node("bed_change")->data;
    Index to_its_top = 0, on_the_slope = 0, around = 0;
    double firm = 0.0;
    for (Index n = 0; n < frame.grid.size(); ++n) {
        const double z = scene.bed.values[static_cast<std::size_t>(n)];
        if (!carries[static_cast<std::size_t>(n)]) {
            around += change[n] < kTop - 0.05;
            continue;
        }
        REQUIRE(z + change[n] >= kTop - 1e-15);
        to_its_top += z == 0.0 && change[n] < (1.0 - 1e-11) * kTop;  // 1e-12 of a layer stays
        on_the_slope += z > 1.0 && change[n] < kTop;
        firm += kLoose - std::min(kLoose, z - kTop);
    }
    CHECK(to_its_top > 5);
    CHECK(on_the_slope > 20);
    CHECK(around > 100);
    CHECK(run.remarks().back() == remarks_on({firm, 0.0}).at(0));
}

TEST_CASE("Trees before a barrier hold back what flows, and none stand on it", "[barrier][forest]") {
    const Scene scene = slide([](Scene& s) {
        s.erodible.reset();
        plant_trees(s);
        s.barriers[0].height = 0.5;
    });
    WalledParticles run(scene);
    run_to(run, 15.0);
    REQUIRE(run.loads()->barriers.at(0).overtopped > 1.0);
    const Frame frame = run.frame();
    const double *left = frame.node("deposited_depth")->data, *reached = frame.node("peak_depth")->data;
    const std::vector<bool> carries = footing(scene, kDam);
    CHECK(run.remarks().back() ==
          remarks_on({0.0, static_cast<double>(std::count(carries.begin(), carries.end(), true))}).at(0));
    Index over_it = 0, before = 0;
    double on_it = 0.0, among_trees = 0.0;
    for (Index n = 0; n < frame.grid.size(); ++n) {
        const Index i = n % frame.grid.nx, j = n / frame.grid.nx;
        const bool wall = kDam.has(frame.grid, i, j);
        over_it += wall && reached[n] > 0.01;
        if (wall) on_it = std::max(on_it, left[n]);
        before += i < 52 && left[n] > 0.0;
        if (!wall) among_trees = std::max(among_trees, left[n]);
    }
    CHECK(over_it > 10);
    // What is held back is nearest to a node two cells away, and moves by a quarter of one at most. This is its weight here.
    CHECK(on_it < 0.5 * 0.25 * 0.25 * among_trees);
    CHECK(before > 100);
}

TEST_CASE("Barriers in ground that sinks and rises have closed budgets, on any number of threads and resumed",
          "[barrier][erosion][deposition][forest][threads]") {
    const Threads restore;
    const Scene scene = slide([](Scene& s) { leave_deposits(s), plant_trees(s); });
    omp_set_num_threads(1);
    WalledParticles straight(scene);
    const Status first = straight.status();
    std::vector<MemoryArchive> kept;
    for (const double at : {2.0, 5.0, 9.0}) {
        run_to(straight, at);
        straight.serialize(kept.emplace_back());
    }
    run_to(straight, 14.0);
    const Status& now = straight.status();
    CHECK(now.bed.eroded > 0.05 * first.mass);
    CHECK(now.bed.deposited > 0.05 * first.mass);
    CHECK(std::abs(budget(first, now).mass_error) <= 1e-13);
    CHECK(std::abs(budget(first, now).bed_error) <= 1e-13);
    const auto check = [&](WalledParticles& other) {
        check_same(other.particles(), straight.particles(), "bed/fresh");
        CHECK(other.loads()->barriers.at(0).run_up == straight.loads()->barriers.at(0).run_up);
        CHECK(other.loads()->barriers.at(0).overtopped == straight.loads()->barriers.at(0).overtopped);
    };
    for (const int threads : {2, 4}) {
        omp_set_num_threads(threads);
        WalledParticles again(scene);
        for (const double at : {2.0, 5.0, 9.0, 14.0}) run_to(again, at);
        check(again);
    }
    for (MemoryArchive& archive : kept) {
        WalledParticles resumed(scene, Start::resumed);
        resumed.serialize(archive.rewind());
        for (const double at : {2.0, 5.0, 9.0, 14.0})
            if (at > resumed.status().time) run_to(resumed, at);
        check(resumed);
    }
}

TEST_CASE("A deposit that has become ground before a barrier takes no momentum from a second slide",
          "[barrier][deposition]") {
    const auto add_second = [](Scene& s) {
        const Seeds first = s.particles;
        s.late.push_back({"second", 12.0, s.particles, first.count()});
        s.erodible.reset();
        s.barriers = {wall_of(52.3, -5.0, 55.1, 85.0, 3.0)};
    };
    const auto as_ground = [&](Scene& s) {
        add_second(s);
        leave_deposits(s);
    };
    WalledParticles flow(slide(add_second)), ground(slide(as_ground));
    const auto over_by = [](WalledParticles& run, double time) {
        run_to(run, time);
        return run.loads()->barriers.at(0).overtopped;
    };
    const double of_flow = over_by(flow, 11.9), of_ground = over_by(ground, 11.9);
    REQUIRE(of_ground < flow.status().mass / flow.particles().flow().density);
    REQUIRE(ground.status().bed.deposited > 0.0);
    // What is still flow is pushed ahead and takes its share of the second slide's momentum; ground carries it up.
    CHECK(over_by(ground, 24.0) - of_ground > 2.0 * (over_by(flow, 24.0) - of_flow));
}

namespace {

constexpr double kSlow = 0.01;  ///< growth [1/m]: the slide goes farther

/// A wall on a part that grows, in loose ground.
Scene walled_on_large() {
    Scene scene = slide_on_large();
    loosen(scene, kSlow);
    scene.barriers = {wall_of(3930.0, 975.0, 3945.0, 1030.0, 4.0)};
    return scene;
}

void grow_with(Scene& scene, const std::function<GroundFields(const Raster& part)>& fields) {
    const auto wider = std::make_shared<WiderTerrain>(*scene.wider);
    wider->fields = fields;
    scene.wider = wider;
}

}  // namespace

TEST_CASE("Barriers in loose ground on a part that grows are those of a run on all of the terrain",
          "[barrier][erosion][terrain]") {
    Scene on_part = walled_on_large(), whole = walled_on_large();
    grow_with(on_part, [](const Raster& part) { return GroundFields{{}, Raster::filled(part.geometry, kLoose), {}}; });
    whole.bed = ground_on(kLarge);
    whole.wider.reset();
    loosen(whole, kSlow);
    WalledParticles part(on_part), all(whole);
    const Index held = part.particles().flow().grid.size();
    while (part.particles().flow().grid.size() == held) {
        part.advance(1e9), all.advance(1e9);
        REQUIRE(part.status().time < 60.0);
    }
    for (int step = 0; step < 40; ++step) part.advance(1e9), all.advance(1e9);
    // Places are counted from other nodes, so round-off differs: 1e-9 as in the tests of parts without barriers.
    CHECK(part.status().step == all.status().step);
    CHECK(part.status().kinetic == Approx(all.status().kinetic).epsilon(1e-9));
    CHECK(part.status().bed.eroded == Approx(all.status().bed.eroded).epsilon(1e-9));
    CHECK(part.loads()->barriers.at(0).overtopped == Approx(all.loads()->barriers.at(0).overtopped).epsilon(1e-9));
    CHECK(part.loads()->barriers.at(0).run_up > part.loads()->barriers.at(0).about.z());
    CHECK(part.remarks() != all.remarks());  // which tell of the part
    const auto told = [](const WalledParticles& run) {
        const auto remarks = run.remarks();
        return std::count_if(remarks.begin(), remarks.end(), [](const std::string& remark) {
            return remark.find("loose ground under barriers") != std::string::npos;
        });
    };
    CHECK(told(part) == 1);
    CHECK(told(all) == 1);
}

TEST_CASE("A run that grew among barriers, trees and deposits goes on after a resume with the same bits",
          "[barrier][erosion][deposition][forest][terrain]") {
    const auto trees_on = [](const Raster& part) { return Raster::filled(part.geometry, 20.0); };
    Scene scene = walled_on_large();
    leave_deposits(scene);
    scene.forest = Forest{trees_on(scene.bed), {}};
    grow_with(scene, [trees_on](const Raster& part) {
        return GroundFields{{}, Raster::filled(part.geometry, kLoose), trees_on(part)};
    });
    WalledParticles straight(scene);
    const Index held = straight.particles().flow().grid.size();
    while (straight.particles().flow().grid.size() == held) {
        straight.advance(1e9);
        REQUIRE(straight.status().time < 60.0);
    }
    MemoryArchive kept;
    straight.serialize(kept);
    for (int step = 0; step < 40; ++step) straight.advance(1e9);
    CHECK(straight.status().bed.eroded > 0.0);
    CHECK(straight.status().bed.deposited > 0.0);
    WalledParticles resumed(scene, Start::resumed);
    resumed.serialize(kept.rewind());
    for (int step = 0; step < 40; ++step) resumed.advance(1e9);
    check_same(resumed.particles(), straight.particles(), "bed/fresh");
    require_same(resumed, straight);
    CHECK(resumed.remarks() == straight.remarks());
}
