// Material that is added to a run from outside: the bits of a release that enters then, budgets, states put aside, refusals.
#include "analytic_scene.h"
#include "catch.h"
#include "coupling/growing_particles.h"
#include "coupling/walled_particles.h"
#include "growing_slope.h"
#include "observe/budget.h"
#include "run/memory_state.h"
#include "same_run.h"

using namespace frana;
using namespace frana::test;

namespace {

Scene slope() {
    Scene scene = scene_on(130, 45, 1.0, [](double x, double) { return 60.0 - 0.4 * x; });
    scene.bed_law = bed::Voellmy{0.1, 300.0};
    return scene;
}

double cap(double x, double y, double x0, double depth) {
    const double r2 = ((x - x0) * (x - x0) + (y - 22.0) * (y - 22.0)) / 64.0;
    return depth * std::max(0.0, 1.0 - r2);
}

/// Particles of a cap that would be released there.
Seeds cap_at(double x0) {
    Scene scene = slope();
    fill(scene, [&](double x, double y) { return cap(x, y, x0, 1.0); });
    return scene.particles;
}

Scene moving() {
    Scene scene = slope();
    fill(scene, [](double x, double y) { return cap(x, y, 32.0, 1.5); });
    return scene;
}

void go_to(Simulation& run, double time) {
    while (run.status().time < time) run.advance(time);
}

double volume_of(const Seeds& seeds) {
    double sum = 0.0;
    for (const double part : seeds.volume) sum += part;
    return sum;
}

}  // namespace

TEST_CASE("What is added between two steps is a release that enters then, bit for bit", "[added]") {
    constexpr double kAt = 2.3;  // no sum of ordinary steps
    const Seeds more = cap_at(60.0);
    Scene timed = moving();
    timed.late.push_back({"more", kAt, more, timed.particles.count()});
    DepthAveraged late(timed), added(moving());
    go_to(late, kAt), go_to(added, kAt);
    REQUIRE(added.why_not_add(more).empty());
    added.add(more);
    REQUIRE(added.status().mass_in > 0.0);
    for (int step = 0; step < 40; ++step) {
        late.advance(1e3), added.advance(1e3);
        REQUIRE(added.status().dt == late.status().dt);
        const Particles &a = added.flow().particles, &b = late.flow().particles;
        REQUIRE((a.x == b.x));
        REQUIRE((a.mass == b.mass));
        REQUIRE((a.vx == b.vx));
        REQUIRE((a.depth == b.depth));
        REQUIRE(added.status().kinetic == late.status().kinetic);
    }
    CHECK(added.status().mass_in == late.status().mass_in);
}

TEST_CASE("What is added closes the balances, next to inflows too", "[added][inflow]") {
    Scene scene = moving();
    Inflow inflow;
    inflow.name = "flood", inflow.line = {{20, 14}, {20, 30}}, inflow.to_right = true, inflow.spacing = 0.5;
    inflow.time = {0.5, 2.0, 5.0}, inflow.discharge = {0.0, 20.0, 0.0}, inflow.speed = {4.0, 4.0, 4.0};
    scene.inflows = {inflow};
    DepthAveraged run(scene);
    const Status first = run.status();
    Seeds more = cap_at(60.0);
    for (double& v : more.vx) v = 3.0;
    for (int time = 1; time <= 6; ++time) {
        go_to(run, time);
        if (time <= 3) run.add(more);
    }
    CHECK(run.extras().inflow->volume == Approx(45.0).epsilon(1e-12));  // the table's alone
    CHECK(run.status().mass_in / scene.density == Approx(45.0 + 3.0 * volume_of(more)).epsilon(1e-12));
    const Status now = run.frame().status;
    const Budget b = budget(first, now);
    CHECK(std::abs(b.mass_error) < 1e-13);
    // Of a momentum of the order of mass times 10 m/s: round-off of the sums.
    CHECK(std::hypot(b.momentum_residual[0], b.momentum_residual[1]) < 1e-11 * now.mass * 10.0);
}

TEST_CASE("What is added while the state is put aside enters after the step that follows", "[added][resume]") {
    const Seeds more = cap_at(60.0);
    DepthAveraged run(moving()), reference(moving());
    go_to(run, 1.0), go_to(reference, 1.0);
    const auto before = state_bits(run);
    MemoryState aside;
    aside.save(run);
    run.advance(1.01);
    run.add(more);
    CHECK(run.status().mass_in == 0.0);
    run.advance(1.02);
    CHECK(run.status().mass_in == 0.0);
    aside.load(run);
    CHECK((state_bits(run) == before));
    run.advance(1e3), reference.advance(1e3);
    CHECK(run.status().time == reference.status().time);
    reference.add(more);
    CHECK(run.status().mass_in == reference.status().mass_in);
    CHECK((run.flow().particles.x == reference.flow().particles.x));
    CHECK(run.status().mass_in == Approx(volume_of(more) * run.flow().density).epsilon(1e-14));
}

TEST_CASE("A place without ground, and a model that takes nothing, are refused in a sentence", "[added]") {
    const DepthAveraged run(moving());
    Seeds off = cap_at(60.0);
    off.x.back() = 1e4;
    CHECK(run.why_not_add(off).find("found the place (10000, ") == 0);
    struct Other final : Simulation {
        void advance(double) override {}
        const Status& status() const override { return now; }
        MovingMass motion(const MotionQuery&) const override { return {}; }
        Frame frame() override { return {}; }
        std::shared_ptr<const void> give_frame_away() override { return {}; }
        std::vector<PhaseTime> timings() const override { return {}; }
        void serialize(Archive&) override {}
        Sample at(const Vec2&) const override { return {}; }
        Status now;
    } other;
    CHECK(other.why_not_add({}).find("3D points") != std::string::npos);
    CHECK_THROWS_AS(other.add({}), InternalError);
}

TEST_CASE("Material is added next to barriers, and where the terrain grows for it", "[added][terrain]") {
    Scene walled = moving();
    Barrier wall;
    wall.name = "wall";
    wall.line = {{100, 10}, {100, 35}};
    wall.height = 2.0;
    walled.barriers = {wall};
    WalledParticles near_wall(walled);
    go_to(near_wall, 1.0);
    near_wall.add(cap_at(80.0));
    CHECK(near_wall.status().mass_in > 0.0);

    Scene scene = growing_slope(NodeBox{180, 20, 200, 160});
    fill(scene, [](double x, double y) { return std::hypot(x - 1240, y - 400) < 40 ? 2.0 : 0.0; });
    GrowingParticles part(scene);
    const Status first = part.status();
    part.advance(1e3);
    const Index held = part.held().i0;
    Seeds near_edge = scene.particles;  // the same heap, moved to beside the edge of the part that is held
    for (double& x : near_edge.x) x -= 1240.0 - (4.0 * static_cast<double>(held) + 60.0);
    REQUIRE(part.why_not_add(near_edge).empty());
    part.add(near_edge);
    CHECK(part.held().i0 < held);
    for (int step = 0; step < 20; ++step) part.advance(1e3);
    CHECK(std::abs(budget(first, part.status()).mass_error) < 1e-13);
    for (double& x : near_edge.x) x -= 4.0 * static_cast<double>(part.held().i0) + 2000.0;
    CHECK(part.why_not_add(near_edge).find("terrain that the run holds now") != std::string::npos);
}
