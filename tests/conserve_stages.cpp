// Runs in stages: columns that become points in space keep mass, momentum and energy, at once and as they
// flow in.
#include <omp.h>

#include <algorithm>
#include <sstream>

#include "analytic_scene.h"
#include "catch.h"
#include "observe/memory_archive.h"
#include "observe/run_loop.h"
#include "stages/staged_run.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slab that slides down a slope of 1 in 4 into a window whose upper edge it crosses, and out of it below.
Scene slide(double from = 0.4) {
    Scene scene = scene_on(41, 13, 1.0, [](double x, double) { return 20.0 - 0.25 * x; });
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 3 && x < 15 && y > 3 && y < 9 ? 1.5 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.end = 2.0;
    SolidStage stage;
    stage.from = from;
    stage.window = {12, 0, 30, 12};
    stage.cell = 0.5;
    stage.spacing = 0.25;
    stage.law = solid::Fluid{};
    scene.solid = stage;
    return scene;
}

double total(const Field* field, Index from, Index to) {
    double sum = 0.0;
    for (Index p = from; p < to; ++p) sum += field->data[p];
    return sum;
}

}  // namespace

TEST_CASE("Columns that become points keep mass, momentum and energy, at once and later", "[stages]") {
    const Scene scene = slide();
    StagedRun run(scene);
    const double mass = run.status().mass, momentum = run.status().momentum[0];
    run_to(run, scene.solid->from);
    REQUIRE(run.points() != nullptr);
    REQUIRE(run.points()->status().points > 1000);
    REQUIRE(run.columns().status().particles > 50);
    // The energies of columns and points differ by the bed: averaged over a cell, or bilinear; on a plane
    // they agree.
    const double round_off = 1e-12;
    const Status before = run.status();
    CHECK(mass_error(before, mass) < round_off);
    CHECK(std::abs(before.energy_left) < round_off * before.potential);
    double worst = 0.0;
    Index most = 0;
    while (run.status().time < scene.end) {
        run.advance(scene.end);
        const Status& now = run.status();
        worst = std::max(worst, std::abs(now.mass + now.mass_left - mass) / mass);
        const double left = now.momentum[0] + now.momentum_left[0] - momentum - now.impulse[0];
        worst = std::max(worst, std::abs(left) / (mass * now.max_speed));
        most = std::max(most, run.points()->status().points);
    }
    CHECK(worst < round_off);
    // Everything has flowed into the window, and some of it out again: as columns, and at the sides out of the terrain.
    CHECK(run.columns().status().mass > 0.1 * mass);
    CHECK(run.status().mass_left > 0.1 * mass);
    CHECK(most > run.points()->status().points);
}

TEST_CASE("A frame in space has the mass of both models on its particles and on its nodes", "[stages]") {
    const Scene scene = slide();
    StagedRun run(scene);
    run_to(run, 0.6);
    Frame frame = run.frame();
    const Field *mass = frame.particle("mass"), *model = frame.particle("model"),
                *depth = frame.node("depth");
    REQUIRE(mass->count == frame.status.particles);
    const double points = total(model, 0, model->count);
    CHECK(points == static_cast<double>(run.points()->status().points));
    CHECK(total(mass, 0, mass->count) == Approx(frame.status.mass).epsilon(1e-12));
    // Nodes hold all that lies between them; at open sides nothing is yet.
    const double on_nodes = scene.density * total(depth, 0, depth->count);
    CHECK(on_nodes == Approx(frame.status.mass).epsilon(1e-12));
    CHECK(frame.particle("stress")->components == 6);
    const Sample probe = run.at({16.3, 6.1});
    CHECK(probe.depth > 0.5);
    CHECK(probe.velocity.x() > 6.0);
}

TEST_CASE("A window that nothing has reached yet waits with sound and room for what comes", "[stages]") {
    Scene scene = slide();
    scene.solid->window = {24, 0, 36, 12};
    StagedRun run(scene);
    const double mass = run.status().mass;
    run_to(run, scene.solid->from);
    CHECK(run.points()->status().points == 0);
    CHECK(run.points()->body().grid.geometry().nodes[2] > 20);
    run_to(run, 2.0);
    CHECK(run.points()->status().points > 1000);
    CHECK(mass_error(run.status(), mass) < 1e-12);
    // Sound is ten times as fast as the 8 m/s and more of the columns: points of water stay nearly as dense.
    CHECK(run.points()->status().volume == Approx(run.points()->status().mass / scene.density).epsilon(0.02));
}

TEST_CASE("Points that have more energy than the release could give are remarked upon, with what the others did", "[stages]") {
    Scene scene = slide(0.0);
    StagedRun within(scene);
    run_to(within, 0.2);
    for (const std::string& remark : within.remarks()) CHECK(remark.find("highest head") == std::string::npos);
    // What the release is said to have is less than it has: as if its points had gained energy. 8 m/s on the map, on a
    // slope of 1 in 4.
    Spray less([&] {
        Scene low = scene;
        low.particles.vx.assign(low.particles.x.size(), 0.0);
        return low;
    }());
    less.look(*within.points());
    CHECK(less.available() == Approx(Spray(scene).available() - 8.0 * 8.0 * (1.0 + 0.25 * 0.25) / (2.0 * scene.gravity)));
    CHECK(less.most_share() > 0.0);
    REQUIRE(less.remark());
    CHECK(less.remark()->find("more energy than a fall from the release's highest head") != std::string::npos);
}

