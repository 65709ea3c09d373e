// A state that is kept and taken up again goes on with the same bits as if it had never stopped.
#include <omp.h>

#include "analytic_scene.h"
#include "catch.h"
#include "checks/verify/placement.h"
#include "same_run.h"

using namespace frana;
using namespace frana::test;

namespace {

/// A slide down a steep slope with a bump; edit() makes the variants.
Scene slide(const std::function<void(Scene&)>& edit = {}) {
    Scene scene = scene_on(66, 66, 1.0, [](double x, double y) {
        return 60 - 0.5 * x + 0.02 * y + 4 * std::exp(-((x - 55) * (x - 55) + (y - 30) * (y - 30)) / 30);
    });
    scene.bed_law = bed::Voellmy{0.2, 400};
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 35, y - 33) < 14 ? 3.0 : 0.0; }, verify::Placement::r2,
        2);
    if (edit) edit(scene);
    return scene;
}

/// With all fields of their frames.
void check_same_frames(DepthAveraged& resumed, DepthAveraged& straight) {
    check_same(resumed, straight);
    const Frame a = resumed.frame(), b = straight.frame();
    REQUIRE(a.nodes.size() == b.nodes.size());
    const auto same = [](const Field& x, const Field& y) {
        INFO(x.name);
        REQUIRE(x.count == y.count);
        CHECK(std::memcmp(x.data, y.data, static_cast<std::size_t>(x.count * x.components) * sizeof(double)) == 0);
    };
    for (std::size_t n = 0; n < a.nodes.size(); ++n) same(a.nodes[n], b.nodes[n]);
    for (std::size_t n = 0; n < a.particles.size(); ++n) same(a.particles[n], b.particles[n]);
}

/// Runs `scene` straight on, keeping its state before step 0 and at several later steps; each of these is taken up and
/// must have come to the same state at each output time. Returns the straight run.
std::unique_ptr<DepthAveraged> check_resume(const Scene& scene, double end, int threads_before, int threads_after) {
    omp_set_num_threads(threads_before);
    auto straight = std::make_unique<DepthAveraged>(scene);
    std::vector<MemoryArchive> kept;
    const double output = 0.4 * end;  // steps are shortened to hit it
    while (straight->status().time < end) {
        const Index step = straight->status().step;
        if (step <= 4 || step % 13 == 0) straight->serialize(kept.emplace_back());
        straight->advance(straight->status().time < output ? output : end);
    }
    REQUIRE(kept.size() >= 5);
    REQUIRE(straight->status().step >= 6);
    omp_set_num_threads(threads_after);
    for (MemoryArchive& state : kept) {
        DepthAveraged resumed(scene, Start::resumed);
        resumed.serialize(state.rewind());
        INFO("kept at step " << resumed.status().step);
        check_same(state_bits(resumed), without_clock(state));
        resumed.frame();  // a look at a state changes nothing
        while (resumed.status().time < end) resumed.advance(resumed.status().time < output ? output : end);
        check_same_frames(resumed, *straight);
        const MotionQuery fast{0.5 * straight->status().mean_speed, 0.5 * end};
        CHECK(resumed.motion(fast).moving == straight->motion(fast).moving);
        CHECK(resumed.motion(fast).fronts == straight->motion(fast).fronts);
        CHECK(resumed.remarks() == straight->remarks());
    }
    return straight;
}

}  // namespace

TEST_CASE("Points that rest before they could split do so all the same, and in a run that is resumed too", "[resume]") {
    // One point a cell splits at once where it may. Steps are so short that six of them come before the first chance.
    Scene scene = scene_on(40, 40, 1.0, [](double, double) { return 0.0; });
    scene.bed_law = bed::Coulomb{3.0};
    scene.scheme.cfl = 0.1;
    verify::place(
        scene, [](double x, double y) { return std::hypot(x - 20, y - 20) < 6 ? 0.1 : 0.0; },
        verify::Placement::aligned, 1);
    const auto straight = check_resume(scene, 4.0, 1, 1);
    CHECK(straight->status().max_speed == 0.0);
    CHECK(straight->status().particles == 4 * scene.particles.count());
}

TEST_CASE("A saved state goes on with the same bits, with points that split, merge and leave", "[resume]") {
    const Threads restored;
    const Scene scene = slide();
    const auto end = check_resume(scene, 4.0, 1, 1);
    CHECK(end->flow().particles.count() != scene.particles.count());
    CHECK(*std::max_element(end->flow().particles.id.begin(), end->flow().particles.id.end()) >=
          scene.particles.count());
    CHECK(end->status().mass_left > 0.0);
}

TEST_CASE("A saved state goes on with the same bits on another number of threads", "[resume][threads]") {
    const Threads restored;
    const auto end = check_resume(slide(), 2.0, 1, 2);
    REQUIRE(end->flow().active.count() >= kTilesForThreads);  // or one thread does it all
    check_resume(slide(), 1.0, 2, 1);
}

