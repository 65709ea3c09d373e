#include "checks/bench/measure.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "checks/bench/team_clock.h"
#include "checks/bench/traffic.h"
#include "coupling/structured_run.h"
#include "coupling/walled_particles.h"
#include "shallow/depth_averaged.h"

namespace frana::bench {
namespace {

using Phases = std::vector<PhaseTime>;

/// What was spent between two readings of the solver's clock.
Phases between(const Phases& before, const Phases& after) {
    Phases spent = after;
    for (std::size_t n = 0; n < before.size(); ++n) {  // phases stay in their places
        spent[n].seconds -= before[n].seconds;
        spent[n].cpu_seconds -= before[n].cpu_seconds;
        spent[n].calls -= before[n].calls;
    }
    return spent;
}

/// The plane's solver, for the measurement, alone or among houses.
class Plane {
public:
    explicit Plane(const Scene& scene) {
        if (scene.barriers.empty())
            alone_ = std::make_unique<DepthAveraged>(scene);
        else
            among_houses_ = std::make_unique<WalledParticles>(scene);
        depth_averaged().count_cpu_time();
    }

    void advance() { whole().advance(std::numeric_limits<double>::max()); }
    Index particles() const { return depth_averaged().status().particles; }
    Index steps() const { return depth_averaged().status().step; }
    Phases timings() const { return whole().timings(); }
    Traffic traffic(const std::string& phase) const { return traffic_of(phase, depth_averaged().flow()); }
    Index bytes() const { return depth_averaged().particle_bytes(); }
    std::uint64_t hash() const { return hash_of(depth_averaged().flow().particles); }
    /// Nodes that points reach: those that the passes visit while nothing sleeps.
    double nodes() const {
        const Flow& flow = depth_averaged().flow();
        Index groups = 0;
        for (const Index tile : flow.active.work) groups += __builtin_popcountll(flow.in_reach[tile]);
        return 4.0 * static_cast<double>(groups);
    }

private:
    DepthAveraged& depth_averaged() const { return alone_ ? *alone_ : among_houses_->particles(); }
    Simulation& whole() const {
        if (alone_) return *alone_;
        return *among_houses_;
    }
    std::unique_ptr<DepthAveraged> alone_;
    std::unique_ptr<WalledParticles> among_houses_;
};

/// The 3D solver.
class Measured3d {
public:
    explicit Measured3d(const SolidScene& scene) : flow_(scene) { flow_.count_cpu_time(); }

    void advance() { flow_.advance(std::numeric_limits<double>::max()); }
    Index particles() const { return flow_.status().points; }
    Index steps() const { return flow_.status().step; }
    Phases timings() const { return flow_.timings(); }
    Traffic traffic(const std::string& phase) const { return traffic_of(phase, flow_.body()); }
    Index bytes() const { return flow_.particle_bytes(); }
    std::uint64_t hash() const { return hash_of(flow_.body().points); }
    /// Nodes of the tiles that points touch.
    double nodes() const {
        return static_cast<double>(kTileNodes * static_cast<Index>(flow_.body().active.work.size()));
    }

private:
    Mpm3d flow_;
};

/// The solver of structured particles, alone or with free water.
class Structured {
public:
    explicit Structured(const Scene& scene) {
        if (scene.water)
            both_ = std::make_unique<TwoPhaseFlow>(two_phase_scene(scene));
        else
            alone_ = std::make_unique<StructuredFlow>(structured_scene(scene));
        if (alone_)
            alone_->count_cpu_time();
        else
            both_->count_cpu_time();
    }

    void advance() {
        constexpr double kNever = std::numeric_limits<double>::max();
        if (both_)
            both_->advance(kNever);
        else
            alone_->advance(kNever);
    }
    Index particles() const { return flow().status().points; }
    Index steps() const { return flow().status().step; }
    Phases timings() const { return flow().timings(); }
    Traffic traffic(const std::string& phase) const { return traffic_of(phase, flow().body()); }
    Index bytes() const { return flow().particle_bytes(); }
    std::uint64_t hash() const { return hash_of(flow().body().points); }
    /// Nodes of the tiles that points touch.
    double nodes() const {
        return static_cast<double>(kTile * kTile * static_cast<Index>(flow().body().active.work.size()));
    }

private:
    const StructuredFlow& flow() const { return both_ ? both_->structured() : *alone_; }
    std::unique_ptr<StructuredFlow> alone_;
    std::unique_ptr<TwoPhaseFlow> both_;
};

/// A scene that is timed, whatever its solver.
class AnyMeter {
public:
    virtual ~AnyMeter() = default;
    virtual void warm_up() = 0;
    virtual void time_window() = 0;
    virtual Cost cost() = 0;
};

template <class Solver>
class Meter final : public AnyMeter {
public:
    template <class Subject>
    Meter(const Subject& scene, const Plan& plan) : plan_(plan), clock_(plan.threads), solver_(scene) {
        cost_.threads = plan.threads;
        cost_.particles = solver_.particles();
    }

