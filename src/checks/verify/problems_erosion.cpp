// Flows that take up their bed: slabs, a trench, a cap that grows, and a lake that takes nothing.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "checks/verify/exact_erosion.h"
#include "checks/verify/lakes.h"
#include "checks/verify/library.h"
#include "checks/verify/slab_middle.h"
#include "checks/verify/trial.h"
#include "observe/budget.h"

namespace frana::verify {
namespace {

using constants::kDegree;

/// Loose material on a bed that stays a plane.
void add_bed(Scene& scene, ErosionLaw law, double kappa, double depth) {
    ErodibleBed bed;
    bed.depth = Raster::filled(scene.bed.geometry, depth);
    bed.density = scene.density;
    bed.law = law;
    bed.momentum = kappa;
    bed.min_depth = 0.0;
    bed.evolves = false;
    scene.erodible = bed;
}

/// What is missing of the flow, of what left and of the bed, over what there was of them.
double balance_error(const Status& first, const Status& now) { return std::abs(budget(first, now).mass_error); }

/// A layer 300 m long on a strip that falls along x. Its middle is free of what comes in from its ends.
struct SlabRun {
    ErodingSlab slab;
    ErosionLaw law;
    BedLaw friction;
    double end;
    SlabState exact;
};

void add_slab(const Setup& setup, const SlabRun& run, Measurement& m) {
    constexpr double kLength = 300.0, kRoom = 150.0;
    const double slope = run.slab.slope_deg * kDegree, cosine = std::cos(slope),
                 cell = 100.0 / static_cast<double>(setup.cells);
    const Index nx = static_cast<Index>(std::ceil((kLength + run.exact.way * cosine + 2.0 * kRoom) / cell)) + 1;
    Scene scene = scene_on(
        nx, 7, cell, [&](double x, double) { return -std::tan(slope) * x; }, -kRoom);
    scene.sides = Sides::wall;
    scene.bed_law = run.friction;
    fill(scene, [&](double x, double) { return x > 0.0 && x < kLength ? run.slab.thickness / cosine : 0.0; },
         {setup.per_side});
    std::fill(scene.particles.vx.begin(), scene.particles.vx.end(), run.slab.speed * cosine);
    add_bed(scene, run.law, run.slab.kappa, 10.0);
    Trial trial(std::move(scene), setup);
    const Status first = trial.simulation().status();
    trial.run_to(run.end);
    const SlabState found = middle_of(trial, 0.5 * kLength, cosine);
    const Measurement one = trial.measure();
    const auto worst = [&](const char* name, double value) {
        for (Extra& extra : m.extras)
            if (extra.name == name) return void(extra.value = std::max(extra.value, value));
        m.add(name, value);
    };
    worst("speed_error", std::abs(found.speed / run.exact.speed - 1.0));
    worst("thickness_error", std::abs(found.thickness / run.exact.thickness - 1.0));
    worst("travel_error", std::abs(found.way / run.exact.way - 1.0));
    if (const auto* by_way = std::get_if<erosion::Growth>(&run.law))
        worst("growth_error",
              std::abs(std::log(found.thickness / run.slab.thickness) / (by_way->growth * found.way) - 1.0));
    worst("balance_error", balance_error(first, trial.simulation().status()));
    m.particles = one.particles, m.steps += one.steps, m.wall_seconds += one.wall_seconds,
    m.mass_error = one.mass_error;
}

Measurement run_slabs(const Setup& setup, const std::vector<SlabRun>& runs) {
    Measurement m;
    for (const SlabRun& run : runs) add_slab(setup, run, m);
    return m;
}

constexpr double kKappas[] = {0.0, 0.5, 1.0};

/// The rate of Shear, without a threshold and without an end.
Measurement run_constant(const Setup& setup) {
    std::vector<SlabRun> runs;
    for (const double kappa : kKappas) {
        ErodingSlab slab;
        slab.speed = 2.0, slab.kappa = kappa;
        runs.push_back({slab, erosion::Shear{0.02, 0.0, 1e3}, bed::Coulomb{slab.mu}, 20.0, slab.at_rate(0.02, 20.0)});
    }
    return run_slabs(setup, runs);
}

Measurement run_growth(const Setup& setup) {
    std::vector<SlabRun> runs;
    for (const double kappa : kKappas) {
        ErodingSlab slab;
        slab.kappa = kappa;
        runs.push_back({slab, erosion::Growth{2e-3}, bed::Coulomb{slab.mu}, 15.0, slab.grown(2e-3, 15.0)});
    }
    return run_slabs(setup, runs);
}

Measurement run_jump(const Setup& setup) {
    std::vector<SlabRun> runs;
    for (const double kappa : kKappas) {
        const ErodingSlab slab = jumping_slab(kappa);
        runs.push_back({slab, erosion::Jump{0.0}, bed::Coulomb{slab.mu}, 20.0, slab.jumped(20.0)});
    }
    return run_slabs(setup, runs);
}

Measurement run_voellmy(const Setup& setup) {
    ErodingSlab slab;
    slab.thickness = 1.5;
    return run_slabs(setup, {{slab, erosion::Growth{1e-3}, bed::Voellmy{slab.mu, 500.0}, 20.0,
                              slab.grown_voellmy(1e-3, 500.0, 20.0)}});
}

/// Average of f over a node's quadratic spline.
double spline_average(const Function& f, double x, double cell) {
    constexpr int kParts = 300;
    double sum = 0.0;
    for (int k = 0; k < kParts; ++k) {
        const double u = 3.0 * (k + 0.5) / kParts - 1.5, far = std::abs(u);
        const double weight = far < 0.5 ? 0.75 - u * u : 0.5 * (1.5 - far) * (1.5 - far);
        sum += weight * f(x + u * cell, 0.0);
    }
    return sum * 3.0 / kParts;
}

/// A block so thin that its pressure has no effect, so that it stays one.
Measurement run_trench(const Setup& setup) {
    Trench trench;
    trench.thickness = 1e-10;
    ErodingSlab block;
    block.thickness = trench.thickness;
    const double cosine = std::cos(block.slope_deg * kDegree),
                 cell = trench.length * cosine / static_cast<double>(setup.cells);
    const double end = block.time_to(trench.growth, trench.way), front = trench.length * cosine;
    const Index ahead = static_cast<Index>(std::ceil(trench.way * cosine / cell)) + 20, behind = setup.cells + 20;
    Scene scene = scene_on(
        ahead + behind + 1, 7, cell, [&](double x, double) { return -std::tan(block.slope_deg * kDegree) * x; },
        -static_cast<double>(behind) * cell);
    scene.sides = Sides::wall;
    scene.bed_law = bed::Coulomb{block.mu};
    fill(scene, [&](double x, double) { return x > -front && x < 0.0 ? trench.thickness / cosine : 0.0; },
         {setup.per_side});
    add_bed(scene, erosion::Growth{trench.growth}, 0.0, 1.0 * trench.thickness);
    Trial trial(std::move(scene), setup);
    const auto centre = [&] { return trial.point_mean([](double x, double) { return x; }); };
    const double start = centre();
    const Status first = trial.simulation().status();
    trial.run_to(end);
    Measurement m = trial.measure();
    const Frame frame = trial.simulation().frame();
    const double* taken = frame.node("eroded_depth")->data;
    double error = 0.0, size = 0.0;
    for (Index i = 0; i < frame.grid.nx; ++i) {
        const auto exact = [&](double x, double) { return trench.depth(x / cosine) / cosine; };
        const double e = spline_average(exact, frame.grid.x(i), cell),
                     found = taken[frame.grid.ny / 2 * frame.grid.nx + i];
        error += std::abs(found - e), size += e;
    }
    const Status& now = trial.simulation().status();
    const double way = (centre() - start) / cosine;
    m.add("l1_trench", error / size);
    m.add("volume_error", now.bed.eroded / first.mass / std::expm1(trench.growth * trench.way) - 1.0);
    m.add("growth_error", std::log(now.mass / first.mass) / (trench.growth * way) - 1.0);
    m.add("balance_error", balance_error(first, now));
    return m;
}

/// The linearised form, in which the answer is exact; along the map X = x / cos, h = h_v cos, U = u / cos.
void add_cap(const Setup& setup, double kappa, Measurement& m) {
    GrowingCap cap;
    cap.kappa = kappa;
    constexpr double kEnd = 8.0;
    const GrowingCap::State end = cap.at(kEnd);
    const double slope = cap.slope_deg * kDegree, cosine = std::cos(slope);
    const double cell = 2.0 * cap.half_length * cosine / static_cast<double>(setup.cells);
    const double from = -(cap.half_length + 20.0) * cosine - 4.0 * cell;
    const double to = (end.centre + end.half_length + 20.0) * cosine + 4.0 * cell;
    Scene scene = scene_on(
        static_cast<Index>(std::ceil((to - from) / cell)) + 1, 7, cell,
        [&](double x, double) { return -std::tan(slope) * x; }, from);
    scene.sides = Sides::wall;
    scene.terrain = TerrainModel::linearised;
    scene.bed_law = bed::Coulomb{std::tan(cap.friction_deg * kDegree)};
    fill_cut(scene,
             [&](double x, double) {
                 const double share = x / cosine / cap.half_length;
                 return cap.height * std::max(0.0, 1.0 - share * share) / cosine;
             },
             {setup.per_side});
    add_bed(scene, erosion::Steady{cap.eps}, kappa, 10.0);
    Trial trial(std::move(scene), setup);
    const Status first = trial.simulation().status();
    trial.run_to(kEnd);
    const auto share = [&](double x) { return (x / cosine - end.centre) / end.half_length; };
    const Measurement one =
        trial.measure({[&](double x, double) { return end.height * std::max(0.0, 1.0 - share(x) * share(x)) / cosine; },
                       [&](double x, double) { return (end.speed + share(x) * end.spreading) * cosine; }});
    const Status& now = trial.simulation().status();
    const double centre = trial.point_mean([](double x, double) { return x; }) / cosine;
    const char* name = kappa == 0.0 ? "" : "jump_";
    if (kappa == 0.0)
        m = one;
    else
        m.add("jump_l1_depth", one.l1_depth), m.add("jump_l1_momentum", one.l1_momentum);
    m.add(std::string(name) + "centre_error", centre / end.centre - 1.0);
    m.add(std::string(name) + "growth_error", std::log(now.mass / first.mass) / (cap.eps * kEnd) - 1.0);
    m.add(std::string(name) + "balance_error", balance_error(first, now));
}

Measurement run_cap(const Setup& setup) {
    Measurement m;
    for (const double kappa : {0.0, 1.0}) add_cap(setup, kappa, m);
    return m;
}

/// The lake around an island over a loose bed that evolves, under every law: nothing moves, and nothing is taken.
Measurement run_lake(const Setup& setup) {
    Measurement m;
    double fastest = 0.0, taken = 0.0;
    for (const ErosionLaw& law :
         {ErosionLaw(erosion::Growth{0.1}), ErosionLaw(erosion::Steady{0.1}), ErosionLaw(erosion::Shear{0.1, 0.0, 1.0}),
          ErosionLaw(erosion::Energy{10.0}), ErosionLaw(erosion::Jump{0.0}), ErosionLaw(erosion::Front{}),
          ErosionLaw(erosion::Mechanical{0.05, 0.1})}) {
        Scene scene = scene_of(lake_island(), setup, Placement::full_jitter);
        add_bed(scene, law, 0.0, 2.0);
        scene.erodible->evolves = true;
        Trial trial(std::move(scene), setup);
        trial.run_to(1.0, [&](const Status& now) {
            fastest = std::max(fastest, now.max_speed_on_map);
            taken = std::max(taken, now.bed.eroded);
        });
        const Measurement one = trial.measure();
        m.particles = one.particles, m.steps += one.steps, m.wall_seconds += one.wall_seconds,
        m.mass_error = one.mass_error;
    }
    m.add("max_speed", fastest, "m/s");
    m.add("taken", taken, "kg");
    return m;
}

}  // namespace

std::vector<Problem> erosion_problems() {
    const Gate mass{0, "balance_error", 1e-13, "round-off"};
    const auto exact = [](const char* quantity) {
        return Gate{0, quantity, 1e-3, "second order in the step, as with drag"};
    };
    Problem constant{"slab_constant",
                     "a slab on 30 degrees takes its bed at a constant rate, kappa 0, 1/2 and 1",
                     {10, 20, 40},
                     eroding_slab_residuals,
                     run_constant};
    Problem growth{"slab_growth",
                   "a slab on 30 degrees grows by its way, kappa 0, 1/2 and 1 (Hungr 1995)",
                   {10, 20, 40, 80},
                   growing_slab_residuals,
                   run_growth};
    Problem voellmy{
        "slab_voellmy_growth", "the same with Voellmy's drag", {10, 20, 40, 80}, voellmy_slab_residuals, run_voellmy};
    Problem jump{"slab_jump",
                 "what a slab's friction sets in motion, kappa 0, 1/2 and 1 (Fraccarollo and Capart 2002)",
                 {10, 20, 40},
                 jumping_slab_residuals,
                 run_jump};
    for (Problem* slab : {&constant, &growth, &voellmy, &jump}) {
        slab->order_of = "speed_error";
        const Index finest = slab->grids.back();
        slab->gates = {exact("speed_error"),
                       exact("thickness_error"),
                       exact("travel_error"),
                       mass,
                       {finest, "speed_error", 1e-6, "goal"},
                       {finest, "thickness_error", 1e-6, "goal"}};
    }
    growth.gates.push_back({80, "growth_error", 1e-12, "an exponential of the points' own way"});
    Problem trench{
        "trench", "what a thin block takes of its bed on 300 m, where", {5, 10, 20, 40}, trench_residuals, run_trench};
    trench.order_of = "l1_trench";
    trench.gates = {
        {10, "l1_trench", 2e-2, "goal"},
        {20, "l1_trench", 6e-3, "the bed loses where its points have arrived: half a step, a quarter of a cell"},
        {0, "growth_error", 1e-12, "an exponential of each point's own way"},
        mass};
    Problem cap{"cap_growth",
                "a cap on 35 degrees spreads as it grows at a steady rate, kappa 0 and 1",
                {20, 40, 80, 160},
                growing_cap_residuals,
                run_cap};
    cap.gates = {{80, "l1_depth", 1e-2, "goal"},
                 {80, "l1_momentum", 1e-2, "goal"},
                 {80, "jump_l1_depth", 1e-2, "goal"},
                 {0, "growth_error", 1e-12, "exact in time"},
                 mass};
    Problem lake{
        "erosion_lake", "the lake around an island over a loose bed, seven laws: nothing is taken", {50}, {}, run_lake};
    lake.gates = {{0, "max_speed", 0.0, "rest to the last bit"}, {0, "taken", 0.0, "what rests takes nothing"}};
    return {constant, growth, voellmy, jump, trench, cap, lake};
}

}  // namespace frana::verify