TEST_CASE("A saved state goes on with the same bits whatever the scheme", "[resume]") {
    const Threads restored;
    SECTION("the paper's choices") {
        check_resume(slide([](Scene& scene) { verify::set_preset(scene, "paper"); }), 1.5, 1, 1);
    }
    SECTION("single precision") {
        check_resume(slide([](Scene& scene) { scene.scheme.precision = Precision::single; }), 1.5, 1, 2);
    }
    SECTION("cubic shapes") {
        check_resume(slide([](Scene& scene) { scene.scheme.shape = Shape::cubic; }), 1.5, 1, 1);
    }
    SECTION("FLIP, linear shapes") {
        check_resume(slide([](Scene& scene) {
                         scene.scheme.transfer = Transfer::flip;
                         scene.scheme.shape = Shape::linear;
                     }),
                     1.5, 1, 1);
    }
    SECTION("neither splits nor merges") {
        check_resume(slide([](Scene& scene) { scene.scheme.split = scene.scheme.merge = false; }), 1.5, 1, 1);
    }
    SECTION("walls") {
        const auto end = check_resume(slide([](Scene& scene) { scene.sides = Sides::wall; }), 4.0, 1, 1);
        double furthest = 0.0;
        for (const double x : end->flow().particles.x) furthest = std::max(furthest, x);
        CHECK(furthest > 64.0);                     // the mass came to a wall
        const auto& id = end->flow().particles.id;  // nothing left, so fewer points than ids ever given have merged
        CHECK(end->flow().particles.count() < 1 + *std::max_element(id.begin(), id.end()));
    }
    SECTION("a Bingham rheology and its forces") {
        check_resume(slide([](Scene& scene) { scene.rheology = rheology::Bingham{50, 200}; }), 2.0, 1, 1);
    }
    SECTION("a Bingham rheology inside walls") {
        check_resume(slide([](Scene& scene) {
                         scene.rheology = rheology::Bingham{50, 200};
                         scene.sides = Sides::wall;
                     }),
                     4.0, 1, 1);
    }
}

TEST_CASE("A lake whose masses were fitted is not fitted again", "[resume]") {
    const Threads restored;
    const auto bowl = [](double x, double y) { return 0.01 * ((x - 20) * (x - 20) + (y - 20) * (y - 20)); };
    Scene scene = scene_on(40, 40, 1.0, bowl);
    scene.still_surface = 1.5;
    const auto depth = [&](double x, double y) { return std::max(0.0, 1.5 - bowl(x, y)); };
    verify::place(scene, depth, verify::Placement::r2, 2);
    const auto end = check_resume(scene, 2.0, 1, 1);
    REQUIRE(end->mass_fit());
    CHECK(end->remarks().size() == 1);
    DepthAveraged resumed(scene, Start::resumed);
    CHECK_FALSE(resumed.mass_fit());
}

TEST_CASE("Where nothing holds a lake, its volume stays that of the release", "[lake]") {
    // Half of the bowl is cut off by an open side; a post stands in the middle of the whole bowl, a cell thick.
    enum class Gap { none, side, post };
    const auto made = [](Gap gap) {
        const double east = gap == Gap::side ? 12.0 : 20.0;
        const auto bowl = [=](double x, double y) {
            const bool post = gap == Gap::post && std::abs(x - 20) < 0.6 && std::abs(y - 20) < 0.6;
            return post ? 5.0 : 0.01 * ((x - east) * (x - east) + (y - 20) * (y - 20));
        };
        Scene scene = scene_on(gap == Gap::side ? 13 : 41, 41, 1.0, bowl);
        scene.sides = gap == Gap::side ? Sides::open : Sides::wall;
        scene.still_surface = 1.5;
        verify::place(
            scene, [&](double x, double y) { return std::max(0.0, 1.5 - bowl(x, y)); }, verify::Placement::r2, 3);
        return scene;
    };
    for (const Gap gap : {Gap::none, Gap::side, Gap::post}) {
        const Scene scene = made(gap);
        double given = 0.0;
        for (const double volume : scene.particles.volume) given += volume * scene.density;
        const DepthAveraged run(scene);
        CAPTURE(static_cast<int>(gap), run.status().mass / given);
        // A sum over points and one over nodes: the square of the spacing over the bowl's width.
        CHECK(std::abs(run.status().mass / given - 1.0) < (gap == Gap::post ? 0.03 : 0.01));
        const std::string said = run.remarks().at(0);
        CHECK((said.find("nothing holds it at open sides") != std::string::npos) == (gap != Gap::none));
    }
}

TEST_CASE("A state on a larger grid is refused with a reason", "[resume]") {
    DepthAveraged simulation(slide()), other(scene_on(20, 20, 1.0, [](double, double) { return 0.0; }), Start::resumed);
    MemoryArchive state;
    simulation.serialize(state);
    CHECK_THROWS_WITH(other.serialize(state.rewind()), Catch::Contains("does not fit this case"));
}
