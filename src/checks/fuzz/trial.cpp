#include "checks/fuzz/trial.h"

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "checks/fuzz/dice.h"
#include "observe/memory_archive.h"
#include "shallow/depth_averaged.h"

namespace frana::fuzz {
namespace {

constexpr double kNever = 1e300;  ///< [s]

/// All bits of a state.
using Bits = std::map<std::string, MemoryArchive::Entry>;

/// The first array that differs, or nothing.
std::string difference(const Bits& a, const Bits& b) {
    for (const auto& [name, entry] : a)
        if (b.count(name) == 0 || !(b.at(name) == entry)) return name;
    return a.size() == b.size() ? "" : "their number";
}

void go_on(Simulation& simulation, Index steps) {
    while (simulation.status().step < steps) simulation.advance(kNever);
}

/// The state after `steps` steps by `threads` threads.
Bits run_with(const Scene& scene, int threads, Index steps) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    const std::unique_ptr<Simulation> simulation = make_simulation(scene);
    go_on(*simulation, steps);
    omp_set_num_threads(before);
    return state_bits(*simulation);
}

/// The same, saved half way and resumed.
Bits run_with_pause(const Scene& scene, Index steps) {
    MemoryArchive kept;
    {
        const std::unique_ptr<Simulation> first = make_simulation(scene);
        go_on(*first, steps / 2);
        first->serialize(kept);
    }
    const std::unique_ptr<Simulation> second = make_simulation(scene, Start::resumed);
    second->serialize(kept.rewind());
    go_on(*second, steps);
    return state_bits(*second);
}

void compare(const char* invariant, const Bits& a, const Bits& b, const char* what, Verdict& verdict) {
    verdict.worst[invariant] = 0.0;
    const std::string name = difference(a, b);
    if (name.empty()) return;
    verdict.worst[invariant] = std::numeric_limits<double>::infinity();
    verdict.broken = Violation{invariant, verdict.worst[invariant], verdict.steps, verdict.time,
                               fmt::format("{}, first in \"{}\"", what, name)};
}

/// Runs the scene once or twice more, where that is claimed.
void compare_bits(const Scene& scene, const Claims& claims, Verdict& verdict) {
    if (!claims.threads && !claims.resumes) return;
    const Bits bits = run_with(scene, 1, verdict.steps);
    if (claims.threads)
        compare("threads", bits, run_with(scene, 2, verdict.steps), "one thread and two end with different bits",
                verdict);
    if (claims.resumes && !verdict.broken)
        compare("resume", bits, run_with_pause(scene, verdict.steps),
                "a run that was saved half way and resumed ends with different bits", verdict);
}

/// kDisturbed times the round-off of the surface over the depth, but at most what decides a tie (shallow/merge.cpp).
double disturbance(const Scene& scene, const Facts& facts) {
    double highest = 0.0;
    for (const double z : scene.bed.values)
        if (std::isfinite(z)) highest = std::max(highest, std::abs(z));
    const double round_off = std::numeric_limits<double>::epsilon() * (1.0 + highest / facts.release_depth);
    return std::min(kDisturbed * round_off, 1e-7);
}

/// Disturbs all numbers of the points of a saved state, each its own way.
void disturb(MemoryArchive& state, double share) {
    Dice dice(1);
    for (auto& [name, entry] : state.entries()) {
        if (name.find("points/") == std::string::npos || entry.kind != Archive::Kind::real) continue;
        for (std::size_t at = 0; at < entry.bytes.size(); at += sizeof(double)) {
            double value = 0.0;
            std::memcpy(&value, &entry.bytes[at], sizeof value);
            value *= 1.0 + share * dice.between(-1.0, 1.0);
            std::memcpy(&entry.bytes[at], &value, sizeof value);
        }
    }
}

/// Asymmetry at `step` of a twin that is disturbed at the start.
double disturbed_asymmetry(const Scene& scene, const Facts& facts, const Scale& scale, Index step) {
    MemoryArchive state;
    DepthAveraged(scene).serialize(state);
    disturb(state, disturbance(scene, facts));
    DepthAveraged simulation(scene, Start::resumed);
    simulation.serialize(state.rewind());
    go_on(simulation, step);
    return asymmetry(facts, snapshot_of(simulation, facts.steep).nodes, scale);
}

/// What round-off grew to is no finding, and the other invariants are watched on.
void excuse_growth(const Scene& scene, const Facts& facts, Watch& watch, Verdict& verdict) {
    if (verdict.broken->invariant != "symmetry") return;
    if (!has_grown(scene, facts, watch.scale(verdict.broken->step), *verdict.broken)) return;
    watch.part();  // the last invariant that observe() checks: none other is broken
    verdict.broken.reset();
    verdict.parted = true;
}

void run(const Scene& scene, const Claims& claims, Index steps, const Falsify& falsify, Verdict& verdict) {
    const std::unique_ptr<Simulation> simulation = make_simulation(scene);
    const Facts facts = facts_of(scene, *simulation, claims);
    Snapshot state = snapshot_of(*simulation, facts.steep);
    Watch watch(facts, state);
    const Status& status = simulation->status();
    const auto observe = [&] {
        if (falsify) falsify(state);
        verdict.steps = status.step;
        verdict.time = status.time;
        verdict.particles = std::max(verdict.particles, status.particles);
        verdict.broken = watch.observe(state);
        if (verdict.broken) excuse_growth(scene, facts, watch, verdict);
        verdict.worst = watch.worst();
    };
    observe();
    while (!verdict.broken && status.step < steps && status.mass > 0.0 && status.particles < kMostPoints) {
        const double before = status.time;
        simulation->advance(kNever);
        state = snapshot_of(*simulation, facts.steep);
        observe();
        if (!verdict.broken && !(status.time > before))
            verdict.broken = Violation{"clock", std::numeric_limits<double>::infinity(), status.step, status.time,
                                       "a step that takes no time"};
    }
}

}  // namespace

bool has_grown(const Scene& scene, const Facts& facts, const Scale& scale, const Violation& difference) {
    try {
        const double twin = disturbed_asymmetry(scene, facts, scale, difference.step);
        return difference.value * Watch::kMirrorError < kShare * twin;
    } catch (const NumericsError&) {
        return false;  // a twin that fails tells nothing
    }
}

Verdict examine(const Scene& scene, const Claims& claims, Index steps, const Falsify& falsify) {
    Verdict verdict;
    const auto broke = [&](const char* invariant, const char* what) {
        const double beyond = std::numeric_limits<double>::infinity();
        verdict.broken = Violation{invariant, beyond, verdict.steps, verdict.time, what};
        verdict.worst[invariant] = beyond;
    };
    try {
        run(scene, claims, steps, falsify, verdict);
        if (!verdict.broken) compare_bits(scene, claims, verdict);
    } catch (const NumericsError& error) {
        broke("numerics", error.what());
    } catch (const InternalError& error) {
        broke("program", error.what());
    }
    return verdict;
}

Verdict examine(const Draft& draft, const Falsify& falsify) {
    try {
        return examine(scene_of(draft), draft.claims, draft.steps, falsify);
    } catch (const UserError& error) {
        Verdict verdict;
        verdict.refused = true;
        verdict.text = error.what();
        return verdict;
    }
}

}  // namespace frana::fuzz