    Cost run() {
        warm_up();
        for (int window = 0; window < plan_.windows; ++window) time_window();
        return cost();
    }
    void warm_up() override { advance(plan_.warm_steps); }
    Cost cost() override {
        cost_.particles_end = solver_.particles();
        cost_.steps = solver_.steps();
        const double count = static_cast<double>(cost_.particles_end);
        cost_.bytes_per_particle = static_cast<double>(solver_.bytes()) / count;
        cost_.nodes_per_particle = solver_.nodes() / count;
        cost_.hash = solver_.hash();
        return cost_;
    }

    void time_window() override {
        const Phases before = solver_.timings();
        clock_.start();
        const double particle_steps = advance(plan_.window_steps);
        const Lap lap = clock_.stop();
        const double scale = 1e9 / particle_steps, particles = particle_steps / plan_.window_steps;
        PhaseCost full{"full", lap.cpu * scale, lap.wall * scale, 0.0}, other = full;
        other.name = "other";
        std::vector<PhaseCost> phases{full};
        for (const PhaseTime& phase : between(before, solver_.timings())) {
            if (phase.calls == 0) continue;  // not every window sorts
            const Traffic traffic = solver_.traffic(phase.name);
            // A phase of several clock readings a step (deposit, grid update) still goes over its arrays once a step.
            const double calls = std::min<double>(static_cast<double>(phase.calls), plan_.window_steps);
            const double bytes = traffic.particle + traffic.node * solver_.nodes() / particles;
            phases.push_back(
                {phase.name, phase.cpu_seconds * scale, phase.seconds * scale, bytes * calls / plan_.window_steps});
            phases.front().bytes += phases.back().bytes;
            other.cpu_ns = std::max(0.0, other.cpu_ns - phases.back().cpu_ns);
            other.wall_ns = std::max(0.0, other.wall_ns - phases.back().wall_ns);
        }
        phases.push_back(other);
        if (cost_.phases.empty() || cost_.ns(full) < cost_.ns(cost_.full())) cost_.phases = std::move(phases);
    }

private:
    /// Advances, and returns the particle-steps that they were. One may be many steps, of particles with water.
    double advance(int times) {
        double done = 0.0;
        for (int n = 0; n < times; ++n) {
            const Index particles = solver_.particles(), steps = solver_.steps();
            solver_.advance();
            done += static_cast<double>(particles * (solver_.steps() - steps));
        }
        return done;
    }

    Plan plan_;
    TeamClock clock_;  // before the solver: its threads must be there when the solver prepares them
    Solver solver_;
    Cost cost_;
};

/// Fowler, Noll and Vo 1991, on 8 bytes at a time.
class Hash {
public:
    void mix(std::uint64_t bits) { value_ = (value_ ^ bits) * 0x100000001b3u; }
    template <class Array>
    void mix_all(const Array& array) {
        for (const double value : array) {
            std::uint64_t bits;
            std::memcpy(&bits, &value, sizeof bits);
            mix(bits);
        }
    }
    void mix_ids(const std::vector<std::int64_t>& ids) {
        for (const std::int64_t id : ids) mix(static_cast<std::uint64_t>(id));
    }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace

Cost measure(const Scene& scene, const Plan& plan) { return Meter<Plane>(scene, plan).run(); }
Cost measure(const SolidScene& scene, const Plan& plan) { return Meter<Measured3d>(scene, plan).run(); }

std::vector<Cost> measure_in_turns(const std::vector<Scene>& scenes, const Plan& plan) {
    std::vector<std::unique_ptr<AnyMeter>> meters;
    for (const Scene& scene : scenes) {
        if (scene.structure)
            meters.push_back(std::make_unique<Meter<Structured>>(scene, plan));
        else
            meters.push_back(std::make_unique<Meter<Plane>>(scene, plan));
        meters.back()->warm_up();
    }
    for (int window = 0; window < plan.windows; ++window)
        for (const auto& meter : meters) meter->time_window();
    std::vector<Cost> costs;
    costs.reserve(meters.size());
    for (const auto& meter : meters) costs.push_back(meter->cost());
    return costs;
}

std::uint64_t hash_of(const Particles& particles) {
    Hash hash;
    particles.each([&](const auto& array) { hash.mix_all(array); });
    hash.mix_ids(particles.id);
    return hash.value();
}

std::uint64_t hash_of(const MaterialPoints& points) {
    Hash hash;
    const auto mix = [&](const auto& arrays) {
        for (const Array& array : arrays) hash.mix_all(array);
    };
    mix(points.x), mix(points.v), mix(points.gradient), mix(points.state);
    hash.mix_all(points.j);
    hash.mix_ids(points.id);
    return hash.value();
}

std::uint64_t hash_of(const StructuredPoints& points) {
    Hash hash;
    points.each([&](const Array& array) { hash.mix_all(array); });
    hash.mix_ids(points.id);
    return hash.value();
}

}  // namespace frana::bench
