// A warm step asks the system for no memory.
#include <atomic>
#include <cstdlib>
#include <new>

#include "analytic_scene.h"
#include "catch.h"
#include "checks/verify/structured_cases.h"
#include "checks/verify/water.h"
#include "coupling/structured_run.h"
#include "solid_maker.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

void* operator new(std::size_t size) {
    ++allocations;
    if (void* block = std::malloc(size)) return block;
    throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // sanitizers have their own otherwise
    ++allocations;
    return std::malloc(size);
}
void* operator new(std::size_t size, std::align_val_t align) {
    ++allocations;
    const auto to = static_cast<std::size_t>(align);
    if (void* block = std::aligned_alloc(to, (size + to - 1) / to * to)) return block;
    throw std::bad_alloc();
}
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }

using namespace frana;

namespace {

struct Asked {
    long most = 0, counted = 0;
};

/// The most that a step asks for, and how many steps tell. Lists of tiles may grow where the flow covers more than it ever
/// did, each when it is next used: such steps and the three after them do not.
template <class Run, class Tiles>
Asked asked_when_warm(Run& run, int steps, Tiles&& tiles) {
    Asked asked;
    std::size_t largest = 0;
    long steady = 0;
    for (int step = 0; step < steps; ++step) {
        const long before = allocations;
        run.advance(1e9);
        const long now = allocations - before;
        const std::size_t work = tiles().work.size() + tiles().tile.size();
        if (work > largest)
            steady = 0;
        else if (++steady > 3) {
            asked.most = std::max(asked.most, now);
            ++asked.counted;
        }
        largest = std::max(largest, work);
    }
    return asked;
}

/// Of a run that has made some steps.
void check_warm(DepthAveraged& simulation) {
    const auto [most, counted] =
        asked_when_warm(simulation, 40, [&]() -> const ActiveTiles& { return simulation.flow().active; });
    CHECK(counted >= 20);
    CHECK(most == 0);
}

/// By Voellmy's law. Its points do not split: arrays grow with their number.
Scene flow_on_slope(double density) {
    Scene scene = verify::scene_on(120, 60, 2.0, [](double x, double) { return -0.5 * x; });
    scene.density = density;
    scene.bed_law = bed::Voellmy{0.3, 1000.0};
    scene.scheme.split = false;
    verify::fill(scene, [](double x, double y) { return x > 20 && x < 80 && y > 20 && y < 90 ? 2.0 : 0.0; }, {2});
    return scene;
}

}  // namespace

TEST_CASE("Steps of a warm run allocate nothing", "[speed]") {
    Scene scene = flow_on_slope(1800.0);
    scene.rheology = rheology::Bingham{100.0, 200.0};
    scene.scheme.precision = GENERATE(Precision::full, Precision::single);
    if (GENERATE(false, true)) {  // two releases that are waited for
        scene.late = {{"hit", {}, {}, scene.particles.count()}, {"timed", 1e8, {}, scene.particles.count() + 1}};
        for (LateRelease& late : scene.late) late.seeds.append(scene.particles, 0, 1);
        scene.late[0].seeds.y[0] = 8.0;  // beside the flow
    }
    DepthAveraged simulation(scene);
    for (int step = 0; step < 30; ++step) simulation.advance(1e9);
    check_warm(simulation);
    const long before = allocations;
    const std::vector<double> proof(1000);
    CHECK(allocations == before + 1);  // and that would be seen
}

TEST_CASE("Warm steps among trees allocate nothing", "[speed][forest]") {
    Scene scene = flow_on_slope(300.0);
    scene.forest = Forest{Raster::filled(scene.bed.geometry, 100.0), {}};
    DepthAveraged simulation(scene);
    for (int step = 0; step < 30; ++step) simulation.advance(1e9);
    const double before = simulation.status().bed.deposited;
    check_warm(simulation);
    CHECK(simulation.status().bed.deposited > before);
}

