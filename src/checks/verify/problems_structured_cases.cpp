// Structured solids that break: the clay flume and the block scenarios. Their bounds are verdicts (which
// block breaks), not exact answers: the set-ups were calibrated or found by search
// (checks/verify/structured_cases.h).
#include <algorithm>
#include <cmath>

#include "checks/verify/library.h"
#include "checks/verify/structured_cases.h"

namespace frana::verify {
namespace {

/// A run, and what the block came apart into.
struct Fragmented {
    Measurement run;
    double coverage = 0.0, damage = 0.0;
    std::vector<double> intact;  ///< shares of the mass in pieces that are not broken, the largest first
    Neighbours::Torn torn;
    double share(std::size_t n) const { return n < intact.size() ? intact[n] : 0.0; }
};

/// What a scene has become at `end` [s].
Fragmented broken(const StructuredScene& scene, double end) {
    constexpr double kFragmented = 0.9, kLeast = 0.02;  // damage; share of the mass
    constexpr double kTorn = 1.5, kLink = 1.25,
                     kReach = 0.55;  // cells; the last is 1.1 spacings of two a cell
    const double cell = scene.grid.cell;
    StructuredFlow flow(scene);
    const Neighbours neighbours(flow, kReach * cell);
    Fragmented result;
    result.run = run_structured(flow, end);
    result.coverage = crack_coverage(flow, scene.points);
    result.damage = flow.status().damage;
    result.intact = pieces(flow, {kLink * cell, kFragmented, kLeast});
    result.torn = neighbours.torn(flow, kTorn * cell);
    return result;
}

/// Runs of one problem as one: steps and times add up, the larger residuals count.
Measurement together(const std::vector<Fragmented>& runs) {
    Measurement m;
    double residual = 0.0, numerical = 0.0;
    m.mass_error = 0.0;
    for (const Fragmented& b : runs) {
        m.particles = b.run.particles;
        m.steps += b.run.steps, m.wall_seconds += b.run.wall_seconds;
        m.mass_error = std::max(m.mass_error, b.run.mass_error);
        residual = std::max(residual, b.run.value("momentum_residual"));
        numerical += static_cast<double>(b.torn.numerical);
    }
    m.add("momentum_residual", residual);
    m.add("numerical", numerical);
    return m;
}

/// By how much a value stays below what it should reach.
double short_of(double least, double value) { return std::max(0.0, least - value); }

/// Both clays: the soft one cracks along about half its length, the stiff one is dented.
Measurement run_clay_flume(const Setup& setup) {
    const double cell = 0.3 / static_cast<double>(setup.cells);
    const Fragmented soft = broken(clay_flume(kSoftClay, cell, setup.per_side), 0.6),
                     stiff = broken(clay_flume(kStiffClay, cell, setup.per_side), 0.6);
    Measurement m = together({soft, stiff});
    m.add("soft_coverage", soft.coverage);
    m.add("soft_off", soft.coverage - 0.55);
    m.add("stiff_coverage", stiff.coverage);
    m.add("stiff_missing", short_of(0.9, stiff.share(0)));
    return m;
}

/// Over the convex slope: 200 kPa stay whole (2A), 60 part in two (2B). The threshold lies between 80 and 140.
Measurement run_blocks_2(const Setup& setup) {
    const double cell = 100.0 / static_cast<double>(setup.cells);
    const auto run = [&](double cohesion) { return broken(convex_block(cohesion, cell, setup.per_side), 14.0); };
    const Fragmented a = run(200e3), held = run(140e3), parted = run(80e3), b = run(60e3);
    Measurement m = together({a, held, parted, b});
    m.add("damage_2a", a.damage);
    m.add("held_missing", short_of(0.95, held.share(0)));
    m.add("parted_missing", short_of(0.35, parted.share(1)));
    m.add("first_2b", b.share(0));
    m.add("second_2b", b.share(1));
    m.add("missing_2b", short_of(0.35, b.share(1)));
    m.add("damage_2b", b.damage);
    return m;
}

/// Down into a valley: 400 kPa never yield (3A). 28 hold on the slope and break on the fan below (3B). 15 fall to
/// grains by their own weight (3C).
Measurement run_blocks_3(const Setup& setup) {
    const double cell = 100.0 / static_cast<double>(setup.cells);
    const auto run = [&](double cohesion, double fan, double end) {
        return broken(valley_block(cohesion, fan, cell, setup.per_side), end);
    };
    const Fragmented a = run(400e3, -0.2, 16.0), slope = run(28e3, -0.2, 10.0), b = run(28e3, -0.2, 16.0),
                     c = run(15e3, 0.1, 10.0);
    Measurement m = together({a, slope, b, c});
    m.add("damage_3a", a.damage);
    m.add("slope_3b", slope.damage);
    m.add("damage_3b", b.damage);
    m.add("damage_3b_off", b.damage - 0.67);
    m.add("first_3b", b.share(0));
    m.add("second_3b", b.share(1));
    m.add("whole_3c", c.share(0));
    m.add("damage_3c", c.damage);
    return m;
}

}  // namespace

std::vector<Problem> structured_case_problems() {
    const Gate closed{0, "momentum_residual", 1e-12, "round-off"}, mass{0, "mass_error", 1e-14, "round-off"},
        torn{0, "numerical", 0.0, "no pair of neighbours parts unbroken"};
    Problem flume{"clay_flume",
                  "two clays strike an obstacle: the soft one cracks, the stiff one is dented",
                  {24, 30, 36},
                  {},
                  run_clay_flume};
    flume.order_of = "soft_coverage";
    flume.gates = {{0, "soft_off", 0.15, "calibrated: 0.40 to 0.70 of the length"},
                   {24, "stiff_coverage", 0.25, "calibrated"},
                   {36, "stiff_coverage", 0.30, "an earlier code, critical strain times cell as at 24"},
                   {0, "stiff_missing", 0.0, "one piece of 0.9 of the mass"},
                   torn,
                   closed,
                   mass};
    Problem convex{
        "blocks_2", "a block over a convex slope: whole or in two, by its cohesion", {30, 40}, {}, run_blocks_2};
    convex.order_of = "damage_2b";
    convex.gates = {{0, "damage_2a", 0.0, "a quarter above what bends it: 144 kPa of tension, 97 kPa of cohesion"},
                    {0, "held_missing", 0.0, "threshold between 80 and 140 kPa"},
                    {0, "parted_missing", 0.0, "threshold between 80 and 140 kPa"},
                    {0, "missing_2b", 0.0, "an earlier code: 0.45 and 0.44"},
                    torn,
                    closed,
                    mass};
    Problem valley{
        "blocks_3", "a block into a valley: whole, broken on the fan, or grains at once", {30, 40}, {}, run_blocks_3};
    valley.order_of = "damage_3b";
    valley.gates = {{0, "damage_3a", 0.0, "yields nowhere"},
                    {0, "slope_3b", 0.0, "12.7 m of Bell's height, 12 m of block"},
                    {0, "damage_3b_off", 0.1, "an earlier code 0.67, and 0.66 on finer cells"},
                    {0, "whole_3c", 0.0, "an earlier code: no piece left"},
                    torn,
                    closed,
                    mass};
    std::vector<Problem> all = {flume, convex, valley};
    for (Problem& problem : all) problem.has_presets = false, problem.finest_is_long = true;
    return all;
}

}  // namespace frana::verify
