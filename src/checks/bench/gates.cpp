#include "checks/bench/gates.h"

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
    const auto [least, most] = std::minmax_element(options.particles.begin(), options.particles.end());
    const auto& triads = report.calibration.triad_GBps;
    const double triad = triads.count(1) ? triads.at(1) : kUnknown;
    const auto one = [&](const char* model) { return find(report, model, 0, 1); };
    const auto ns = [](const Timed* timed) { return timed ? timed->cost.ns(timed->cost.full()) : kUnknown; };
    const auto bytes = [](const Timed* timed) { return timed ? timed->cost.bytes_per_particle : kUnknown; };
    const Timed* full = find(report, "depth_averaged", reference, 1);
    const Timed* narrow = find(report, "depth_averaged", reference, 1, "float");
    const Timed *small = find(report, "depth_averaged", *least, 1), *large = find(report, "depth_averaged", *most, 1);
    const double growth = small != large ? ratio(large, small) : kUnknown;
    const auto over_flow = [&](const char* model) { return ratio(one(model), one("depth_averaged_in_turns")); };
    constexpr bool kAtLeast = true;
    return {
        {"double, one thread: ns x triad GB/s [B]", 640, 400, false, ns(full) * triad},
        {"two threads over one (wall)", 1.7, 1.9, kAtLeast,
         speed_up(full, find(report, "depth_averaged", reference, 2))},
        {"fewest to most particles: growth of ns", 1.35, 1.15, false, growth},
        {"blob on 1 % of a grid over a tight grid", 1.10, 1.0, false,
         ratio(one("depth_averaged_wide"), one("depth_averaged_tight"))},
        {"no friction, no rheology over full step", 0.75, 0.6, false, over_flow("depth_averaged_bare")},
        {"90 % of the material at rest: asleep over awake", 0.25, 0.12, false,
         ratio(one("depth_averaged_resting"), one("depth_averaged_resting_awake"))},
        {"erodible bed over rock", 1.25, 1.1, false, ratio(one("depth_averaged_erodible"), one("depth_averaged_rock"))},
        {"friction by zones over one law", 1.03, 1.0, false,
         ratio(one("depth_averaged_zones"), one("depth_averaged_rock"))},
        {"500 houses beyond the flow over none", 1.05, 1.0, false,
         ratio(one("depth_averaged_houses"), one("depth_averaged_no_houses"))},
        {"memory per particle, double [B]", 200, 120, false, bytes(full)},
        {"float, one thread: ns x triad GB/s [B]", 450, 280, false, ns(narrow) * triad},
        {"memory per particle, float [B]", 110, 60, false, bytes(narrow)},
        {"12 particle fields made and written (HDF5): steps", 2, 1.5, false, steps_of(report.frames, kGatedWriter)},
        {"3D points, fluid, one thread [ns]", 90, 46, false, ns(one("solid_flow"))},
        {"3D points, Drucker-Prager, one thread [ns]", 150, 100, false, ns(one("solid_flow_drucker_prager"))},
        {"3D points, fluid: two threads over one (wall)", 1.7, 1.9, kAtLeast,
         speed_up(one("solid_flow"), find(report, "solid_flow", 0, 2))},
        {"structured particles, elastic, over depth-averaged", 1.6, 1.2, false, over_flow("structured/elastic")},
        {"structured particles, breaking, over depth-averaged", 1.6, 1.2, false, over_flow("structured/breaking")},
        {"structured particles, grains, over depth-averaged", 1.6, 1.2, false, over_flow("structured/grains")},
    };
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