TEST_CASE("Warm steps over a loose bed allocate nothing", "[speed][erosion]") {
    Scene scene = flow_on_slope(1800.0);
    ErodibleBed bed;
    bed.depth = Raster::filled(scene.bed.geometry, 1.0);
    bed.density = scene.density;
    bed.law = erosion::Growth{1e-3};
    scene.erodible = bed;
    DepthAveraged simulation(scene);
    for (int step = 0; step < 30; ++step) simulation.advance(1e9);
    const double before = simulation.status().bed.eroded;
    check_warm(simulation);
    CHECK(simulation.status().bed.eroded > before);
}

TEST_CASE("Warm steps in 3D allocate nothing", "[speed][solid]") {
    Mpm3d flow(lump(solid::Bingham{4e5, 1e5, 10.0, 500.0}));
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    const long before = allocations;
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    CHECK(allocations == before);
}

TEST_CASE("Warm steps against a barrier allocate nothing", "[speed][solid][barriers]") {
    SolidScene scene = lump(solid::Fluid{4e5, 1.0});
    const std::vector<Vec2> corners = {{1.3, -0.5}, {1.5, -0.5}, {1.5, 2.0}, {1.3, 2.0}};
    scene.surfaces.push_back(Surface::barrier(Prism({{Polygon{{corners}}}, "", ""}, 0.6)));
    for (Vec3& v : scene.points.velocity) v.x() = 3.0;
    Mpm3d flow(scene);
    while (flow.body().ledger.face(2, 3).impulse.norm() == 0.0) flow.advance(1e9);
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    const long before = allocations;
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    CHECK(allocations == before);
}

TEST_CASE("Warm steps of a structured solid that breaks allocate nothing", "[speed][structured]") {
    StructuredFlow flow(verify::clay_flume(verify::kSoftClay, 0.0125));
    while (flow.status().damage == 0.0) flow.advance(1e9);
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    const long before = allocations;
    const double damage = flow.status().damage;
    for (int step = 0; step < 20; ++step) flow.advance(1e9);
    CHECK(allocations == before);
    CHECK(flow.status().damage > damage);
}

TEST_CASE("Warm steps of grains allocate nothing", "[speed][structured][grains]") {
    Scene scene = verify::scene_on(80, 60, 2.0, [](double x, double) { return -0.5 * x; });
    scene.bed_law = bed::Coulomb{0.3};
    scene.curvature = Curvature::none;
    scene.scheme.split = false;  // arrays grow with the number of points
    scene.structure.emplace();
    scene.structure->share = 0.0;
    scene.structure->hydrostatic = GENERATE(true, false);
    verify::fill(scene, [](double x, double y) { return x > 20 && x < 80 && y > 20 && y < 90 ? 2.0 : 0.0; }, {2});
    StructuredFlow flow(structured_scene(scene));
    for (int step = 0; step < 10; ++step) flow.advance(1e9);
    const auto [most, counted] = asked_when_warm(flow, 40, [&]() -> const ActiveTiles& { return flow.body().active; });
    CHECK(counted >= 20);
    CHECK(most == 0);
    CHECK(flow.status().max_speed > 0.0);
}

TEST_CASE("Warm steps of free water allocate nothing, wherever it spreads", "[speed][water]") {
    WaterScene scene;
    scene.grid = verify::cells_over(120, 100, 1.0);
    scene.bed = [](double x, double y) { return -0.1 * x + 0.2 * std::sin(y); };
    scene.start = [](double x, double y) { return WaterState{x < 30.0 && y < 40.0 ? 1.0 : 0.0}; };
    scene.friction = {WaterFriction::Law::manning, 0.03};
    scene.sides = {WaterSide::wall, WaterSide::free, WaterSide::level, WaterSide::wall};
    scene.side_levels[2] = 0.2;
    scene.sources = {{{0.0, 1e9}, {5.0, 5.0}, {1.0, 1.0}, {{90, 20, 0.5, Vec2(1, 0)}, {91, 21, 0.5, Vec2(0, 1)}}}};
    WaterFlow flow(scene);
    for (int step = 0; step < 5; ++step) flow.advance(1e9);
    const long before = allocations;
    const std::size_t tiles = flow.body().work.size();
    for (int step = 0; step < 60; ++step) flow.advance(1e9);
    CHECK(allocations == before);
    CHECK(flow.body().work.size() > tiles);
}
