#include "bench/gates.h"

#include <algorithm>

namespace frana::bench {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double ratio(const Timed* over, const Timed* under) {
    return over && under ? over->cost.ns(over->cost.full()) / under->cost.ns(under->cost.full()) : kUnknown;
}

/// Both by the wall: a team's CPU time alone does not show what waiting costs it.
double speed_up(const Timed* one, const Timed* two) {
    return one && two ? one->cost.full().wall_ns / two->cost.full().wall_ns : kUnknown;
}

}  // namespace

std::vector<Gate> gates(const Report& report) {
    const Options& options = report.options;
    const Index reference = reference_particles(options);
    const Timed* full = find(report, "depth_averaged", reference, 1);
    const auto [least, most] = std::minmax_element(options.particles.begin(), options.particles.end());
    const Timed *small = find(report, "depth_averaged", *least, 1), *large = find(report, "depth_averaged", *most, 1);

    std::vector<Gate> list{
        {"double, one thread: ns x triad GB/s [B]", 640, 400},
        {"two threads over one (wall)", 1.7, 1.9, true},
        {"fewest to most particles: growth of ns", 1.35, 1.15},
        {"blob on 1 % of a grid over a tight grid", 1.10, 1.0},
        {"no friction, no rheology over full step", 0.75, 0.6},
        {"90 % of the material at rest: asleep over awake", 0.25, 0.12},
        {"memory per particle, double [B]", 200, 120},
        {"float, one thread: ns x triad GB/s [B]", 450, 280},
        {"memory per particle, float [B]", 110, 60},
        {"12 particle fields made and written (HDF5): steps", 2, 1.5},
        {"points in space, fluid, one thread [ns]", 90, 46},
        {"points in space, Drucker-Prager, one thread [ns]", 150, 100},
        {"points in space, fluid: two threads over one (wall)", 1.7, 1.9, true},
        {"structured columns, elastic, over depth-averaged", 1.6, 1.2},
        {"structured columns, breaking, over depth-averaged", 1.6, 1.2},
        {"structured columns, grains, over depth-averaged", 1.6, 1.2},
    };
    const Timed* fluid = find(report, "solid_flow", 0, 1);
    if (fluid) list[10].measured = fluid->cost.ns(fluid->cost.full());
    if (const Timed* sand = find(report, "solid_flow_drucker_prager", 0, 1))
        list[11].measured = sand->cost.ns(sand->cost.full());
    list[12].measured = speed_up(fluid, find(report, "solid_flow", 0, 2));
    if (full) list[0].measured = full->cost.ns(full->cost.full()) * report.calibration.triad_GBps.at(1);
    list[1].measured = speed_up(full, find(report, "depth_averaged", reference, 2));
    if (small != large) list[2].measured = ratio(large, small);
    list[3].measured = ratio(find(report, "depth_averaged_wide", 0, 1), find(report, "depth_averaged_tight", 0, 1));
    const Timed* beside = find(report, "depth_averaged_in_turns", 0, 1);
    list[4].measured = ratio(find(report, "depth_averaged_bare", 0, 1), beside);
    list[5].measured = ratio(find(report, "depth_averaged_resting", reference, 1),
                             find(report, "depth_averaged_resting_awake", reference, 1));
    if (full) list[6].measured = full->cost.bytes_per_particle;
    if (const Timed* single = find(report, "depth_averaged", reference, 1, "float")) {
        list[7].measured = single->cost.ns(single->cost.full()) * report.calibration.triad_GBps.at(1);
        list[8].measured = single->cost.bytes_per_particle;
    }
    list[13].measured = ratio(find(report, "structured/elastic", 0, 1), beside);
    list[14].measured = ratio(find(report, "structured/breaking", 0, 1), beside);
    list[15].measured = ratio(find(report, "structured/grains", 0, 1), beside);
    list[9].measured = steps_of(report.frames, kGatedWriter);
    return list;
}

bool same_bits(const Report& report) {
    for (const auto& entry : report.hashes)
        if (entry.second != report.hashes.begin()->second) return false;
    for (const Timed& a : report.timed)
        for (const Timed& b : report.timed)
            if (a.model == b.model && a.precision == b.precision && a.cost.particles == b.cost.particles &&
                a.cost.hash != b.cost.hash)
                return false;
    const Timed* asleep = find(report, "depth_averaged_resting", 0, 1);
    const Timed* awake = find(report, "depth_averaged_resting_awake", 0, 1);
    return !asleep || !awake || asleep->cost.hash == awake->cost.hash;
}

}  // namespace frana::bench
