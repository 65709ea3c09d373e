#include "stress/trial.h"

#include <omp.h>

#include <algorithm>
#include <limits>

#include "base/error.h"

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
