// Friction that varies from place to place, under particles that hold together, grains beside water, and points in 3D.
#include <algorithm>
#include <cmath>
#include <optional>

#include "analytic_scene.h"
#include "catch.h"
#include "coupling/staged_run.h"
#include "coupling/structured_run.h"
#include "friction_in_space.h"
#include "observe/memory_archive.h"
#include "same_run.h"

using namespace frana;
using namespace frana::test;

namespace {

constexpr double kBefore = 0.3, kBehind = 0.8, kSlope = 0.5;

Scene on_slope(const BedLaw& law, double x0, double x1, double half_width = 4) {
    Scene scene = scene_on(101, 21, 1.0, [](double x, double) { return 60.0 - kSlope * x; });
    scene.particles = {};
    fill(scene, [=](double x, double y) { return x > x0 && x < x1 && std::abs(y - 10) < half_width ? 1.5 : 0.0; });
    scene.particles.vx.assign(scene.particles.x.size(), 6.0);
    scene.bed_law = law;
    scene.end = 3.0;
    return scene;
}

/// Sand with the bed's friction, from the start and everywhere.
void go_into_space(Scene& scene) {
    SolidStage stage;
    stage.window = {0, 0, 100, 20};
    stage.cell = 0.5, stage.spacing = 0.25;
    stage.law = solid::DruckerPrager::of({}, std::atan(kBefore), 0.0);
    stage.of_bed = stage.whole_bed_law = true;
    stage.transfer = Transfer::flip, stage.blending = std::sqrt(stage.cell / scene.gravity);
    stage.bed_friction = friction_at_rest(scene.bed_law);
    scene.solid = stage;
}

void hold_together(Scene& scene, double cohesion, double share) {
    Structure structure;
    structure.material.young = 2e6;
    structure.cohesion = cohesion, structure.share = share;
    scene.structure = structure;
}

double mean_place(Simulation& simulation) {
    const Frame frame = simulation.frame();
    const Field *mass = frame.particle("mass"), *place = frame.particle("position");
    double sum = 0.0, moment = 0.0;
    for (Index p = 0; p < mass->count; ++p) sum += mass->data[p], moment += mass->data[p] * place->data[3 * p];
    return moment / sum;
}

void check_same_bits(const Scene& uniform, double end) {
    Scene scene = uniform;
    scene.friction = twice(scene);
    scene.bed_law = bed::None{};  // is not asked for
    const std::unique_ptr<Simulation> plain = make_simulation(uniform), of_nodes = make_simulation(scene);
    run_to(*plain, end), run_to(*of_nodes, end);
    REQUIRE(plain->status().step > 20);
    check_same(*of_nodes, *plain);
}

}  // namespace

TEST_CASE("Nodes that all have the law of the scene change no bit of structured particles", "[zones][structured]") {
    const BedLaw law = GENERATE(BedLaw(bed::Coulomb{0.25}), BedLaw(bed::Voellmy{0.2, 400}),
                                BedLaw(bed::Manning{0.05, 0.1}), BedLaw(bed::Bingham{50, 300, 0.05}));
    for (const double share : {1.0, 0.0})
        for (const bool water : {false, true}) {
            CAPTURE(law.index(), share, water);
            Scene scene = on_slope(law, 5, 17);
            hold_together(scene, 500.0, share);
            if (water) scene.water.emplace(), scene.water->share = 0.3;
            check_same_bits(scene, 0.6);
        }
}

TEST_CASE("Cells that all have the water's friction change no bit of particles with it; others do",
          "[zones][structured][water]") {
    const auto bits_of = [](double coefficient, std::optional<double> behind) {
        Scene scene = on_slope(bed::Coulomb{0.25}, 5, 17);
        hold_together(scene, 500.0, 0.0);
        scene.water.emplace(), scene.water->share = 0.3;
        scene.water->friction = {WaterFriction::Law::manning, coefficient};
        if (behind) {
            const GridGeometry& g = scene.bed.geometry;
            std::vector<water_law::Manning> laws;
            for (Index k = 0; k < g.size(); ++k) laws.push_back({g.x(k % g.nx) < 15.0 ? 0.1 : *behind});
            Friction friction;
            friction.water = laws::law_map<WaterLaw>(laws);
            scene.friction = std::make_shared<const Friction>(std::move(friction));
        }
        const std::unique_ptr<Simulation> run = make_simulation(scene);
        run_to(*run, 0.6);
        return state_bits(*run);
    };
    const auto plain = bits_of(0.1, {});
    CHECK((bits_of(0.9, 0.1) == plain));
    CHECK_FALSE((bits_of(0.1, 0.3) == plain));
}

TEST_CASE("Nodes that all have the law of the scene change no bit of points in 3D", "[zones][stages]") {
    const BedLaw law = GENERATE(BedLaw(bed::Coulomb{0.3}), BedLaw(bed::Voellmy{0.3, 400}));
    CAPTURE(law.index());
    Scene scene = on_slope(law, 5, 11);
    go_into_space(scene);
    check_same_bits(scene, 0.3);
}

// A block that comes with V0 goes V0^2 / 2 + g cos (tan - mu1) L = g cos (mu2 - tan) L2 along the slope, src/shallow/THEORY.md (77).
TEST_CASE("What slides from one friction onto another stops where friction has taken all",
          "[zones][structured][stages]") {
    constexpr double border = 30.5, start = 11.0;
    const double cosine = 1.0 / std::hypot(1.0, kSlope), weight = 9.81 * cosine;
    const double speed = 6.0 / cosine, before = (border - start) / cosine;
    const double behind = (0.5 * speed * speed + weight * (kSlope - kBefore) * before) / (weight * (kBehind - kSlope));
    const auto way = [&](const std::function<void(Scene&)>& edit) {
        Scene scene = on_slope(bed::Coulomb{kBefore}, 5, 17, 2);
        scene.friction = by_place<bed::Coulomb>(
            scene, [=](double x, double) { return bed::Coulomb{x < border ? kBefore : kBehind}; });
        edit(scene);
        const std::unique_ptr<Simulation> run = make_simulation(scene);
        const double first = mean_place(*run);
        run_to(*run, 9.0);
        CHECK(run->status().mean_speed < 0.01);
        return (mean_place(*run) - first) / cosine;
    };
    const double block = way([](Scene&s) { hold_together(s, 1e9, 1.0); }), particles = way([](Scene&) {}),
                 points = way(go_into_space);
    CAPTURE(before + behind, block, particles, points);
    // Nodes see the border to half a cell. One that lies so far off changes the way by this:
    const double half_a_cell = 0.5 / cosine * (1.0 + (kSlope - kBefore) / (kBehind - kSlope));
    for (const double found : {block, particles, points}) CHECK(std::abs(found - before - behind) < 0.5 * half_a_cell);
}

TEST_CASE("Sand is as strong inside as the roughest ground in its window, not elsewhere", "[zones][stages]") {
    Scene scene = on_slope(bed::Coulomb{kBefore}, 5, 11);
    go_into_space(scene);
    scene.friction = by_place<bed::Coulomb>(scene, [](double x, double) {
        return bed::Coulomb{x < 50.0 ? kBefore : x < 80.0 ? kBehind : 0.9};
    });
    scene.solid->window = {0, 0, 60, 20};
    CHECK(choose_start(scene, particles_of(scene.particles, scene, nodes_in_window(scene))).friction == kBehind);
    scene.solid->window = {0, 0, 40, 20};  // as where all ground has that friction
    CHECK(choose_start(scene, particles_of(scene.particles, scene, nodes_in_window(scene))).friction == kBefore);
}