TEST_CASE("A stage in space from the start takes the release as it is", "[stages]") {
    Scene scene = slide(0.0);
    scene.solid->window = {0, 0, 40, 12};
    StagedRun run(scene);
    const SolidStatus& points = run.points()->status();
    CHECK(run.columns().status().particles == 0);
    CHECK(points.mass == Approx(scene.density * 12 * 6 * 1.5).epsilon(1e-12));
    CHECK(points.points == 48 * 24 * 6);
    CHECK(points.momentum.x() == Approx(8.0 * points.mass).epsilon(1e-12));
    // Along the bed: the vertical velocity is the slope's.
    CHECK(points.momentum.z() == Approx(-2.0 * points.mass).epsilon(1e-12));
}

TEST_CASE("Sand starts pressed from all sides by its column's weight, as fluids do", "[stages]") {
    Scene scene = slide(0.0);
    std::fill(scene.bed.values.begin(), scene.bed.values.end(), 20.0);
    scene.solid->window = {0, 0, 40, 12};
    const double phi = 0.5, young = 2e6;
    for (const SolidLaw& law : {SolidLaw(solid::Fluid{}), SolidLaw(solid::Elastic::of(young, 0.3)),
                                SolidLaw(solid::DruckerPrager::of(solid::Elastic::of(young, 0.3), phi, 0.0))}) {
        scene.solid->law = law;
        const StagedRun run(scene);
        const SolidFlow& points = *run.points();
        double worst = 0.0;
        for (Index p = 0; p < points.body().points.count(); ++p) {
            const double weight = scene.density * scene.gravity * (21.5 - points.position(p).z());
            const Sym3 s = points.stress(p);
            for (const double part : {s.xx + weight, s.yy + weight, s.zz + weight, s.xy, s.yz, s.xz})
                worst = std::max(worst, std::abs(part));
        }
        CHECK(worst < 1e-9 * young);  // round-off of strains, times the stiffness
        CHECK(points.status().stored > 0.0);
    }
}

TEST_CASE("Points do not cross a closed side that columns still flow in over", "[stages]") {
    Scene scene = slide(0.05);
    std::fill(scene.bed.values.begin(), scene.bed.values.end(), 20.0);
    scene.particles.vx.assign(scene.particles.x.size(), 0.0);  // slower than its waves
    const auto left_of = [&](Index first, bool closed) {
        scene.solid->window[0] = first;
        scene.solid->closed = {closed, true, true, true};
        StagedRun run(scene);
        run_to(run, 0.8);
        CHECK(mass_error(run.status(), scene.density * 12 * 6 * 1.5) < 1e-12);
        CHECK(run.points()->status().mass > 0.1 * run.status().mass);
        return run.points()->status().mass_left;
    };
    CHECK(left_of(12, true) == 0.0);
    CHECK(left_of(12, false) == 0.0);  // what stands beyond the edge holds them
    CHECK(left_of(3, true) == 0.0);
    CHECK(left_of(3, false) > 0.0);  // nothing does
}

namespace {

/// Runs to `end`, and again from what was kept at each stop, with other numbers of threads.
void take_up_again(const Scene& scene, const std::vector<double>& stops, double end, bool some_return) {
    const int threads = omp_get_max_threads();
    StagedRun straight(scene);
    std::vector<MemoryArchive> kept(stops.size());
    bool returning = false;
    for (std::size_t n = 0; n < stops.size(); ++n) {
        while (straight.status().time < stops[n]) straight.advance(end);
        straight.keep(kept[n]);
        returning = returning || !kept[n].entries().at("returning").bytes.empty();
    }
    CHECK(returning == some_return);
    run_to(straight, end);
    CHECK((straight.points()->status().points == 0) == scene.solid->until.has_value());
    const auto expected = kept_bits(straight);
    for (const int other : {1, 2, 4}) {
        omp_set_num_threads(other);
        for (std::size_t n = 0; n < stops.size(); ++n) {
            StagedRun resumed(scene, Start::kept);
            resumed.keep(kept[n].rewind());
            run_to(resumed, end);
            const auto found = kept_bits(resumed);
            REQUIRE(found.size() == expected.size());
            for (const auto& [name, entry] : expected) {
                INFO(name << " with " << other << " threads, from " << stops[n] << " s");
                CHECK((found.at(name) == entry));
            }
        }
    }
    omp_set_num_threads(threads);
}

}  // namespace

TEST_CASE("Runs in stages have the same bits for any number of threads, and when taken up again",
          "[stages][threads]") {
    take_up_again(slide(), {0.3, 0.55}, 0.7, false);
}

TEST_CASE("So have runs whose points become columns, on their way when it stops, and whose stage in space ends", "[stages]") {
    Scene scene = slide();
    scene.particles = {};
    fill(scene, [](double x, double y) { return x > 9 && x < 15 && y > 4 && y < 8 ? 1.0 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 8.0);
    scene.solid->window = {12, 0, 18, 12};
    scene.solid->until = 0.95;
    take_up_again(scene, {0.85, 0.9, 0.97}, 1.0, true);
}

TEST_CASE("Points in space begin with the same bits whatever the time between the frames before", "[stages]") {
    const Scene scene = slide();
    const auto begun = [&](double every) {
        StagedRun staged(scene);
        Observers nobody;
        std::ostringstream stream;
        Progress progress(stream, Progress::Style::silent, scene.density);
        const RunSummary summary = run(staged, {scene.solid->from, every, false}, nobody, Interrupt(), progress);
        CHECK(summary.frames == 1 + static_cast<Index>(std::ceil(scene.solid->from / every)));
        REQUIRE(staged.points() != nullptr);
        return kept_bits(staged);
    };
    const auto seldom = begun(1000.0);
    for (const double every : {0.0031, 0.07}) CHECK((begun(every) == seldom));
}
