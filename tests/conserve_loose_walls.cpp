// Barriers that stand in ground which the flow takes up, or raises by what it leaves.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "analytic_scene.h"
#include "catch.h"
#include "coupling/walled_columns.h"
#include "growing_slide.h"
#include "observe/budget.h"
#include "observe/memory_archive.h"
#include "state_bits.h"
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

void loosen(Scene& scene) {
    scene.erodible = ErodibleBed{Raster::filled(scene.bed.geometry, kLoose), scene.density, erosion::Growth{0.05}};
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

/// Whether a barrier raises a node, or one next to it.
std::vector<bool> footing(const Scene& scene) {
    const Raster walled = with_barriers(scene);
    const GridGeometry& g = scene.bed.geometry;
    std::vector<bool> carries(scene.bed.values.size(), false);
    for (Index j = 1; j + 1 < g.ny; ++j)
        for (Index i = 1; i + 1 < g.nx; ++i)
            for (Index dj = -1; dj <= 1; ++dj)
                for (Index di = -1; di <= 1; ++di)
                    if (walled.at(i + di, j + dj) > scene.bed.at(i + di, j + dj))
                        carries[static_cast<std::size_t>(j * g.nx + i)] = true;
    return carries;
}

}  // namespace

TEST_CASE("What carries a barrier stays, and the ground around it is taken up", "[barrier][erosion]") {
    const Scene scene = slide();
    const std::vector<bool> carries = footing(scene);
    WalledColumns run(scene);
    const WalledColumns still(scene);
    const Flow& begin = still.columns().flow();
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
    CHECK(said == remark_on_footings(static_cast<double>(firm) * kLoose));
    CHECK(said.find("m3 of loose ground under barriers") != std::string::npos);
    CHECK(remark_on_footings(0.0).empty());
}

TEST_CASE("Barriers in ground that sinks and rises keep its books, on any number of threads and after a resume",
          "[barrier][erosion][deposition][forest][threads]") {
    const Threads restore;
    const Scene scene = slide([](Scene& s) { leave_deposits(s), plant_trees(s); });
    omp_set_num_threads(1);
    WalledColumns straight(scene);
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
    const auto check = [&](WalledColumns& other) {
        check_same(other.columns(), straight.columns(), "bed/fresh");
        CHECK(other.loads()->barriers.at(0).run_up == straight.loads()->barriers.at(0).run_up);
        CHECK(other.loads()->barriers.at(0).overtopped == straight.loads()->barriers.at(0).overtopped);
    };
    for (const int threads : {2, 4}) {
        omp_set_num_threads(threads);
        WalledColumns again(scene);
        for (const double at : {2.0, 5.0, 9.0, 14.0}) run_to(again, at);
        check(again);
    }
    for (MemoryArchive& archive : kept) {
        WalledColumns resumed(scene, Start::resumed);
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
    WalledColumns flow(slide(add_second)), ground(slide(as_ground));
    const auto over_by = [](WalledColumns& run, double time) {
        run_to(run, time);
        return run.loads()->barriers.at(0).overtopped;
    };
    const double of_flow = over_by(flow, 11.9), of_ground = over_by(ground, 11.9);
    REQUIRE(of_ground < flow.status().mass / flow.columns().flow().density);
    REQUIRE(ground.status().bed.deposited > 0.0);
    // What is still flow is pushed ahead and takes its share of the second slide's momentum; ground carries it up.
    CHECK(over_by(ground, 24.0) - of_ground > 2.0 * (over_by(flow, 24.0) - of_flow));
}

TEST_CASE("Barriers in loose ground on a part that grows are those of a run on all of the terrain",
          "[barrier][erosion][terrain]") {
    const auto edit = [](Scene& scene) {
        loosen(scene);
        scene.erodible->law = erosion::Growth{0.01};
        scene.barriers = {wall_of(3930.0, 975.0, 3945.0, 1030.0, 4.0)};
    };
    Scene on_part = slide_on_large(), whole = slide_on_large();
    edit(on_part);
    const auto wider = std::make_shared<WiderTerrain>(*on_part.wider);
    wider->fields = [](const Raster& part) { return GroundFields{{}, Raster::filled(part.geometry, kLoose), {}}; };
    on_part.wider = wider;
    whole.bed = ground_on(kLarge);
    whole.wider.reset();
    edit(whole);
    WalledColumns part(on_part), all(whole);
    const Index held = part.columns().flow().grid.size();
    while (part.columns().flow().grid.size() == held) {
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
    const auto told = [](const WalledColumns& run) {
        const auto remarks = run.remarks();
        return std::count_if(remarks.begin(), remarks.end(), [](const std::string& remark) {
            return remark.find("loose ground under barriers") != std::string::npos;
        });
    };
    CHECK(told(part) == 1);
    CHECK(told(all) == 1);
}
