#include "stress/trial.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "stress/dice.h"

namespace frana::stress {
namespace {

constexpr double kNever = 1e300;  ///< [s]

/// Whether the points differ by a bit.
bool differ(const Columns& a, const Columns& b) {
    return a.x != b.x || a.y != b.y || a.mass != b.mass || a.vx != b.vx || a.vy != b.vy ||
           a.narrow.vx != b.narrow.vx || a.narrow.vy != b.narrow.vy || a.id != b.id;
}

/// The points after `steps` steps by `threads` threads.
Columns run_with(const Scene& scene, int threads, Index steps) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    DepthAveraged simulation(scene);
    while (simulation.status().step < steps) simulation.advance(kNever);
    omp_set_num_threads(before);
    return simulation.flow().columns;
}

void compare_threads(const Scene& scene, Verdict& verdict) {
    verdict.worst["threads"] = 0.0;
    if (!differ(run_with(scene, 1, verdict.steps), run_with(scene, 2, verdict.steps))) return;
    verdict.worst["threads"] = std::numeric_limits<double>::infinity();
    verdict.broken = Violation{"threads", verdict.worst["threads"], verdict.steps, verdict.time,
                               "one thread and two end with different bits"};
}

/// kDisturbed times the round-off of the surface over the depth, but no more than what decides a tie (solver/merge.cpp).
double disturbance(const Scene& scene, const Facts& facts) {
    double highest = 0.0;
    for (const double z : scene.bed.values)
        if (std::isfinite(z)) highest = std::max(highest, std::abs(z));
    const double round_off = std::numeric_limits<double>::epsilon() * (1.0 + highest / facts.release_depth);
    return std::min(kDisturbed * round_off, 1e-7);
}

/// Asymmetry at `step` of a twin whose points' masses are disturbed, each its own way.
double disturbed_asymmetry(const Scene& scene, const Facts& facts, const Scale& scale, Index step) {
    Scene twin = scene;
    Dice dice(1);
    const double share = disturbance(scene, facts);
    for (double& volume : twin.particles.volume) volume *= 1.0 + share * dice.between(-1.0, 1.0);
    DepthAveraged simulation(twin);
    while (simulation.status().step < step) simulation.advance(kNever);
    return asymmetry(facts, snapshot_of(simulation, facts.steep).nodes, scale);
}

/// What round-off grew to is no finding, and the other invariants are watched on.
void excuse_growth(const Scene& scene, const Facts& facts, Watch& watch, Verdict& verdict) {
    if (verdict.broken->invariant != "symmetry") return;
    if (!has_grown(scene, facts, watch.scale(verdict.broken->step), *verdict.broken)) return;
    watch.part();  // the last invariant that see() looks at: none other is broken
    verdict.broken.reset();
    verdict.parted = true;
}

void run(const Scene& scene, const Claims& claims, Index steps, const Falsify& falsify, Verdict& verdict) {
    DepthAveraged simulation(scene);
    const Facts facts = facts_of(scene, simulation.flow(), claims);
    Snapshot state = snapshot_of(simulation, facts.steep);
    Watch watch(facts, state);
    const Status& status = simulation.status();
    const auto see = [&] {
        if (falsify) falsify(state);
        verdict.steps = status.step;
        verdict.time = status.time;
        verdict.particles = std::max(verdict.particles, status.particles);
        verdict.broken = watch.see(state);
        if (verdict.broken) excuse_growth(scene, facts, watch, verdict);
        verdict.worst = watch.worst();
    };
    see();
    while (!verdict.broken && status.step < steps && status.particles > 0 && status.particles < kMostPoints) {
        simulation.advance(kNever);
        state = snapshot_of(simulation, facts.steep);
        see();
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
        if (claims.threads && !verdict.broken) compare_threads(scene, verdict);
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

}  // namespace frana::stress
