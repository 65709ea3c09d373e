#include "bench/measure.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "bench/team_clock.h"
#include "bench/traffic.h"
#include "solver/depth_averaged.h"

namespace frana::bench {
namespace {

using Phases = std::vector<PhaseTime>;

/// What was spent between two readings of the solver's clock.
Phases between(const Phases& before, const Phases& after) {
    Phases spent = after;
    for (std::size_t n = 0; n < before.size(); ++n) {  // phases keep their places
        spent[n].seconds -= before[n].seconds;
        spent[n].cpu_seconds -= before[n].cpu_seconds;
        spent[n].calls -= before[n].calls;
    }
    return spent;
}

class Meter {
public:
    Meter(const Scene& scene, const Plan& plan) : plan_(plan), clock_(plan.threads), simulation_(scene) {
        simulation_.count_cpu_time();
        cost_.threads = plan.threads;
        cost_.particles = simulation_.status().particles;
    }

    Cost run() {
        advance(plan_.warm_steps);
        for (int window = 0; window < plan_.windows; ++window) time_window();
        const Flow& flow = simulation_.flow();
        cost_.particles_end = flow.columns.count();
        cost_.steps = simulation_.status().step;
        const double count = static_cast<double>(flow.columns.count());
        cost_.bytes_per_particle = static_cast<double>(simulation_.particle_bytes()) / count;
        cost_.nodes_per_particle = nodes() / count;
        cost_.hash = hash_of(flow.columns);
        return cost_;
    }

private:
    /// Nodes that points touch: those that the passes walk while nothing sleeps.
    double nodes() const {
        const Flow& flow = simulation_.flow();
        Index groups = 0;
        for (const Index tile : flow.active.work) groups += __builtin_popcountll(flow.touched[tile]);
        return 4.0 * static_cast<double>(groups);
    }

    /// Steps, and the particle-steps that they were.
    double advance(int steps) {
        double done = 0.0;
        for (int step = 0; step < steps; ++step) {
            done += static_cast<double>(simulation_.status().particles);
            simulation_.advance(std::numeric_limits<double>::max());
        }
        return done;
    }

    void time_window() {
        const Phases before = simulation_.timings();
        clock_.start();
        const double particle_steps = advance(plan_.window_steps);
        const Lap lap = clock_.stop();
        const double scale = 1e9 / particle_steps, particles = particle_steps / plan_.window_steps;
        PhaseCost full{"full", lap.cpu * scale, lap.wall * scale, 0.0}, other = full;
        other.name = "other";
        std::vector<PhaseCost> phases{full};
        for (const PhaseTime& phase : between(before, simulation_.timings())) {
            const Traffic traffic = traffic_of(phase.name, simulation_.flow());
            // A phase of several clock readings a step (deposit, kick) still goes over its arrays once a step.
            const double calls = std::min<double>(static_cast<double>(phase.calls), plan_.window_steps);
            phases.push_back({phase.name, phase.cpu_seconds * scale, phase.seconds * scale,
                              (traffic.particle + traffic.node * nodes() / particles) * calls / plan_.window_steps});
            phases.front().bytes += phases.back().bytes;
            other.cpu_ns = std::max(0.0, other.cpu_ns - phases.back().cpu_ns);
            other.wall_ns = std::max(0.0, other.wall_ns - phases.back().wall_ns);
        }
        phases.push_back(other);
        if (cost_.phases.empty() || cost_.ns(full) < cost_.ns(cost_.full())) cost_.phases = std::move(phases);
    }

    Plan plan_;
    TeamClock clock_;  // before the solver: its threads must be there when the solver prepares them
    DepthAveraged simulation_;
    Cost cost_;
};

}  // namespace

Cost measure(const Scene& scene, const Plan& plan) { return Meter(scene, plan).run(); }

std::uint64_t hash_of(const Columns& columns) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto mix = [&](std::uint64_t bits) { hash = (hash ^ bits) * 0x100000001b3u; };
    columns.each([&](const auto& column) {
        for (const double value : column) {
            std::uint64_t bits;
            std::memcpy(&bits, &value, sizeof bits);
            mix(bits);
        }
    });
    for (const std::int64_t id : columns.id) mix(static_cast<std::uint64_t>(id));
    return hash;
}

}  // namespace frana::bench
